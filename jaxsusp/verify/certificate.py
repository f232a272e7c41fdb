"""A proof that load and cables stay clear at every instant of the real curve, or where they fail.

At one instant MuJoCo gives the distance of two bodies and the direction n of the nearest points.
The plane with normal n that just touches the fixed body is then a proof that outlasts the instant:
as long as the moving body stays on its other side the two cannot meet. How far that body can go
towards the plane follows from proven bounds of the path's derivatives, and the fixed body's extent
along n is a closed form, so the certificate rests on MuJoCo only for the choice of the plane.
Parameter intervals for which the proof fails are halved until every one is proved or a parameter
with too little clearance is found. Intervals that might hold a smaller clearance than the least
found so far are halved as well: the least clearance is exact to `TOLERANCE` where nothing fails.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.scenario import Scenario
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.scene import Fixed, Scene, fixed_bodies

TOLERANCE = 1e-4
"""m; how exact the least clearances are."""

ROUNDING = 1e-6
"""m; how far below the required clearance a distance may be, above MuJoCo's own error."""

NEAR_HOOK = 0.1
"""Share of a cable's length, from its lower end, that is not checked against other cables: there
they come together by construction."""

_COARSE = 2e-3  # m; how exact the least distance of a pair that fails has to be
_NARROW = 1e-5  # m of the parameter; an interval that short without a proof is a failure
_MOST = 400_000  # distances, beyond which a proof is given up

KINDS = (
    "load to obstacles",
    "cables to obstacles",
    "load to arms",
    "cables to arms",
    "cables to each other",
    "arms to obstacles",
    "arms to each other",
    "ends to each other",
)
"""What is measured, in the order of the report; the first five move."""


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


class Contact(NamedTuple):
    """The first time at which a pair is closer than required (or not proved to be further)."""

    time: float  # s
    bodies: tuple[str, str]
    value: float  # m, the distance then
    required: float  # m
    least: float  # m, the least distance seen of this pair


@dataclass(frozen=True)
class Certificate:
    """What the check of one plan found."""

    proved: bool
    clearances: tuple[Clearance, ...]
    contacts: tuple[Contact, ...]  # first of every pair that fails, earliest first
    distances: int  # how many were computed


class _Pairs(NamedTuple):
    """Moving pairs, one row each: a body (0 load, k + 1 cable) against a fixed body or a cable."""

    body: np.ndarray
    other: np.ndarray  # index of the fixed body, or of the other cable where kind is 4
    kind: np.ndarray
    required: np.ndarray


def certify(
    scenario: Scenario,
    law: TimeLaw,
    ends: Float[Array, "cables xyz"],
    chains: Float[Array, "cables points=4 xyz"],
    first_only: bool = False,
) -> Certificate:
    """Check load, cables and arms of a plan with fixed ends along its real curve.

    Required are the warning distance ϑ between load, cables, arms and obstacles, and between load
    or cables and arms; `limits.separation` between arms and ends of different robots; and that
    cables do not touch each other. A cable is checked against the column and the upper link of
    its own arm; it begins at the end of the lower one.

    Args:
        scenario: obstacles, sizes and distances required.
        law: the curve of the load's centre and when it is where.
        ends: upper cable ends P_k (m).
        chains: foot, shoulder, elbow and end of every robot (m).
        first_only: stop at the first failure that is found, for a planner that only wants to know.

    Returns:
        A `Certificate`.
    """
    ends = np.asarray(ends, np.float64)
    bodies = fixed_bodies(scenario, chains)
    scene = Scene(scenario, bodies, len(ends))
    still = _standing(scenario, scene, bodies, ends)
    search = _Search(scenario, law, ends, bodies, scene, first_only)
    if not (first_only and any(each.slack < -ROUNDING for each in still)):
        search.run()
    contacts = [
        Contact(0.0, each.bodies, each.value, each.required, each.value)
        for each in still
        if each.slack < -ROUNDING
    ]
    contacts = sorted([*search.contacts(), *contacts], key=lambda contact: contact.time)
    clearances = (*search.clearances(), *_least(still))
    return Certificate(
        not contacts and search.finished, clearances, tuple(contacts), search.distances
    )


