"""Start and goal where the load must not be: what blocks them, and the nearest places for them."""

import math
from collections.abc import Callable
from itertools import islice
from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull

from jaxsusp._types import Float
from jaxsusp.freespace.bodies import bodies_of, domain_of
from jaxsusp.freespace.polyhedra import HalfSpaces, nearest_point
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario import admissible
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.cableloads import cable_loads
from jaxsusp.suspension.workspace import Workspace

TRIED = 40
"""Places, nearest first, that are looked at before there is said to be none."""

FINENESS = 1e-3
"""Own units of length to which places are rounded, down to a power of ten in m."""

HOOK, SEPARATE = (400, 100), (60, 16)
"""Directions that are looked into for a free place, and places on each of them; with separate
attachments every place costs an equilibrium."""

REACH = 9.0
"""Own units of length to look where there is no region at all."""

Places = Float[np.ndarray, "places xyz"]


class Misplaced(NamedTuple):
    """A place of the task where the load must not be."""

    place: str  # "task.start" or "task.goal"
    at: tuple[float, float, float]  # m
    reasons: tuple[str, ...]  # a sentence each
    nearest: tuple[float, float, float] | None  # m, rounded and admissible; None: none is known

    @property
    def name(self) -> str:
        """Start or goal, in one word."""
        return self.place.removeprefix("task.")

    @property
    def words(self) -> str:
        """What blocks it, and where else it could be."""
        return f"{'; '.join(self.reasons)}. {self.remedy}"

    @property
    def remedy(self) -> str:
        """Where else it could be."""
        if self.nearest is None:
            return f"No admissible place was found near {self.place}."
        away = math.dist(self.at, self.nearest)
        shown = f"[{', '.join(f'{c:.12g}' for c in self.nearest)}]"
        return f"The nearest admissible place found is {self.place} = {shown}, {away:.3g} m away."


def misplaced(scenario: Scenario, space: Workspace | FreeSpace) -> tuple[Misplaced, ...]:
    """Start and goal where the load must not be, with the nearest place of a map for each.

    Args:
        scenario: read with `task_checked=False`, or else nothing is wrong with its task.
        space: its workspace or its free space. Candidates are the nearest free places all round,
            and what the map knows: centres of usable cells, or regions.
    """
    free, known = _Free(scenario, space), _known(scenario, space)
    found = []
    for place, at in (("task.start", scenario.task.start), ("task.goal", scenario.task.goal)):
        reasons = [line for line in scenario.troubles if line.startswith(place)]
        if not reasons and isinstance(space, FreeSpace) and f"{place} = " in space.reason:
            reasons = [space.reason]
        if reasons:
            beside = known(scenario.units.inside(at))
            choices = (
                _admissible(scenario, place, scenario.units.place(candidates))
                for candidates in (beside, free.around(scenario.units.inside(at), beside))
            )
            there = [choice for choice in choices if choice is not None]
            nearest = min(there, key=lambda choice: math.dist(choice, at), default=None)
            found.append(Misplaced(place, at, tuple(reasons), nearest))
    return tuple(found)


def _decimals(scenario: Scenario) -> int:
    """Of coordinates in m: as many as a task of this size needs."""
    return max(0, math.ceil(-math.log10(FINENESS * scenario.units.length) - 1e-9))


def _admissible(
    scenario: Scenario, place: str, candidates: Places
) -> tuple[float, float, float] | None:
    """The first of some places where the load can be held and the checks find nothing."""
    name, decimals = place.removeprefix("task."), _decimals(scenario)
    candidates = candidates.round(decimals)
    held = _held(scenario.own, scenario.units.inside(candidates))
    for x, y, z in islice(candidates[held].tolist(), TRIED):
        task = scenario.task.model_copy(update={name: (x, y, z)})
        lines = admissible.misplaced(scenario.model_copy(update={"task": task}))
        if not any(line.startswith(place) for line in lines):
            return x, y, z
    return None


