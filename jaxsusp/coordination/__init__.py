"""Sect. 3.3: force-position coordination, the placement of the cables' upper ends."""
