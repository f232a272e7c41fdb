"""Rooms beside convex polytopes, counted square to their faces.

What has faces is grown by moving them out, as in the fitness: by what load, or cable, and clearance
reach in the direction of each. So the room beside it is no distance but the least of those from the
planes, which near an edge is a little less. What is forbidden for certain is a smaller body, the
hull of places at which the two do touch.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from jaxsusp.freespace.polyhedra import HalfSpaces, Points
from jaxsusp.geometry.polytopes import Polytope

_RING = 16  # directions about the vertical in which a round body is inscribed


class Faceted(NamedTuple):
    """A polytope grown by a load or a cable, about the world's origin (m)."""

    outer: HalfSpaces  # as far as load or cable reach; clearance is not in it
    inner: HalfSpaces  # where contact is certain, clearance included

    def excess(
        self, points: Points, way: Points | None, steps: int, inner: bool
    ) -> Float[np.ndarray, " n"]:
        """How far points, or the nearest of segments from points on, are beyond the faces (m).

        Along a segment it is convex: halvings find the place, and what is found is too large by at
        most the segment's length / 2^steps.
        """
        halves = self.inner if inner else self.outer
        if way is None:
            return halves.excess(points)
        at, rise = points @ halves.A.T - halves.b, way @ halves.A.T
        t, step, rows = np.full(len(points), 0.5), 0.5, np.arange(len(points))
        for _ in range(steps):
            slope = rise[rows, (at + t[:, None] * rise).argmax(axis=1)]
            step /= 2
            t += np.where(slope < 0, step, -step)
        ends = (at + (t + side * step)[:, None] * rise for side in (-1, 1))
        return np.minimum(*(end.max(axis=1) for end in ends))


def around_load(body: Polytope, radius: float, half_height: float, clear: float) -> Faceted:
    """Positions of an upright cylinder that touches a polytope (m)."""
    level = np.hypot(body.grown[:, 0], body.grown[:, 1])
    reach = radius * level + half_height * np.abs(body.grown[:, 2])
    angle = 2 * np.pi * np.arange(_RING) / _RING
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(_RING)], axis=1)
    tilts = np.array([0.0, 0.25, 0.5]) * np.pi
    rounded = np.concatenate(
        [
            (radius + clear * np.cos(tilt)) * ring + [0, 0, sign * (half_height + up)]
            for tilt in tilts
            for sign, up in ((1, clear * np.sin(tilt)), (-1, clear * np.sin(tilt)))
        ]
    )
    return Faceted(_outer(body, reach), _hull_of(body.corners, rounded))


def around_sum(body: Polytope, within: Points, clear: float) -> Faceted:
    """Positions of a load that touches an obstacle: their sum, and points within it (m)."""
    return Faceted(_outer(body, np.zeros(len(body.grown))), _hull_of(within, _ball(clear)))


def around_cable(body: Polytope, radius: float, clear: float) -> Faceted:
    """Points at which a ball touches a polytope (m)."""
    outer = _outer(body, np.full(len(body.grown), radius))
    return Faceted(outer, _hull_of(body.corners, _ball(radius + clear)))


def _ball(radius: float) -> Points:
    """Points on a ball about the origin."""
    signs = np.array(list(np.ndindex(3, 3, 3)), float) - 1
    signs = signs[np.abs(signs).sum(axis=1) > 0]
    return radius * signs / np.linalg.norm(signs, axis=1, keepdims=True)


def _outer(body: Polytope, reach: np.ndarray) -> HalfSpaces:
    return HalfSpaces(body.grown, body.support(body.grown) + reach)


def _hull_of(points: Points, around: Points) -> HalfSpaces:
    """The hull of points, each with others around it."""
    equations = ConvexHull((points[:, None] + around).reshape(-1, 3)).equations
    equations = np.unique(equations.round(10), axis=0)  # one per face, not per triangle
    # What rounding moved out is taken back.
    return HalfSpaces(equations[:, :3], -equations[:, 3] - 1e-9)
