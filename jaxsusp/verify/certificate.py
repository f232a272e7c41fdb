"""A proof that load, cables and arms stay clear at every instant of the real curve.

At one instant MuJoCo gives the distance of two bodies and the direction n of the nearest points.
A plane with normal n between the two is then a proof that outlasts the instant: as long as they
stay on their sides of it they cannot meet. How far their points can go along n follows from proven
bounds of the splines' derivatives, and how far bodies extend beyond their points is a closed form,
so the certificate rests on MuJoCo only for the choice of the direction. Parameter intervals for
which the proof fails are halved until every one is proved or a parameter with too little clearance
is found. Intervals that might hold a smaller clearance than the least found so far are halved as
well: the least clearance is exact to `TOLERANCE` where nothing fails.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jaxsusp.scenario.ownunits import TOUCH, Frame
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.elbow import elbow_speed
from jaxsusp.verify.gauge import Gauge
from jaxsusp.verify.pairs import KINDS, System

TOLERANCE = 1e-4
"""m; how exact the least clearances are."""

ROUNDING = TOUCH
"""m; how far below the required clearance a distance may be, above MuJoCo's own error."""

MOST = 400_000
"""Distances, beyond which a proof is given up."""

_COARSE = 2e-3  # m; how exact the least distance of a pair that fails has to be
_NARROW = 1e-5  # m of the parameter; an interval that short without a proof is a failure


class Clearance(NamedTuple):
    """The least distance of one kind of pair."""

    kind: str
    value: float  # m; +inf where there is no such pair
    required: float  # m
    time: float  # s
    bodies: tuple[str, str]

    @property
    def slack(self) -> float:
        """How much more there is than required (m)."""
        return self.value - self.required

    def stated(self, frame: Frame) -> "Clearance":
        """The same with numbers as a frame makes them."""
        return self._replace(
            value=frame.number(self.value, "m"),
            required=frame.number(self.required, "m"),
            time=frame.number(self.time, "s"),
        )


class Contact(NamedTuple):
    """The first time at which a pair is closer than required (or not proved to be further)."""

    time: float  # s
    bodies: tuple[str, str]
    value: float  # m, the distance then
    required: float  # m
    least: float  # m, the least distance seen of this pair

    def stated(self, frame: Frame) -> "Contact":
        """The same with numbers as a frame makes them."""
        lengths = {name: frame.number(getattr(self, name), "m") for name in _LENGTHS}
        return self._replace(**lengths, time=frame.number(self.time, "s"))


_LENGTHS = ("value", "required", "least")


@dataclass(frozen=True)
class Certificate:
    """What the check of one plan found."""

    proved: bool
    clearances: tuple[Clearance, ...]
    contacts: tuple[Contact, ...]  # first of every pair that fails, earliest first
    distances: int  # how many were computed

    @property
    def finished(self) -> bool:
        """Whether every pair was looked at to the end: all are proved but those of the contacts."""
        return self.proved or (bool(self.contacts) and self.distances <= MOST)

    def stated(self, frame: Frame) -> "Certificate":
        """The same with numbers as a frame makes them."""
        clearances = tuple(each.stated(frame) for each in self.clearances)
        contacts = tuple(each.stated(frame) for each in self.contacts)
        return replace(self, clearances=clearances, contacts=contacts)


def certify(rigging: Rigging, first_only: bool = False) -> Certificate:
    """Check load, cables and arms of a plan along its real curve.

    Required are the warning distance ϑ between load, cables, arms and obstacles, and between load
    or cables and arms; `limits.separation` between arms and ends of different robots; and that
    cables do not touch each other, nor the lower link at whose end they begin, nor a lower link
    its own column. Load, cables and links keep ϑ off the ground.

    Args:
        rigging: the load's curve, with ends and arms.
        first_only: stop at the first failure that is found, for a planner that only wants to know.

    Returns:
        A `Certificate`.
    """
    search = _Search(rigging, first_only)
    search.run()
    contacts = search.contacts()
    return Certificate(
        not contacts and search.finished,
        tuple(search.clearances()),
        tuple(sorted(contacts, key=lambda contact: contact.time)),
        search.distances,
    )


