"""Timings: `make bench` (or `python -m benchmarks`) prints what the README quotes."""
