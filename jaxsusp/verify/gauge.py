"""Distances of all pairs of a plan's bodies, wherever these are: at any times, for curves."""

from collections.abc import Sequence

import numpy as np

from jaxsusp._types import Float, Int
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.pairs import KINDS, System
from jaxsusp.verify.scene import Scene

ENDS = KINDS.index("ends to each other")
GROUND = KINDS.index("load to the ground")  # and those behind it


class Gauge:
    """Measures the pairs of a system for given places of its points.

    Args:
        system: bodies and pairs; those that stand still are placed once.
    """

    def __init__(self, system: System):
        self.system, self._bodies = system, system.bodies
        self._scene = Scene(self._bodies)
        columns = np.array([each[:3] for each in system.pairs], int).T
        self.one, self.other, self.kind = columns
        self.required = np.array([each.required for each in system.pairs])
        spans = np.array([(body.first, body.second) for body in self._bodies])
        self.span_one, self.span_other = spans[self.one], spans[self.other]
        moves = system.moves
        self.moving = moves[self.span_one].any(axis=1) | moves[self.span_other].any(axis=1)
        self._placed = {i for i, span in enumerate(spans) if not moves[span].any()}
        rig = system.rigging
        start = np.array(rig.law.path.span[:1])
        points = system.locate(rig.law.path.curve(start), rig.ends_at(start))[0]
        for index in self._placed:
            self._scene.place(index, *points[spans[index]])

    def measure(
        self, pair: Int[np.ndarray, " rows"], points: Float[np.ndarray, "rows points xyz"]
    ) -> tuple[Float[np.ndarray, " rows"], Float[np.ndarray, "rows xyz"]]:
        """Distances (m) of pairs and directions from the other body to the one.

        Args:
            pair: indices of pairs.
            points: of the whole system, one set per row (m).
        """
        scene, placed = self._scene, self._placed
        value, normal = np.empty(len(pair)), np.empty((len(pair), 3))
        columns = self.one, self.other, self.kind, self.span_one, self.span_other
        rows = zip(*(column[pair].tolist() for column in columns), strict=True)
        for row, (one, other, kind, (a, b), (c, d)) in enumerate(rows):
            if kind >= GROUND:
                ground = self._bodies[other].obstacle
                lowest = min(points[row, a, 2], points[row, b, 2]) - self._bodies[one].below
                value[row], normal[row] = lowest - ground.height, (0.0, 0.0, 1.0)
                continue
            if kind == ENDS:
                way = points[row, a] - points[row, c]
                value[row] = np.sqrt(way @ way)
                normal[row] = way / max(value[row], 1e-12)
                continue
            if one not in placed:
                scene.place(one, points[row, a], points[row, b])
            if other not in placed:
                scene.place(other, points[row, c], points[row, d])
            value[row], normal[row] = scene.distance(other, one)
        return value, normal


def least_distances(
    rigging: Rigging, times: Float[np.ndarray, "times"], kinds: Sequence[int]
) -> Float[np.ndarray, "times kinds"]:
    """Least distance of every kind of pair at given instants; nothing is said of the time between.

    Args:
        rigging: the system along its path, in the task's own units.
        times: s, in own units.
        kinds: which of `KINDS`.

    Returns:
        Distances; infinite where there is no pair of a kind, or where none of its pairs moves.
    """
    gauge = Gauge(System(rigging))
    u = rigging.law.parameter(times)
    points = gauge.system.locate(rigging.law.path.curve(u), rigging.ends_at(u))
    place = np.full(len(KINDS), -1)
    place[list(kinds)] = range(len(kinds))
    pairs = np.flatnonzero(gauge.moving & (place[gauge.kind] >= 0))
    found = np.full((len(times), len(kinds)), np.inf)
    for row, each in zip(found, points, strict=True):
        value, _ = gauge.measure(pairs, np.broadcast_to(each, (len(pairs), *each.shape)))
        np.minimum.at(row, place[gauge.kind[pairs]], value)
    return found
