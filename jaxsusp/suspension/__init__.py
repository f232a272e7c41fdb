"""Sect. 2 for a scenario: the whole system at given load positions, and along a path.

`level` has ends, lengths and tensions of a level load as arrays for the search, `hanging` the
equilibrium posture of separate attachments, `loads` what cables carry along a motion, `arms` and
`reach` the robots, `rigging` all of it along a path; `workspace` maps where a load can be held.
"""
