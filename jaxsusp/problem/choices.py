"""What a person chooses from; light to import, so that a mistyped choice is answered at once."""

SEARCHES = ("free-space", "ellipsoid", "box")
"""What waypoints are kept in: the polytopes of the free space, the ellipsoids in them (the paper's
rule), or the workspace; see `problem.search`."""

CONTACTS = ("swept", "sampled")
"""Where contacts are looked for: at every instant of the polyline, or at its samples alone, which
is the paper's check and misses what happens between two of them; see `geometry.collisions`."""
