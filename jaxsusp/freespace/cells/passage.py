"""How narrow it gets: the passage that every way from start to goal has to use.

The room of a position is what load and cables keep there beyond the distances required of them. The
width of a task is twice the least room on the way that has most of it: by half of it
`limits.clearance` could grow before no way was left, the ground apart. For the load alone, it is
how much further its centre could be moved from side to side.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.cells.forbidden import Errand, Forbidden, forbidden_of
from jaxsusp.freespace.cells.ways import cell_of, shortest, widest
from jaxsusp.freespace.polyhedra import Point, Points
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.scenario.ownunits import in_words
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario

ALONG = 64
"""Cells along the longest side of the workspace in which the widest way is looked for."""

_COARSEST = 8
_ROUNDS = 25  # of moving a way to where there is more room
_FAR = 1e3  # m, the room where nothing is forbidden


class Passage(NamedTuple):
    """The narrowest place of the widest way from start to goal."""

    width: float  # m that a way is known to have; 0: no way is known
    error: float  # m; no way has more than width + error
    place: tuple[float, float, float]  # of the load's centre, m
    end: str  # "task.start" or "task.goal", where the place is that
    between: tuple[str, ...]  # what leaves least room there, of two obstacles at most
    only: bool | None  # whether the free space knows one distinct taut way; None: it knows none

    @property
    def words(self) -> str:
        """One line for people."""
        which = {True: "the only way", False: "one of several ways", None: "no way"}
        if np.isinf(self.width):
            return "no obstacle narrows the way"
        where = in_words(self.place)
        return (
            f"the widest way is narrowest at {self.end or 'the load position'} {where}: "
            f"{self.width:.3g} to {self.width + self.error:.3g} m, by "
            f"{' and '.join(self.between)}; {which[self.only]} that its regions know"
        )


def passage(scenario: Scenario | Named, space: FreeSpace | None = None) -> Passage:
    """The narrowest passage that a task must use, a measure of how hard it is.

    The widest way from centre to centre of cells (bottleneck shortest path), moved sideways to
    where there is most room, bounds the width from below; the cells, which a way can leave by half
    their diagonal, bound it from above.

    Args:
        scenario: the task; where its ends move, the load alone counts.
        space: its free space, if it is at hand; it knows whether there are several ways, as far
            as its regions reach into small corners.

    Raises:
        InputError: as from `free_space`.
    """
    asked = load_scenario(scenario)
    scenario = asked.own
    forbidden = forbidden_of(scenario)
    space = free_space(scenario) if space is None else space
    only = len(space.routes) == 1 if space.routes else None
    if not len(forbidden):
        return Passage(np.inf, 0.0, asked.task.start, "", (), only)
    errand = Errand.of(scenario)
    place, room, _, most = narrowest_place(forbidden, errand)
    off = np.linalg.norm(np.array(errand[2:]) - place, axis=1)
    end = ("task.start", "task.goal")[off.argmin()] if off.min() < 1e-6 else ""
    x, y, z = asked.units.place(place).tolist()
    width, error = asked.units.number(np.array([2 * max(room, 0.0), 2 * most]), "m").tolist()
    error = max(error - width, 0.0)
    return Passage(width, error, (x, y, z), end, beside(forbidden, place), only)


class Widest(NamedTuple):
    """The widest way that is found without any free space."""

    width: float  # m that it is known to have; 0: no way is known
    ways: tuple[Points, Points]  # m, polylines from start to goal, the second with more room


def widest_way(scenario: Scenario) -> Widest:
    """As `passage`, for a task with one obstacle at least."""
    found = narrowest_place(forbidden_of(scenario.own), Errand.of(scenario.own))
    width = scenario.units.number(2 * max(found.room, 0.0), "m")
    one, other = map(scenario.units.place, found.ways)
    return Widest(width, (one, other))


class Narrowest(NamedTuple):
    """Where the widest way that was found has least room."""

    place: Point  # m
    room: float  # m that all of the way has; if above zero, the way exists
    ways: tuple[Points, Points]  # m, polylines: the way by cells, and moved to where is most room
    most: float  # m; every way has no more somewhere


def narrowest_place(forbidden: Forbidden, errand: Errand) -> Narrowest:
    """The narrowest place of the widest way between two positions.

    Args:
        forbidden: what narrows it, one body at least.
        errand: the two, and the box that the way stays in.
    """
    lower, upper, *places = errand
    task = np.array(places)
    rooms, size = _rooms(forbidden, lower, upper)
    first, last = (cell_of(place, lower, size, rooms.shape) for place in task)
    ends = forbidden.least(task)
    rooms[first], rooms[last] = ends
    best = widest(rooms, first, last)
    cells = shortest(rooms >= best, size, first, last)
    line = np.concatenate([task[:1], lower + (cells[1:-1] + 0.5) * size, task[1:]])
    place, room, ways = _roomiest(forbidden, line, float(np.linalg.norm(size)) / 4, (lower, upper))
    most = min(best + float(np.linalg.norm(size)) / 2, float(ends.min()))
    return Narrowest(place, room, ways, most + forbidden.rounding(lower, upper))


def _rooms(
    forbidden: Forbidden, lower: Point, upper: Point
) -> tuple[Float[np.ndarray, "x y z"], Float[np.ndarray, "3"]]:
    """Room (m) at the centres of cells, and their size (m).

    Cells are halved; their parts look only at bodies that can leave the least room in them.
    """
    sides = upper - lower
    count = np.maximum(1, np.ceil(_COARSEST * sides / sides.max() - 1e-9)).astype(int)
    index = np.indices(count).reshape(3, -1).T
    body = np.tile(np.arange(len(forbidden)), len(index))
    index, along = np.repeat(index, len(forbidden), axis=0), _COARSEST
    while True:
        size = sides / count
        room = forbidden.room(lower + (index + 0.5) * size, body)
        least = np.full(count, np.inf)
        np.minimum.at(least, tuple(index.T), room)
        if along == ALONG:
            return least, size
        near = room <= least[tuple(index.T)] + np.linalg.norm(size)
        parts = 2 * index[near][:, None] + np.indices((2, 2, 2)).reshape(3, -1).T
        index, body = parts.reshape(-1, 3), np.repeat(body[near], 8)
        count, along = 2 * count, 2 * along


def _roomiest(
    forbidden: Forbidden, line: Points, spacing: float, box: tuple[Point, Point]
) -> tuple[Point, float, tuple[Points, Points]]:
    """The narrowest place of a way moved sideways to where there is most room, its room, both ways.

    Points stay on planes across the way, so that none leaves a gap behind it. What is returned
    holds for all points of the way, or of the given one where that has more room.
    """
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    gone = np.append(0, np.cumsum(steps))
    knots = np.unique(np.append(gone, np.arange(0, gone[-1], spacing)))
    points = np.stack([np.interp(knots, gone, c) for c in line.T], axis=1)
    rooms = forbidden.least(points)
    found = _narrowest(forbidden, points)
    if found[1] >= min(rooms[0], rooms[-1]) - _TOLERANCE:  # at an end, which stays where it is
        return *found, (points, points)
    moved = np.flatnonzero(rooms[1:-1] < rooms.min() + 8 * spacing) + 1
    near = forbidden.nearby(points[moved], 24 * spacing)
    across = _across(points, moved)
    shifted, step = points.copy(), 2 * spacing
    for _ in range(_ROUNDS):
        tried = shifted[moved, None] + step * across
        room = near.least(tried.reshape(-1, 3)).reshape(len(moved), -1)
        room[((tried < box[0]) | (tried > box[1])).any(axis=-1)] = -np.inf
        best = room.argmax(axis=1)
        shifted[moved] = tried[np.arange(len(moved)), best]
        step *= 0.8
    most = max(found, _narrowest(forbidden, shifted), key=lambda pair: pair[1])
    return *most, (points, shifted)


def _across(points: Points, which: np.ndarray) -> Float[np.ndarray, "n ways 3"]:
    """Unit vectors square to a way at some of its points, eight round about, and none."""
    last = len(points) - 1
    along = points[np.minimum(which + _REACH, last)] - points[np.maximum(which - _REACH, 0)]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    least = np.eye(3)[np.abs(along).argmin(axis=1)]
    one = np.cross(along, least)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    angle = np.arange(8)[:, None] * np.pi / 4
    round_about = np.cos(angle) * one[:, None] + np.sin(angle) * np.cross(along, one)[:, None]
    return np.concatenate([np.zeros((len(which), 1, 3)), round_about], axis=1)


_REACH = 6
"""Points on either side whose line gives the direction of a way."""


def _narrowest(forbidden: Forbidden, points: Points) -> tuple[Point, float]:
    """The narrowest of some points of a polyline, and a room (m) that all of it has.

    That is 1 mm below the least at most. Room changes by no more than 1 m per metre: between two
    points there is at least half of the sum of their rooms less their distance. Segments for which
    that is too little are halved.
    """
    rooms = forbidden.least(points)
    a, b, at_a, at_b = points[:-1], points[1:], rooms[:-1], rooms[1:]
    place, least, low = points[rooms.argmin()], rooms.min(), rooms.min()
    while len(a):
        bound = (at_a + at_b - np.linalg.norm(b - a, axis=1)) / 2
        fine = bound >= least - _TOLERANCE
        low = min(low, bound[fine].min(initial=np.inf))
        a, b, at_a, at_b = a[~fine], b[~fine], at_a[~fine], at_b[~fine]
        middle = (a + b) / 2
        room = forbidden.least(middle)
        if len(room) and room.min() < least:
            place, least = middle[room.argmin()], room.min()
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
        at_a, at_b = np.concatenate([at_a, room]), np.concatenate([room, at_b])
    return place, float(low)


_TOLERANCE = 1e-3  # m


def beside(forbidden: Forbidden, place: Point) -> tuple[str, ...]:
    """What leaves least room at a place, of two obstacles."""
    bodies = np.arange(len(forbidden))
    room = forbidden.room(np.tile(place, (len(bodies), 1)), bodies)
    nearest: dict[int, int] = {}
    for body in np.argsort(room, kind="stable").tolist():
        nearest.setdefault(int(forbidden.owner[body]), body)
    return tuple(map(forbidden.name, [*nearest.values()][:2]))