def _held(own: Scenario, places: Places) -> np.ndarray:
    """At which places tensions and lengths are within their limits, ends as given; in own units."""
    if moving(own.drive) or not len(places):  # ends that move are nowhere yet
        return np.ones(len(places), bool)
    loads = cable_loads(own, places)
    held = np.ones(len(places), bool)
    for values, (low, high) in (
        (loads.static, own.limits.tension), (loads.lengths, own.limits.cable_length),
    ):  # fmt: skip
        held &= ((values >= low) & (values <= high)).all(axis=1)  # NaN is within none
    return held


def _known(scenario: Scenario, space: Workspace | FreeSpace) -> Callable[[np.ndarray], Places]:
    """What a map knows to be free, those near to a place first, in own units.

    Of a workspace the centres of usable cells; of a free space the nearest place in every region,
    and its middle.
    """
    if isinstance(space, Workspace):
        cells = np.argwhere(space.usable)
        axes = zip(space.axes, cells.T, strict=True)
        centres = scenario.units.inside(np.stack([axis[n] for axis, n in axes], axis=-1))
        return lambda to: _by_distance(centres, to)
    hanging, regions = _hanging(scenario.own), space.own.regions
    rooms = [region.polytope & hanging for region in regions]

    def near(to: np.ndarray) -> Places:
        inwards = _inwards(scenario)
        found = [nearest_point(HalfSpaces(A, b - inwards), to).point for A, b in rooms]
        found = [point for point in found if point is not None]
        found += [region.ellipsoid.d for region in regions]
        places = np.array(found).reshape(-1, 3)
        return _by_distance(places[_held(scenario.own, places)], to)

    return near


class _Free:
    """Free places, whether in a region or cell or not, that stay free when they are rounded."""

    def __init__(self, scenario: Scenario, space: Workspace | FreeSpace):
        self.bodies = (
            space.own.bodies
            if isinstance(space, FreeSpace)
            else [body.faces for body in bodies_of(scenario.own)]
        )
        self.own = scenario.own
        self.domain = domain_of(scenario.own) & _hanging(scenario.own)
        self.inwards = _inwards(scenario)

    def holds(self, points: Places) -> np.ndarray:
        found = self.domain.excess(points) <= -self.inwards
        for body in self.bodies:
            found[found] = body.excess(points[found]) >= self.inwards
        found[found] = _held(self.own, points[found])
        return found

    def around(self, to: np.ndarray, known: Places) -> Float[np.ndarray, "free xyz"]:
        """The first free place on each of many rays from a point, no farther than the known."""
        reach = math.dist(known[0], to) if len(known) else REACH
        count, places = HOOK if self.own.payload.attachments == "hook" else SEPARATE
        k = np.arange(count) + 0.5
        up, turn = 1 - 2 * k / count, math.pi * (1 + math.sqrt(5)) * k  # evenly over the sphere
        level = np.sqrt(1 - up**2)
        rays = np.stack([level * np.cos(turn), level * np.sin(turn), up], axis=1)
        rays = np.concatenate([np.eye(3), -np.eye(3), rays])
        steps = reach * np.arange(1, places + 1) / places
        points = to + steps[:, None, None] * rays
        clear = self.holds(points.reshape(-1, 3)).reshape(places, -1)
        first, some = clear.argmax(axis=0), np.flatnonzero(clear.any(axis=0))
        return _by_distance(points[first[some], some], to)


def _inwards(scenario: Scenario) -> float:
    """Own units by which a place is inside, so that rounding leaves it there."""
    return 10.0 ** -_decimals(scenario) / scenario.units.length


def _hanging(scenario: Scenario) -> HalfSpaces:
    """Below the ends and between them, as the checks of a task have it."""
    payload, ends = scenario.payload, np.array([robot.end for robot in scenario.robots])
    hook = payload.attachments == "hook"
    offset = np.zeros(2) if hook else np.array(payload.center_of_mass[:2])
    sides = ConvexHull(ends[:, :2], qhull_options="QJ").equations  # also of ends in a line
    height = (ends - attachments_of(scenario))[:, 2].min()
    A = np.column_stack([sides[:, :2], np.zeros(len(sides))])
    b = -sides[:, 2] - sides[:, :2] @ offset
    return HalfSpaces(np.vstack([A, [0.0, 0.0, 1.0]]), np.append(b, height))


def _by_distance(places: Places, at: np.ndarray) -> Places:
    return places[np.argsort(np.linalg.norm(places - at, axis=1), kind="stable")]
