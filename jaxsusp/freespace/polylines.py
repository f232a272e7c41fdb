"""Polylines among convex polyhedra: which hold a segment, and which two lines are the same way."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from jaxtyping import Bool, Float

from jaxsusp.freespace.polyhedra import HalfSpaces, Point, Points

SHARES = 48
"""Places at which two ways are compared, beside their corners."""

GRAZE = 1e-3
"""m by which a line may be drawn through the surface of a body: taut ways touch it."""

_STEP = 1e-9

_MANY = 400
"""Members up to which each is looked at for every segment; of more, those about the segments."""

_BLOCK = 2**14
"""Numbers in a block of work: larger arrays cost more in fresh memory than in arithmetic."""


class Polyhedra:
    """Several polyhedra in one array, so that a segment is cut by all of them at once.

    Args:
        members: the polyhedra.
        grown: m by which every face is moved outwards.
    """

    def __init__(self, members: Sequence[HalfSpaces], grown: float = 0.0):
        self.members = tuple(members)
        self._A = np.concatenate([np.empty((0, 3)), *(each.A for each in members)])
        self._b = np.concatenate([np.empty(0), *(each.b for each in members)]) + grown
        counts = [len(each.b) for each in members]
        self._first = np.cumsum([0, *counts[:-1]]) if counts else np.empty(0, int)
        self._stop = np.cumsum(counts, dtype=int)

    def cut(
        self, one: Float[np.ndarray, "*batch 3"], two: Float[np.ndarray, "*batch 3"]
    ) -> tuple[Float[np.ndarray, "*batch n"], Float[np.ndarray, "*batch n"]]:
        """From which to which share of a segment it is inside; the first is larger outside."""
        if not self.members:
            none = np.empty((*one.shape[:-1], 0))
            return none, none
        low, high = _cut(self._A, self._b, one, two)
        low = np.maximum.reduceat(low, self._first, axis=-1)
        high = np.minimum.reduceat(high, self._first, axis=-1)
        return low, high

    def met(self, one: Points, two: Points) -> Bool[np.ndarray, " segments"]:
        """Which segments pass through the inside of any of them.

        Most are beyond one face of a member with both ends, which is quickly told; only the others
        are cut.
        """
        if len(self.members) > _MANY and len(one):
            return self._beside(np.concatenate([one, two]))._met(one, two)
        return self._met(one, two)

    def _met(self, one: Points, two: Points) -> Bool[np.ndarray, " segments"]:
        met = np.zeros(len(one), bool)
        if not self.members or not len(one):
            return met
        rows = max(1, _BLOCK // len(self._b))
        near = np.concatenate(
            [self._near(one[i : i + rows], two[i : i + rows]) for i in range(0, len(one), rows)]
        )
        for member in np.flatnonzero(near.any(axis=0)):
            rows = np.flatnonzero(near[:, member] & ~met)
            faces = slice(self._first[member], self._stop[member])
            low, high = _cut(self._A[faces], self._b[faces], one[rows], two[rows])
            met[rows] = low.max(axis=-1) < high.min(axis=-1)
        return met

    def _beside(self, points: Points) -> "Polyhedra":
        """Those that have no face which the box around some points is beyond."""
        low, high = points.min(axis=0), points.max(axis=0)
        nearest = self._A @ ((low + high) / 2) - np.abs(self._A) @ ((high - low) / 2)
        beyond = np.logical_or.reduceat(nearest > self._b, self._first)
        faces = [
            slice(self._first[member], self._stop[member]) for member in np.flatnonzero(~beyond)
        ]
        return Polyhedra([HalfSpaces(self._A[rows], self._b[rows]) for rows in faces])

    def _near(self, one: Points, two: Points) -> Bool[np.ndarray, "segments members"]:
        """Which members have no face that both ends of a segment are beyond."""
        beyond = (one @ self._A.T > self._b) & (two @ self._A.T > self._b)
        return ~np.logical_or.reduceat(beyond, self._first, axis=-1)

    def cover(self, one: Point, two: Point) -> list[int]:
        """Members that hold a segment one after the other; none where it leaves them all."""
        low, high = self.cut(one, two)
        at, found = 0.0, []
        while at < 1:
            reach = np.where(low <= at + _STEP, high, -1.0)
            best = int(reach.argmax())
            if reach[best] <= at + _STEP:
                return []
            found.append(best)
            at = reach[best] + _STEP
        return found


def _cut(A, b, one, two) -> tuple[np.ndarray, np.ndarray]:
    """From which to which share of its length, in 0 to 1, a segment is behind every face."""
    start, slope = one @ A.T - b, (two - one) @ A.T
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -start / slope
    level = slope == 0
    low = np.where(level, np.where(start > 0, np.inf, 0.0), np.where(slope < 0, at, 0.0))
    high = np.where(slope > 0, at, 1.0)
    return np.maximum(low, 0), np.minimum(high, 1)


def length(line: Points) -> float:
    """Length of a polyline (m)."""
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def along(line: Points, shares: Float[np.ndarray, " shares"]) -> Points:
    """Points of a polyline at shares of its length."""
    at = corners(line)
    return np.stack([np.interp(shares, at, c) for c in line.T], axis=1)


def corners(line: Points) -> Float[np.ndarray, " points"]:
    """At which share of its length each point of a polyline is."""
    arc = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    return arc / max(arc[-1], 1e-12)


def same_way(bodies: Polyhedra, one: Points, other: Points) -> bool:
    """Whether one polyline can be drawn straight into another without meeting a body.

    Points at equal shares of the lengths are joined by straight lines (uniform visibility
    deformation: Zhou, Pan, Gao & Shen, IEEE T-RO 2021). Homotopy would tell too little apart: in
    space, the two ways round a post are joined by those over its top.
    """
    shares = np.unique(
        np.concatenate([corners(one), corners(other), np.linspace(0, 1, SHARES)]).round(9)
    )
    starts, stops = along(one, shares), along(other, shares)
    few = slice(None, None, 8)  # most that differ differ widely
    if bodies.met(starts[few], stops[few]).any():
        return False
    return not bodies.met(starts, stops).any()


def distinct(bodies: Polyhedra, lines: Iterable[Points]) -> Iterator[Points]:
    """Lines that are not the same way as one before them."""
    kept: list[Points] = []
    for line in lines:
        if not any(same_way(bodies, line, other) for other in kept):
            kept.append(line)
            yield line
