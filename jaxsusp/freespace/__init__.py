"""Sect. 4.1: the collision-free space of the whole system as convex regions (Eq. 23), on the host.

Everything to be avoided, by the load or by a cable, is a convex body in the space of load
positions (`bodies`); `iris` grows convex regions between them; `graph` joins regions and finds the
way from start to goal; `build` does all of it for a scenario and returns a `space.FreeSpace`.
"""
