"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

FEWEST, MOST = 3, 12
"""Robots on the ring of a new scenario."""
