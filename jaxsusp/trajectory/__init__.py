"""Curves through waypoints (Makima), smooth paths, and time laws from rest to rest."""
