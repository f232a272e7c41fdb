"""One file per algorithm: a factory that returns an `Optimizer`."""
