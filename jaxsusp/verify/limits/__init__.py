"""Limits proved at every instant: enclosures of all quantities over intervals of time, halved."""
