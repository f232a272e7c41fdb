"""Sect. 3.3: force-position coordination, where the cables' ends go."""