def _standing(
    scenario: Scenario, scene: Scene, bodies: Sequence[Fixed], ends: np.ndarray
) -> list[Clearance]:
    """Distances between bodies that stand still."""
    gap, apart = scenario.limits.clearance, scenario.limits.separation
    found = []
    for i, one in enumerate(bodies):
        for j in range(i + 1, len(bodies)):
            other = bodies[j]
            if one.robot == other.robot:
                continue
            kind = 5 if one.robot < 0 else 6
            value, _ = scene.distance(i, j)
            required = apart if kind == 6 else gap
            found.append(Clearance(KINDS[kind], value, required, 0.0, (other.name, one.name)))
    for k in range(len(ends)):
        for j in range(k):
            value = float(np.linalg.norm(ends[k] - ends[j]))
            names = f"end of robot {k + 1}", f"end of robot {j + 1}"
            found.append(Clearance(KINDS[7], value, apart, 0.0, names))
    return found


def _least(still: list[Clearance]) -> list[Clearance]:
    """The least of every kind of standing pair."""
    nothing = [Clearance(kind, np.inf, 0.0, 0.0, ("", "")) for kind in KINDS[5:]]
    return [
        min([each for each in still if each.kind == none.kind] or [none], key=lambda c: c.value)
        for none in nothing
    ]


