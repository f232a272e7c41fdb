"""Sect. 4.1: packed obstacles, segments, cables (Eq. 2, 3) and exact collision counts."""
