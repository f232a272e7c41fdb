"""Where a search may begin: waypoints along the distinct ways through a free space.

The samples of a trajectory are uniform in its parameter, so that waypoints close together hold it
where they are for longer: the sums of Eq. 21 over samples then count little of what comes after.
How many waypoints are gathered at the start is therefore as much a way of its own as the route is,
and so is one that keeps near the height of the start (f2).
"""

from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.freespace.polylines import along
from jaxsusp.freespace.space import FreeSpace

ROUTES, LEVEL = 4, 4
"""Taut routes, and level ways, that are taken into account."""

GATHERED = 4
"""Manners of spacing on a taut route: 0 to 3 waypoints at the start, the others evenly."""

NEAR = 0.004
"""Share of the route between gathered waypoints."""


class Starts(NamedTuple):
    """Candidates worth starting from; NaN in rows that only fill up."""

    x: Float[np.ndarray, "*stack starts dim"]  # m
    spread: Float[np.ndarray, "*stack starts dim"]  # m, from a waypoint to the nearer neighbour


def starts_of(space: FreeSpace, waypoints: int) -> Starts:
    """Waypoints (x1, y1, z1, x2, …) on the ways that a free space knows of its task."""
    shortest = [route.polyline for route in space.routes[:ROUTES]] or [space.polyline]
    evenly = [_on(line, waypoints, 0) for line in space.level[:LEVEL]]
    taut = [
        _on(line, waypoints, gathered)
        for gathered in range(min(GATHERED, waypoints))
        for line in shortest
    ]
    ends = space.polyline[[0]], space.polyline[[-1]]
    knots = np.array([np.concatenate([ends[0], row, ends[1]]) for row in taut + evenly])
    gaps = np.linalg.norm(np.diff(knots, axis=1), axis=2)
    spread = np.repeat(np.minimum(gaps[:, 1:], gaps[:, :-1]), 3, axis=1)
    fill = np.full((ROUTES * GATHERED + LEVEL - len(knots), 3 * waypoints), np.nan)
    x = knots[:, 1:-1].reshape(len(knots), -1)
    return Starts(np.concatenate([x, fill]), np.concatenate([spread, fill]))


def _on(line: Float[np.ndarray, "points 3"], waypoints: int, gathered: int) -> np.ndarray:
    """Waypoints (m, 3) on a polyline: so many at its start, the others evenly along the rest."""
    close = NEAR * np.arange(1, gathered + 1)
    rest = np.linspace(NEAR * gathered, 1, waypoints - gathered + 2)[1:-1]
    return along(line, np.concatenate([close, rest]))