class _Search:
    """Halving of parameter intervals, level by level over all pairs at once."""

    def __init__(self, scenario, law, ends, bodies, scene, first_only):
        self._path: SmoothPath = law.path
        self._law: TimeLaw = law
        self._ends: np.ndarray = ends
        self._bodies: Sequence[Fixed] = bodies
        self._scene: Scene = scene
        self._first_only: bool = first_only
        self._hook = np.array([0.0, 0.0, scenario.payload.height / 2])
        self._load = scenario.payload.radius, scenario.payload.height / 2
        self._cable = scenario.limits.cable_radius
        self._pairs = _moving_pairs(scenario, bodies, len(ends))
        count = len(self._pairs.body)
        self._first = np.full(count, np.inf)  # parameter of the first failure of every pair
        self._first_value = np.full(count, np.nan)
        self._least = np.full(count, np.inf)
        self._best = np.full(5, np.inf)  # least distance of every kind, where, and of which pair
        self._best_at = np.zeros(5)
        self._best_pair = np.zeros(5, int)
        self.distances = 0
        self.finished = False

    def run(self) -> None:
        """Prove, or find failures."""
        low, high = self._path.span
        pair = np.arange(len(self._pairs.body))
        a, b = np.full(len(pair), low), np.full(len(pair), high)
        while len(pair):
            pair, a, b = self._halve(pair, a, b)
            if self._first_only and np.isfinite(self._first).any():
                return
            if self.distances > _MOST:
                return
        self.finished = True

    def _halve(self, pair, a, b):
        """Look at the middles of intervals, and return the halves of those that need it."""
        middle, half = (a + b) / 2, (b - a) / 2
        center = self._path.curve(middle)
        value, normal = self._measure(pair, center)
        self._note(pair, middle, value)
        kind, required = self._pairs.kind[pair], self._pairs.required[pair] - ROUNDING
        lower = self._lower_bound(pair, middle, half, center, value, normal)
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

    def _measure(self, pair, center) -> tuple[np.ndarray, np.ndarray]:
        """Distances and directions (from the other body to the moving one) at given positions."""
        scene, ends = self._scene, self._ends
        value, normal = np.empty(len(pair)), np.empty((len(pair), 3))
        hooks = center + self._hook
        rows = zip(*(column[pair].tolist() for column in self._pairs[:3]), strict=True)
        for row, (body, other, kind) in enumerate(rows):
            hook = hooks[row]
            if kind == 4:
                for k in (body - 1, other):
                    scene.place_cable(k, hook + NEAR_HOOK * (ends[k] - hook), ends[k])
                other = scene.load + 1 + other
            elif body:
                scene.place_cable(body - 1, hook, ends[body - 1])
            else:
                scene.place_load(center[row])
            value[row], normal[row] = scene.distance(other, scene.load + body)
        self.distances += len(pair)
        return value, normal

    def _note(self, pair, middle, value) -> None:
        """Remember failures and least distances."""
        np.minimum.at(self._least, pair, value)
        failed = value < self._pairs.required[pair] - ROUNDING
        for row in np.flatnonzero(failed):
            if middle[row] < self._first[pair[row]]:
                self._first[pair[row]] = middle[row]
                self._first_value[pair[row]] = value[row]
        kinds = self._pairs.kind[pair]
        for kind in range(5):
            rows = np.flatnonzero(kinds == kind)
            if len(rows) and value[rows].min() < self._best[kind]:
                row = rows[value[rows].argmin()]
                self._best[kind], self._best_at[kind] = value[row], middle[row]
                self._best_pair[kind] = pair[row]

    def _lower_bound(self, pair, middle, half, center, value, normal) -> np.ndarray:
        """Proven lower bounds of the distances over whole intervals."""
        speed, bend = self._path.bounds(middle - half, middle + half)
        velocity = self._path.derivatives[0](middle)
        isotropic = value - ROUNDING - 2 * speed * half  # twice: two cables may both move
        towards = np.abs((normal * velocity).sum(axis=-1)) * half + 0.5 * bend * half**2
        plane = np.full(len(pair), -np.inf)
        body, other, kind = (column[pair] for column in self._pairs[:3])
        at = (normal * center).sum(axis=-1)
        hook = at + normal @ self._hook
        radius, half_height = self._load
        for kind_of_body in np.unique(body):
            rows = np.flatnonzero((body == kind_of_body) & (kind != 4))
            n = normal[rows]
            if kind_of_body == 0:
                level = np.hypot(n[:, 0], n[:, 1])
                nearest = at[rows] - towards[rows] - radius * level - half_height * np.abs(n[:, 2])
            else:
                upper = n @ self._ends[kind_of_body - 1]
                nearest = np.minimum(hook[rows] - towards[rows], upper) - self._cable
            plane[rows] = nearest - self._support(other[rows], n)
        rows = np.flatnonzero(kind == 4)
        plane[rows] = self._between_cables(
            body[rows] - 1, other[rows], normal[rows], hook[rows], towards[rows]
        )
        fixed = kind != 4
        isotropic[fixed] += (speed * half)[fixed]
        return np.fmax(plane, isotropic)

    def _support(self, fixed: np.ndarray, normal: np.ndarray) -> np.ndarray:
        reached = np.empty(len(fixed))
        for index in np.unique(fixed):
            rows = fixed == index
            reached[rows] = self._bodies[index].shape.support(normal[rows])
        return reached

    def _between_cables(self, one, other, normal, hook, moved) -> np.ndarray:
        """Least gap along a normal between the checked parts of two cables of one moving hook.

        A checked part reaches from P to h + λ (P - h). Of the four differences of such points
        two do not depend on the hook's position h along the normal and two are monotone in it.
        """
        upper, lower = ((normal * self._ends[k]).sum(axis=-1) for k in (one, other))
        share = NEAR_HOOK
        gaps = (
            upper - lower,
            share * (upper - lower),
            share * upper + (1 - share) * (hook - moved) - lower,
            upper - (1 - share) * (hook + moved) - share * lower,
        )
        return np.minimum.reduce(gaps) - 2 * self._cable

    def _names(self, pair: int | np.integer) -> tuple[str, str]:
        body, other, kind, _ = (column[pair] for column in self._pairs)
        moving = f"cable {body}" if body else "load"
        return moving, f"cable {other + 1}" if kind == 4 else self._bodies[other].name

    def contacts(self) -> list[Contact]:
        """First failure of every pair that has one."""
        return [
            Contact(
                float(self._law.time_of(self._first[pair])),
                self._names(pair),
                float(self._first_value[pair]),
                float(self._pairs.required[pair]),
                float(min(self._least[pair], self._first_value[pair])),
            )
            for pair in np.flatnonzero(np.isfinite(self._first))
        ]

    def clearances(self) -> list[Clearance]:
        """Least distances of the moving kinds."""
        found = []
        for kind in range(5):
            if not np.isfinite(self._best[kind]):
                found.append(Clearance(KINDS[kind], np.inf, 0.0, 0.0, ("", "")))
                continue
            pair = self._best_pair[kind]
            found.append(
                Clearance(
                    KINDS[kind],
                    float(self._best[kind]),
                    float(self._pairs.required[pair]),
                    float(self._law.time_of(self._best_at[kind])),
                    self._names(pair),
                )
            )
        return found


def _moving_pairs(scenario: Scenario, bodies: Sequence[Fixed], cables: int) -> _Pairs:
    """Every pair that has to stay apart while the load moves."""
    gap = scenario.limits.clearance
    rows = []
    for index, fixed in enumerate(bodies):
        arm = fixed.robot >= 0
        rows.append((0, index, 2 if arm else 0, gap))
        for k in range(cables):
            if fixed.robot != k or fixed.part < 2:
                rows.append((k + 1, index, 3 if arm else 1, gap))
    rows += [(k + 1, j, 4, 0.0) for k in range(cables) for j in range(k)]
    body, other, kind, required = zip(*rows, strict=True)
    return _Pairs(np.array(body), np.array(other), np.array(kind), np.array(required, float))
