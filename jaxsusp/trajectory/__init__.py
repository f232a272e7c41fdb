"""Trajectories through waypoints: Makima interpolation."""
