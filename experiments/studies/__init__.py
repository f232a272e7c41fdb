"""Studies beyond the paper: what its improvements are worth, and when."""
