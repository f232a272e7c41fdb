"""Sect. 3.1: what an optimiser sees. Fitness (Eq. 21), limits (Eq. 22), and where it may search."""
