"""Sect. 4.1: packed obstacles, segment tests and exact collision counts."""