class _Search:
    """Halving of parameter intervals, level by level over all pairs at once."""

    def __init__(self, rigging: Rigging, first_only: bool):
        self._rigging, self._path = rigging, rigging.law.path
        self._system = System(rigging)
        self._gauge = gauge = Gauge(self._system)
        self._bodies = self._system.bodies
        self._first_only: bool = first_only
        self._one, self._other, self._kind = gauge.one, gauge.other, gauge.kind
        self._required, self._moving = gauge.required, gauge.moving
        count = len(self._one)
        self._first = np.full(count, np.inf)  # parameter of the first failure of every pair
        self._first_value = np.full(count, np.nan)
        self._least = np.full(count, np.inf)
        self._best = np.full(len(KINDS), np.inf)  # least distance of every kind, where, which pair
        self._best_at = np.zeros(len(KINDS))
        self._best_pair = np.zeros(len(KINDS), int)
        self.distances = 0
        self.finished = False

    def run(self) -> None:
        """Prove, or find failures."""
        low, high = self._path.span
        pair = np.arange(len(self._one))
        a, b = np.full(len(pair), low), np.where(self._moving, high, low)
        while len(pair):
            pair, a, b = self._halve(pair, a, b)
            if self._first_only and np.isfinite(self._first).any():
                return
            if self.distances > MOST:
                return
        self.finished = True

    def _halve(self, pair, a, b):
        """Look at the middles of intervals, and return the halves of those that need it."""
        middle, half = (a + b) / 2, (b - a) / 2
        center, ends = self._path.curve(middle), self._rigging.ends_at(middle)
        points = self._system.locate(center, ends)
        value, normal = self._gauge.measure(pair, points)
        self.distances += len(pair)
        self._note(pair, middle, value)
        kind, required = self._kind[pair], self._required[pair] - ROUNDING
        lower = self._lower_bound(pair, middle, half, points, ends, value, normal)
        unproved = lower < required
        failing = np.isfinite(self._first[pair])
        stuck = unproved & ~failing & (half < _NARROW)
        np.minimum.at(self._first, pair[stuck], middle[stuck])
        self._first_value[pair[stuck]] = value[stuck]
        earlier = unproved & (a < self._first[pair]) & (half > 10 * _NARROW)
        nearer = (self._least[pair] > 0) & (lower < self._least[pair] - _COARSE)
        go_on = np.where(failing, earlier | (nearer & (half > _COARSE / 2)), unproved & ~stuck)
        go_on |= ~failing & (lower < self._best[kind] - TOLERANCE) & (half > _NARROW)
        pair, a, b, middle = pair[go_on], a[go_on], b[go_on], middle[go_on]
        return np.tile(pair, 2), np.append(a, middle), np.append(middle, b)

    def _note(self, pair, middle, value) -> None:
        """Remember failures and least distances."""
        np.minimum.at(self._least, pair, value)
        failed = value < self._required[pair] - ROUNDING
        for row in np.flatnonzero(failed):
            if middle[row] < self._first[pair[row]]:
                self._first[pair[row]] = middle[row]
                self._first_value[pair[row]] = value[row]
        kinds = self._kind[pair]
        for kind in np.unique(kinds):
            rows = np.flatnonzero(kinds == kind)
            if value[rows].min() < self._best[kind]:
                row = rows[value[rows].argmin()]
                self._best[kind], self._best_at[kind] = value[row], middle[row]
                self._best_pair[kind] = pair[row]

    def _lower_bound(self, pair, middle, half, points, ends, value, normal) -> np.ndarray:
        """Proven lower bounds of the distances over whole intervals."""
        system, rows = self._system, np.arange(len(pair))
        motion = self._motion(middle, half, ends)
        one, other = self._gauge.span_one[pair], self._gauge.span_other[pair]
        plane = np.full(len(pair), np.inf)
        for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
            a, b = one[:, i], other[:, j]
            apart = ((points[rows, a] - points[rows, b]) * normal).sum(axis=-1)
            rate = ((motion.rates[rows, a] - motion.rates[rows, b]) * normal).sum(axis=-1)
            lost = np.abs(rate) * half + motion.rest(system, a, b, half)
            plane = np.minimum(plane, apart - lost)
        plane -= self._reach(self._one[pair], -normal) + self._reach(self._other[pair], normal)
        way = (motion.speed(system, span).max(axis=1) for span in (one, other))
        isotropic = value - ROUNDING - sum(way) * half
        return np.fmax(plane, isotropic)

    def _motion(self, middle, half, ends) -> "_Motion":
        """How fast everything is in the middles of intervals, and at most within them."""
        low, high = middle - half, middle + half
        speed, bend = self._path.spline.bounds(low, high)
        rig, tracks = self._rigging, self._rigging.tracks
        velocity = self._path.derivatives[0](middle)
        if not tracks:
            still = np.zeros((len(middle), rig.cables))
            rates = self._system.rates(velocity, np.zeros((len(middle), rig.cables, 3)))
            return _Motion(rates, speed, bend, still, still, still)
        rates = np.stack([track.derivatives[0](middle) for track in tracks], axis=1)
        speeds, bends = (
            np.stack(each, axis=1)
            for each in zip(*(track.bounds(low, high) for track in tracks), strict=True)
        )
        moved, shoulders = speeds * half[:, None], rig.shoulders_at(ends)
        elbows = elbow_speed(shoulders, rig.links, ends, moved, speeds)
        return _Motion(self._system.rates(velocity, rates), speed, bend, speeds, bends, elbows)

    def _reach(self, body: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """How far bodies go beyond their points, each along its own direction (m)."""
        reached = np.empty(len(body))
        for index in np.unique(body):
            rows = body == index
            reached[rows] = self._bodies[index].reach(normal[rows])
        return reached

    def contacts(self) -> list[Contact]:
        """First failure of every pair that has one."""
        return [
            Contact(
                float(self._rigging.law.time_of(self._first[pair])),
                self._names(pair),
                float(self._first_value[pair]),
                float(self._required[pair]),
                float(min(self._least[pair], self._first_value[pair])),
            )
            for pair in np.flatnonzero(np.isfinite(self._first))
        ]

    def clearances(self) -> list[Clearance]:
        """Least distances of all kinds."""
        found = []
        for kind, name in enumerate(KINDS):
            if not np.isfinite(self._best[kind]):
                found.append(Clearance(name, np.inf, 0.0, 0.0, ("", "")))
                continue
            pair, time = self._best_pair[kind], self._rigging.law.time_of(self._best_at[kind])
            required = float(self._required[pair])
            found.append(
                Clearance(name, float(self._best[kind]), required, float(time), self._names(pair))
            )
        return found

    def _names(self, pair: int | np.integer) -> tuple[str, str]:
        return self._bodies[self._one[pair]].name, self._bodies[self._other[pair]].name


class _Motion(NamedTuple):
    """Rates with respect to the path's parameter, one row per interval."""

    rates: np.ndarray  # of all points in the middle, (rows, points, 3); zero for elbows
    load_speed: np.ndarray  # bounds over the interval: |p'| and |p''| of the load's centre, (rows,)
    load_bend: np.ndarray
    end_speed: np.ndarray  # … and of the ends, (rows, K)
    end_bend: np.ndarray
    elbow_speed: np.ndarray  # (rows, K)

    def rest(self, system: System, a: np.ndarray, b: np.ndarray, half: np.ndarray) -> np.ndarray:
        """How far point a can get towards point b beyond their first-order motion (m)."""
        rows, share, track = np.arange(len(a)), system.share, system.track
        bend = np.abs(system.along[a] - system.along[b]) * self.load_bend
        one = self.end_bend[rows, track[a]]
        other = self.end_bend[rows, track[b]]
        together = np.abs(share[a] - share[b]) * one
        alone = np.abs(share[a]) * one + np.abs(share[b]) * other
        bend = bend + np.where(track[a] == track[b], together, alone)
        return 0.5 * bend * half**2 + (self._elbow(system, a) + self._elbow(system, b)) * half

    def speed(self, system: System, points: np.ndarray) -> np.ndarray:
        """Greatest speed of points (rows, any number)."""
        rows = np.arange(len(points))[:, None]
        ends = np.abs(system.share[points]) * self.end_speed[rows, system.track[points]]
        elbows = np.stack([self._elbow(system, each) for each in points.T], axis=1)
        return np.abs(system.along[points]) * self.load_speed[:, None] + ends + elbows

    def _elbow(self, system: System, points: np.ndarray) -> np.ndarray:
        of = system.elbow_of[points]
        return np.where(of >= 0, self.elbow_speed[np.arange(len(points)), np.maximum(of, 0)], 0.0)
