"""The motion over intervals of time, as strips: where load and ends are, and how they move.

The load is at p(u(t)), and u follows from σ u̇ = ṡ with σ = |p'| and the arc length s of the time
law. On an interval that is no more than a wide guess at first; putting the guess into the
right-hand side and integrating gives a narrower one (Picard), which is proved to hold the motion
because it lies in the guess.
"""

from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull

from jaxsusp._types import Float
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.limits.arclength import ArcLength
from jaxsusp.verify.limits.pieces import Pieces
from jaxsusp.verify.limits.strips import Strip, dot

_GUESS = 1.5
"""How much further than at the speed in its middle the load may get in an interval."""

_HEADINGS = 401
"""Places along the path at which it is known how often arms went round."""


class Course:
    """What all intervals of one motion have in common.

    Args:
        rigging: the system along its path.
    """

    def __init__(self, rigging: Rigging):
        self.rigging, law = rigging, rigging.law
        self.schedule = Pieces(law.law.c[:, :, None], law.law.x)
        self.path = Pieces.of_splines(
            [law.path.curve, *(track.curve for track in rigging.tracks)]
        )  # the load, then every end that moves
        self.arc = ArcLength(Pieces.of_splines([law.path.curve]))

    @cached_property
    def gauge(self) -> tuple[np.ndarray, np.ndarray]:
        """1 - ρ of ends that stay, see `edges_of`."""
        return edges_of(self.rigging.end_path[0, :, :2])

    @cached_property
    def _headings(self) -> tuple[np.ndarray, np.ndarray]:
        """Parameters, and φ1 there of arms whose ends move, as it comes to be from the start on.

        NaN where an end could go round its robot's axis between two of the parameters.
        """
        rigging = self.rigging
        u = np.linspace(*rigging.law.path.span, _HEADINGS)
        ends = rigging.ends_at(u)
        way = (ends - rigging.shoulders_at(ends))[..., :2]
        speeds = [track.bounds(u[:-1], u[1:])[0] for track in rigging.tracks]
        moved = np.stack(speeds, axis=1) * np.diff(u)[:, None]
        safe = (moved < np.linalg.norm(way[:-1], axis=-1)).all(axis=0)
        found = np.unwrap(np.arctan2(way[..., 1], way[..., 0]), axis=0)
        return u, np.where(safe, found, np.nan)

    def heading_at(self, times: Float[np.ndarray, "rows"]) -> Float[np.ndarray, "rows cables"]:
        """φ1 (rad) at times (s), to a few degrees."""
        u, known = self._headings
        where = self.rigging.law.parameter(times)
        return np.stack([np.interp(where, u, each) for each in known.T], axis=1)

    def over(self, low: Float[np.ndarray, "rows"], high: Float[np.ndarray, "rows"]) -> "Passage":
        """The motion over intervals of time (s), each within one piece of the time law."""
        return Passage(self, (low + high) / 2, (high - low) / 2)


