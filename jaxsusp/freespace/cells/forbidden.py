"""What is forbidden to the load's centre, by exact distances instead of circumscribed polyhedra.

Every obstacle, as it is or grown by the load, is one formula: a level rectangle rounded by a disk,
times an upright interval, rounded by a ball. Its distance from a point is a closed form; what has
faces instead is left to `cells.faceted`. Two sets
of positions follow, and both are convex: where the load is too near to an obstacle (a Minkowski
sum), and where a cable with a fixed end P is ({P + s (o - P) : s >= 1, o too near}, a shadow).
A cell is therefore wholly inside such a set iff its corners are.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from jaxsusp.freespace.cells.faceted import Faceted, around_cable, around_load, around_sum
from jaxsusp.freespace.polyhedra import Point
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.geometry.sums import inner_points, sums
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.messages import numbered
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of, load_of, lowest, warning_shape

SAFE = 2e-5
"""m by which a distance must fall short before it counts as short: a certificate rounds by 1e-6 m,
and mesh vertices are single precision."""

STEPS = 16
"""Halvings in the search for the place of a cable that is nearest to an obstacle."""

_CHUNK = 8192  # points at a time, so that intermediate results stay in the processor's cache


class Errand(NamedTuple):
    """From where to where the load's centre is to go, and the box it stays in (m)."""

    lower: Point
    upper: Point
    start: Point
    goal: Point

    @classmethod
    def of(cls, scenario: Scenario, beyond: float = 0.0) -> "Errand":
        """That of a task; the box is larger than the workspace by so much (m) all round."""
        box, task = scenario.workspace, scenario.task
        corners = lowest(scenario), box.upper, task.start, task.goal
        lower, upper, start, goal = np.array(corners, float)
        return cls(lower - beyond, upper + beyond, start, goal)


