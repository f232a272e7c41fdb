"""Arms that move their ends over intervals of time, as strips: reach, joint angles and speeds."""

from functools import cached_property

import numpy as np

from jaxsusp.verify.limits.passage import Passage
from jaxsusp.verify.limits.strips import Strip, dot, heading, norm, stacked

_TURN = 2 * np.pi


class Arms:
    """Robots whose ends move during intervals, while their bases stay; K robots.

    Args:
        passage: the motion over the intervals.
    """

    def __init__(self, passage: Passage):
        self._passage, rigging = passage, passage.rigging
        self._links = rigging.links
        self._side = np.where(rigging.elbow_up, 1.0, -1.0)
        shoulders = rigging.shoulders_at(rigging.end_path[:1])[0]
        self._way = passage.ends - shoulders  # from the shoulders to the ends (m)

    @cached_property
    def distance(self) -> Strip:
        """Of ends from their shoulders (m), (rows, K)."""
        return norm(self._way)

    @cached_property
    def _level(self) -> Strip:
        """Horizontal part of that."""
        return norm(self._way[..., :2])

    @cached_property
    def _cosine(self) -> Strip:
        """Cos φ3."""
        _, a2, a3 = self._links.T
        way = self._way
        return (dot(way, way) - (a2**2 + a3**2)) * (1 / (2 * a2 * a3))

    @cached_property
    def _bend(self) -> Strip:
        """φ3."""
        return self._cosine.arc_cosine() * self._side

    @cached_property
    def angles(self) -> Strip:
        """φ1, φ2, φ3 (°), (rows, K, 3); φ1 goes on where it passes ±180°."""
        passage, way, (_, a2, a3) = self._passage, self._way, self._links.T
        first = heading(way[..., 0], way[..., 1])
        turns = np.round((passage.course.heading_at(passage.time) - first.middle) / _TURN) * _TURN
        forward = self._cosine * a3 + a2
        aside = (1.0 - self._cosine * self._cosine).root() * (self._side * a3)
        second = heading(way[..., 2], self._level) - heading(forward, aside)
        return stacked([first + turns, second, self._bend]) * (180 / np.pi)

    @cached_property
    def speeds(self) -> Strip:
        """How fast the joints turn (°/s), (rows, K, 3)."""
        way, velocity = self._way, self._passage.end_velocity
        _, a2, a3 = self._links.T
        level, distance = self._level, self.distance
        x, y = way[..., 0], way[..., 1]
        turning = x * velocity[..., 1] - y * velocity[..., 0]
        per_level = level.inverse()
        first = turning * (per_level * per_level)
        outward = (x * velocity[..., 0] + y * velocity[..., 1]) * per_level
        per_square = distance.inverse()
        per_square = per_square * per_square
        rising = (way[..., 2] * outward - level * velocity[..., 2]) * per_square
        sine = (1.0 - self._cosine * self._cosine).root() * self._side
        third = dot(way, velocity) * sine.inverse() * (-1 / (a2 * a3))
        lagging = third * (self._cosine * (a2 * a3) + a3**2) * per_square
        return stacked([first, rising - lagging, third]) * (180 / np.pi)