class Passage:
    """The motion over intervals of time. Strips have the intervals first, vectors last."""

    def __init__(self, course: Course, time: np.ndarray, half: np.ndarray):
        self.course, self.rigging = course, course.rigging
        self.time, self.half = time, half
        which, taylor = course.schedule.at(time)
        self._law = taylor[..., 0], course.schedule.rounding(which)[..., 0]
        self._u = u = self.rigging.law.parameter(time)
        self._piece, self._taylor = course.path.at(u)
        self._rounding = course.path.rounding(self._piece)
        self._follow()

    def _clock(self, order: int) -> Strip:
        """A derivative of the arc length with respect to time, along the path."""
        taylor, rounding = self._law
        powers = np.arange(order, len(taylor))
        falling = np.prod([powers - k for k in range(order)], axis=0)[:, None]
        shares = falling * self.half ** (powers - order)[:, None]
        terms, wrong = shares * taylor[order:], (shares * rounding[order:]).sum(axis=0)
        terms = np.concatenate([terms, np.zeros((3, len(self.time)))])  # laws of low degree
        # s² lies in [0, 1]: half of it belongs to the middle.
        rest = np.abs(terms[2]) / 2 + np.abs(terms[3:]).sum(axis=0) + wrong
        return Strip(terms[0] + terms[2] / 2, terms[1], rest)

    def _follow(self) -> None:
        """How far the parameter can be from that in the middle of every interval."""
        rate, speed = self._clock(1), np.linalg.norm(self._taylor[1][:, :3], axis=-1)
        wrong = self._misplaced(speed)
        most = np.abs(rate.middle) + rate.reach
        self._far = _GUESS * self.half * most / speed + 2 * wrong + 1e-15
        low, high = self._u - self._far, self._u + self._far
        self._jump = self.course.path.jump(self._piece, low, high)
        self._gone = Strip.between(-self._far, self._far)
        for _ in range(2):
            self._onward(rate)
            u1 = self._u1
            bent = self.half * u1.slope / 4
            rest = np.abs(bent) + self.half * u1.rest + wrong
            gone = Strip(bent, self.half * u1.middle, rest * (1 + 1e-12))
            inside = np.abs(gone.middle) + gone.reach <= self._far
            gone.rest = np.where(inside, gone.rest, np.inf)
            self._gone = gone
        self._onward(rate)

    def _onward(self, rate: Strip) -> None:
        """dp/du and du/dt from what is known of u."""
        gone = self._gone
        self._square = gone * gone
        self._p1 = self._along(1)
        self._per_speed = dot(self._p1[:, :3], self._p1[:, :3]).root().inverse()
        self._u1 = rate * self._per_speed

    def _misplaced(self, speed: np.ndarray) -> np.ndarray:
        """How far the parameter in the middle of intervals can be from where the law is."""
        length, wrong = self.course.arc.at(self._u)
        taylor, rounding = self._law
        missed = np.abs(length - taylor[0]) + wrong + rounding[0]
        found = 2 * missed / speed
        bends = np.linalg.norm(self._taylor[:, :, :3], axis=-1)
        powers = range(2, self.course.path.degree + 1)
        change = sum(power * bends[power] * found ** (power - 1) for power in powers)
        return np.where(change < speed / 2, found, np.inf)

    def _along(self, order: int) -> Strip:
        """A derivative of all curves with respect to u: (rows, parts)."""
        taylor, rounding = self._taylor, self._rounding
        degree, far = len(taylor) - 1, self._far[:, None]
        falling = [float(np.prod(np.arange(n, n - order, -1))) for n in range(degree + 1)]
        terms = [falling[n] * taylor[n] for n in range(order, degree + 1)]
        gone, square = self._gone[:, None], self._square[:, None]
        # The highest coefficient is that of one piece; of others in reach it may be different.
        rest = falling[degree] * self._jump * far ** (degree - order) + sum(
            falling[n] * rounding[n] * far ** (n - order) for n in range(order, degree + 1)
        )
        for power, term in enumerate(terms[3:], start=3):
            rest = rest + np.abs(term) * far**power
        found = terms[0] + gone * terms[1]
        if len(terms) > 2:
            found = found + square * terms[2]
        return Strip(found.middle, found.slope, found.rest + rest)

    @cached_property
    def _curves(self) -> Strip:
        """Load and ends that move, (rows, points, 3)."""
        return _points(self._along(0))

    @cached_property
    def _p2(self) -> Strip:
        return self._along(2)

    @cached_property
    def _bend(self) -> Strip:
        """dσ/du."""
        return dot(self._p1[:, :3], self._p2[:, :3]) * self._per_speed

    @cached_property
    def _u2(self) -> Strip:
        return (self._clock(2) - self._bend * (self._u1 * self._u1)) * self._per_speed

    @cached_property
    def position(self) -> Strip:
        """Of the load's centre (m)."""
        return self._curves[:, 0]

    @cached_property
    def ends(self) -> Strip:
        """Upper cable ends (m); one row for all intervals where they stay."""
        return self._curves[:, 1:] if self.rigging.moves else Strip.still(self.rigging.end_path)

    @cached_property
    def _velocities(self) -> Strip:
        return _points(self._p1 * self._u1[:, None])

    @cached_property
    def velocity(self) -> Strip:
        """Of the load (m/s)."""
        return self._velocities[:, 0]

    @cached_property
    def end_velocity(self) -> Strip:
        """Of ends that move (m/s)."""
        return self._velocities[:, 1:]

    @cached_property
    def acceleration(self) -> Strip:
        """Of the load (m/s²)."""
        return (
            self._p1[:, :3] * self._u2[:, None]
            + self._p2[:, :3] * (self._u1 * self._u1)[:, None]
        )  # fmt: skip

    @cached_property
    def jerk(self) -> Strip:
        """Of the load (m/s³)."""
        p1, p2, p3 = (each[:, :3] for each in (self._p1, self._p2, self._along(3)))
        u1, u2, per_speed = self._u1, self._u2, self._per_speed
        bend = self._bend
        turn = (dot(p2, p2) + dot(p1, p3) - bend * bend) * per_speed  # d²σ/du²
        cube = u1 * u1 * u1
        u3 = (self._clock(3) - turn * cube - 3 * (bend * (u1 * u2))) * per_speed
        return p1 * u3[:, None] + 3 * (p2 * (u1 * u2)[:, None]) + p3 * cube[:, None]


def _points(parts: Strip) -> Strip:
    """(rows, 3 n) → (rows, n, 3)."""
    shape = len(parts.middle), -1, 3
    return Strip(*(each.reshape(shape) for each in (parts.middle, parts.slope, parts.rest)))


def edges_of(
    ends: Float[np.ndarray, "cables 2"],
) -> tuple[Float[np.ndarray, "edges 2"], Float[np.ndarray, "edges"]]:
    """1 - ρ of ends that stay, as linear functions of a place of which it is the least.

    ρ is the gauge of the convex hull of the ends about its area centroid, see
    `mechanics.stability.polygon_gauge`: every edge has one linear function, 0 on the edge and 1 at
    the centroid.
    """
    hull = ends[ConvexHull(ends).vertices]
    following = np.roll(hull, -1, axis=0)
    area = hull[:, 0] * following[:, 1] - hull[:, 1] * following[:, 0]
    center = ((hull + following) * area[:, None]).sum(axis=0) / (3 * area.sum())
    along = following - hull
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    height = (normal * (center - hull)).sum(axis=1)
    slopes = normal / height[:, None]
    return slopes, 1 - slopes @ center