@dataclass(frozen=True, eq=False)
class Forbidden:
    """Convex sets that the load's centre must avoid, one per column.

    The room of a position in view of one of them is the distance of load (or cable) from the
    obstacle less what is required. It changes by at most 1 m per metre of the load's way.
    """

    names: tuple[str, ...]  # of the obstacles
    owner: Int[np.ndarray, " bodies"]  # the obstacle that each belongs to
    cable: Int[np.ndarray, " bodies"]  # the cable that casts it, -1: the load's own
    columns: Float[np.ndarray, "numbers bodies"]  # see `_column`
    steps: int = STEPS
    faceted: dict[int, Faceted] = field(default_factory=dict)  # those with faces, by their column

    def __len__(self) -> int:
        return len(self.owner)

    def name(self, body: int) -> str:
        """The obstacle, and what comes too near to it."""
        who = "load" if self.cable[body] < 0 else f"cable {self.cable[body] + 1}"
        return f"{self.names[self.owner[body]]} ({who})"

    def room(
        self,
        points: Float[np.ndarray, "n 3"],
        body: Int[np.ndarray, " n"],
        inner: bool = False,
    ) -> Float[np.ndarray, " n"]:
        """Room (m) of positions, each in view of one body; not above zero: inside of it.

        Args:
            points: of the load's centre (m).
            body: the body that each is asked about.
            inner: a bound from above for bodies smaller by `SAFE`: what is inside of those is in
                contact for certain. Otherwise a bound from below, for what is clear for certain.
        """
        found = np.empty(len(points))
        for start in range(0, len(points), _CHUNK):
            part = slice(start, start + _CHUNK)
            found[part] = self._room(points[part], body[part], inner)
        return found

    def rounding(self, lower: Point, upper: Point) -> float:
        """By how much (m) a room in a box is less than it is, at most."""
        corners = np.array([*product(*np.transpose([lower, upper]))])
        cables = self.columns[11:17, self.cable >= 0]
        ways = corners[:, :, None] + cables[3:] - cables[:3]
        return float(np.linalg.norm(ways, axis=1).max(initial=0.0)) * 0.5**self.steps

    def least(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """Room (m) of positions in view of everything."""
        return self._each(points).min(axis=1, initial=np.inf)

    def _each(self, points: np.ndarray) -> np.ndarray:
        """Room (m) of positions in view of every body, (n, bodies)."""
        shape, bodies = (len(points), len(self)), np.tile(np.arange(len(self)), len(points))
        return self.room(np.repeat(points, len(self), axis=0), bodies).reshape(shape)

    def without(self, obstacles: set[int]) -> "Forbidden":
        """The same where some obstacles are taken away."""
        return self._some(~np.isin(self.owner, [*obstacles]))

    def nearby(self, points: Float[np.ndarray, "n 3"], reach: float) -> "Forbidden":
        """Those that some point comes near to: so much (m) beyond the least room, at most."""
        rooms = self._each(points)
        least = rooms.min(axis=1, keepdims=True, initial=np.inf)
        return self._some((rooms <= least + reach).any(axis=0))

    def _some(self, kept: np.ndarray) -> "Forbidden":
        columns, which = self.columns[:, kept], np.flatnonzero(kept).tolist()
        faceted = {i: self.faceted[body] for i, body in enumerate(which) if body in self.faceted}
        return Forbidden(
            self.names, self.owner[kept], self.cable[kept], columns, self.steps, faceted
        )

    def _room(self, points: np.ndarray, body: np.ndarray, inner: bool) -> np.ndarray:
        found = np.empty(len(points))
        held = self.cable[body] >= 0
        for rows in map(np.flatnonzero, (held, ~held)):
            column = self.columns[:, body[rows]]
            core, required = _Core(column[3:10]), column[10]
            a = core.turned(points[rows].T + column[14:17] - column[:3])
            if held[rows[:1]].any():
                way = core.turned(column[11:14] - column[:3]) - a
                over = np.sqrt((way**2).sum(axis=0)) * 0.5**self.steps
                distance = core.nearest(a, way, self.steps)
                found[rows] = distance + (SAFE if inner else -over) - required
            else:
                found[rows] = (core.smaller(SAFE) if inner else core).distance(a) - required
        for which in np.intersect1d(body, [*self.faceted]).tolist():
            rows = np.flatnonzero(body == which)
            found[rows] = self._beside_faces(points[rows], which, inner)
        return found

    def _beside_faces(self, points: np.ndarray, body: int, inner: bool) -> np.ndarray:
        """As `_room`, of one body that has faces."""
        column, way, over = self.columns[:, body], None, 0.0
        if self.cable[body] >= 0:
            points = points + column[14:17]
            way = column[11:14] - points
            over = np.linalg.norm(way, axis=1) * 0.5**self.steps
        excess = self.faceted[body].excess(points, way, self.steps, inner)
        return excess if inner else excess - over - column[10]


class _Core:
    """Shapes in their own frames: (rectangle ⊕ disk) × interval ⊕ ball, one per entry (m)."""

    def __init__(self, numbers: Float[np.ndarray, "7 n"]):
        self.numbers = numbers
        self.cos, self.sin = numbers[:2]
        self.half, self.disk, self.ball = numbers[2:5], numbers[5], numbers[6]

    def turned(self, vector: np.ndarray) -> np.ndarray:
        """World direction → the shapes' frames."""
        x, y, z = vector
        return np.stack([self.cos * x + self.sin * y, self.cos * y - self.sin * x, z])

    def smaller(self, by: float) -> "_Core":
        """Shapes that stay so far (m) inside of these, where a load has grown them by as much."""
        return _Core(self.numbers - by * np.array([0, 0, 0, 0, 1, 1, 0])[:, None])

    def distance(self, p: np.ndarray) -> np.ndarray:
        """Distance of points in the shapes' frames (m)."""
        out = np.maximum(np.abs(p) - self.half, 0)
        across = np.maximum(np.sqrt(out[0] ** 2 + out[1] ** 2) - self.disk, 0)
        return np.maximum(np.sqrt(across**2 + out[2] ** 2) - self.ball, 0)

    def nearest(self, a: np.ndarray, way: np.ndarray, steps: int) -> np.ndarray:
        """Distance of segments a + t way (m), too large by at most their length / 2^steps.

        The square of the distance is convex in t: halvings find where its derivative is zero.
        """
        t, step = np.full(a.shape[1], 0.5), 0.5
        for _ in range(steps):
            p = a + t * way
            out = p - np.clip(p, -self.half, self.half)
            across = np.sqrt(out[0] ** 2 + out[1] ** 2)
            share = np.maximum(across - self.disk, 0) / np.maximum(across, 1e-300)
            slope = share * (out[0] * way[0] + out[1] * way[1]) + out[2] * way[2]
            step /= 2
            t += np.where(slope < 0, step, -step)
        low, high = t - step, t + step  # what is left of the segment
        return np.minimum(self.distance(a + low * way), self.distance(a + high * way))


def forbidden_of(scenario: Scenario, cables: bool = True, steps: int = STEPS) -> Forbidden:
    """What a certificate refuses: too small a distance of load or cables from an obstacle.

    Meshes are what stands for them, as in a certificate. Where ends move, or are not settled, a
    position does not say where the cables are: the load's own bodies alone are left.

    Args:
        scenario: the task; its ends are as given.
        cables: whether the ends stay where they are given.
        steps: halvings in the search for the place of a cable that is nearest to an obstacle.
    """
    clear, shape = scenario.limits.clearance, warning_shape(scenario)
    names, columns, owner, cable = [], [], [], []
    rows = [*zip(scenario.robots, attachments_of(scenario), strict=True)]
    if moving(scenario.drive) or not cables:
        rows = []
    faceted, load, inside = {}, load_of(scenario), max(clear - SAFE, 0.0)
    for i, obstacle in enumerate(scenario.obstacles):
        names.append(numbered("obstacles", i, obstacle.name))
        met = [] if load is None else _met(obstacle, load)
        for part, (bare, solid) in enumerate(_bare(obstacle)):
            if load is not None:
                faceted[len(columns)] = around_sum(*met[part], inside)
            elif solid is not None:
                grown = around_load(solid, shape.radius, shape.half_height, inside)
                faceted[len(columns)] = grown
            if solid is not None:
                held = around_cable(solid, shape.cable_radius, inside)
                faceted |= {len(columns) + 1 + k: held for k in range(len(rows))}
            columns.append(bare + _at(7, shape.half_height, shape.radius, 0, clear))
            required = clear if solid is not None else shape.cable_radius + clear
            columns += [bare + _at(10, required, *robot.end, *hung) for robot, hung in rows]
            owner += [i] * (1 + len(rows))
            cable += [*range(-1, len(rows))]
    return Forbidden(
        tuple(names), np.array(owner, int), np.array(cable, int),
        np.array(columns, np.float64).reshape(-1, _NUMBERS).T.copy(), steps, faceted,
    )  # fmt: skip


def _met(obstacle: Any, load: Polytope) -> list[tuple[Polytope, np.ndarray]]:
    """Sums of the bodies of an obstacle with a load, and points within each."""
    return [*zip(sums(obstacle, load), inner_points(obstacle, load), strict=True)]


def _bare(obstacle: Any) -> Iterator[tuple[np.ndarray, Polytope | None]]:
    """The column of an obstacle, and what it is where that has faces: one of each convex body."""
    if obstacle.kind == "mesh" and obstacle.shape != "box":
        for body in obstacle.bodies:
            yield _at(0, *obstacle.center, 1.0), body.placed(obstacle.center, obstacle.yaw_deg)
    else:
        yield _column(obstacle), None


_NUMBERS = 17


def _column(obstacle: Any) -> np.ndarray:
    """An obstacle: centre, cosine and sine of its yaw, half-extents, disk and ball.

    Behind it, zero here: the distance required, the end of a cable, and its lower end from the
    load's centre.
    """
    yaw = np.deg2rad(getattr(obstacle, "yaw_deg", 0.0))
    match obstacle.kind:
        case "box" | "mesh":
            shape = *(np.array(obstacle.size) / 2), 0, 0
        case "cylinder":
            shape = 0, 0, obstacle.height / 2, obstacle.radius, 0
        case "sphere":
            shape = 0, 0, 0, 0, obstacle.radius
        case _:
            raise ValueError(f"nothing is known about an obstacle of kind {obstacle.kind!r}")
    return _at(0, *obstacle.center, np.cos(yaw), np.sin(yaw), *shape)


def _at(first: int, *numbers: Any) -> np.ndarray:
    """A column with so many numbers from a place on, and zeros elsewhere."""
    column = np.zeros(_NUMBERS)
    column[first : first + len(numbers)] = numbers
    return column
