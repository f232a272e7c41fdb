"""Distinct ways from start to goal through the regions, and the level ways that are short enough.

Looked at are all sequences of regions where there are few, else the shortest ways, from crossing to
crossing of regions, by way of every crossing and of two of them that are far apart. Pulled taut,
many of them become one; of those that can be drawn into one another before, the shortest is pulled.
"""

from collections.abc import Iterator, Sequence
from itertools import islice, pairwise, permutations
from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from jaxsusp.errors import InputError, require, require_count
from jaxsusp.freespace.graph import RegionGraph
from jaxsusp.freespace.iris import MANY
from jaxsusp.freespace.orientation import NO_TURN, Turn
from jaxsusp.freespace.polyhedra import HalfSpaces, Point, Points, nearest_point
from jaxsusp.freespace.polylines import GRAZE, Polyhedra, distinct, length
from jaxsusp.freespace.space import FreeSpace, Route

TOUCH = 0.03
"""m from a body within which a way is said to bend round it: regions keep off round bodies."""

BESIDE = 0.3
"""m from a body within which a bend is said to be past it: a way is taut in its regions, and those
do not always fill the room between bodies."""

OPEN = "a bend in the open"
"""Said of a bend that is further from all bodies."""

CLIMB = 1.0
"""By how much dearer a metre of a level way is per metre of height above or below the start."""

FEW = 60
"""Sequences of regions up to which all of them are looked at."""

PAIRED = 16
"""Crossings far apart by way of every two of which a way is looked at."""

DRAFTS = 16
"""Distinct ways that are pulled taut at most among more than `iris.MANY` bodies."""

_PULLS = 6


def routes(
    space: FreeSpace | Any,
    start: Point | Sequence | None = None,
    goal: Point | Sequence | None = None,
    count: int = 8,
) -> list[Route]:
    """Distinct taut polylines from start to goal, shortest first.

    Locally shortest: the shortest through their regions, with corners cut wherever regions allow.
    Two are distinct if one cannot be drawn straight into the other without meeting a body.

    Args:
        space: convex regions, and the bodies between them.
        start: where they begin (m); default the start of the space's own task.
        goal: where they end (m); default its goal.
        count: how many at most; where there are fewer, those that there are.

    Raises:
        InputError: start or goal in no region, or a space that does not know its bodies or in
            which its task, if that is asked for, is not connected.
    """
    require(isinstance(space, FreeSpace), "space: give a FreeSpace, see jaxsusp.free_space")
    require_count("count", count)
    if start is None or goal is None:
        require(space.connected, "start and goal: give them, the space does not connect its own")
        start = space.polyline[0] if start is None else start
        goal = space.polyline[-1] if goal is None else goal
    if len(space.bodies) < space.details.get("bodies", 0):
        raise InputError("space: was written by an earlier version, without bodies; map it again")
    try:
        given = np.array([start, goal], np.float64)
    except (TypeError, ValueError):
        given = np.empty(0)
    require(
        given.shape == (2, 3) and bool(np.isfinite(given).all()),
        f"start = {start!r}, goal = {goal!r}: give each as three finite numbers [x, y, z] in m",
    )
    space, frame = space.own, space.frame
    ends = frame.inside(given)
    graph = RegionGraph.of(space.regions, space.adjacency)
    for name, place, own in zip(("start", "goal"), given, ends, strict=True):
        if not graph.holding(own):
            raise InputError(f"{name} = {place.tolist()} is in no region of the free space")
    search = WaySearch(graph, space.bodies, space.body_names, *ends)
    return [each.stated(frame) for each in islice(search.routes(), count)]


class WaySearch:
    """Ways between two places that lie in regions."""

    def __init__(
        self, graph: RegionGraph, bodies: Sequence[HalfSpaces], names: Sequence[str],
        start: Point, goal: Point, turn: Turn = NO_TURN,
    ):  # fmt: skip
        self._turn = turn  # of what is looked at against the world, for words
        self.graph, self.start, self.goal = graph, start, goal
        self._adjacency = graph.adjacency
        self.names, self.bodies = names, bodies
        self.solid = Polyhedra(bodies, -GRAZE)
        self.free = Polyhedra([region.polytope for region in graph.regions], 1e-9)
        crossings = np.argwhere(np.triu(self._adjacency)).tolist()
        members = [{*graph.holding(start)}, {*graph.holding(goal)}, *map(set, crossings)]
        self._members = np.zeros((len(members), len(graph.regions)), bool)
        for row, regions in enumerate(members):
            self._members[row, [*regions]] = True
        middles = [_middle(graph, i, j) for i, j in crossings]
        self.places = np.array([start, goal, *middles])
        self._known: dict[tuple[int, ...], Points] = {}

    def routes(self) -> Iterator[Route]:
        """Distinct taut ways by length."""
        if (few := self._sequences()) is None:
            drafts = sorted(map(self._pulled, self._drafts()), key=length)
            most = DRAFTS if len(self.bodies) > MANY else None
            taut = [self._taut(line) for line in islice(distinct(self.solid, drafts), most)]
        else:
            taut = [self._shortest(sequence) for sequence in few]
        taut.sort(key=length)
        for line in distinct(self.solid, taut):
            bends = [self._bend(line, at) for at in range(1, len(line) - 1)]
            bends = [one for one, before in zip(bends, ["", *bends], strict=False) if one != before]
            yield Route(line, tuple(self._sequence(line)), length(line), tuple(bends))

    def _sequences(self) -> list[list[int]] | None:
        """All sequences of regions, each once, from start to goal; None where they are many."""
        goals, found = {*self.graph.holding(self.goal)}, []
        growing = [[first] for first in self.graph.holding(self.start)]
        while growing:
            sequence = growing.pop()
            if sequence[-1] in goals:
                found.append(sequence)
            onward = {*np.flatnonzero(self._adjacency[sequence[-1]]).tolist()} - {*sequence}
            growing += [[*sequence, region] for region in onward]
            if len(found) + len(growing) > FEW:
                return None
        return found

    def level(self) -> Iterator[Points]:
        """Distinct ways that keep near the height of the start, cheapest first (not taut)."""
        return distinct(self.solid, sorted(self._drafts(CLIMB), key=self._price))

    def _price(self, line: Points) -> float:
        climbed = np.abs(line[:, 2] - self.start[2])
        each = np.linalg.norm(np.diff(line, axis=0), axis=1)
        return float((each * (1 + CLIMB * (climbed[1:] + climbed[:-1]) / 2)).sum())

    def _drafts(self, climb: float = 0.0) -> Iterator[Points]:
        """The shortest way, those by way of every crossing, and of two that are far apart."""
        beside = (self._members[:, None] & self._members[None]).any(axis=2)
        climbed = np.abs(self.places[:, 2] - self.start[2])
        price = 1 + climb * (climbed[:, None] + climbed[None]) / 2
        lengths = np.linalg.norm(self.places[:, None] - self.places[None], axis=2)
        beside &= lengths > 0  # 0 would be no edge
        weights = csr_array(np.where(beside, price * lengths, 0))
        count = len(self.places)
        far = _spread_out(lengths[2:, 2:], PAIRED) + 2
        sources = np.concatenate([[0, 1], far])
        _, found = dijkstra(weights, directed=False, indices=sources, return_predecessors=True)
        before = dict(zip(sources.tolist(), found, strict=True))
        ways = [*((via,) for via in range(1, count)), *permutations(far.tolist(), 2)]
        seen = set()
        for vias in ways:
            way = _by(before, vias)
            if way is not None and len({*way}) == len(way) and way not in seen:
                seen.add(way)
                yield self.places[[*way]]

    def _pulled(self, line: Points) -> Points:
        """The polyline without the corners that can be cut within the regions."""
        kept, at = [line[0]], 0
        while at < len(line) - 1:
            ahead = len(line) - 1
            while ahead > at + 1 and not self.free.cover(line[at], line[ahead]):
                ahead -= 1
            kept.append(line[ahead])
            at = ahead
        return np.array(kept)

    def _sequence(self, line: Points) -> list[int]:
        """Regions along a polyline."""
        found: list[int] = []
        for one, two in pairwise(line):
            found += [r for r in self.free.cover(one, two) if not found or found[-1] != r]
        return found

    def joined(self, route: Route) -> list[int]:
        """The regions of a route, if each shares room with the next; else none."""
        pairs = pairwise(route.regions)
        return [*route.regions] if all(self._adjacency[i, j] for i, j in pairs) else []

    def _taut(self, line: Points) -> Points:
        """The shortest polyline through its regions, corners cut, until it shrinks no more.

        At a corner, going through a further region that holds it can shorten the way.
        """
        sequence = self._sequence(line)
        if not all(self._adjacency[i, j] for i, j in pairwise(sequence)):
            return line  # regions that touch without sharing room
        for _ in range(_PULLS):
            shorter = self._shortest(sequence)
            longer = [self._shortest(each) for each in self._with_one_more(sequence, shorter)]
            best = min([shorter, *longer], key=length)
            if length(best) > length(line) - 1e-6:
                return line
            line, sequence = best, self._sequence(best)
        return line

    def _shortest(self, sequence: list[int]) -> Points:
        """The shortest polyline through a sequence of regions, corners cut."""
        key = tuple(sequence)
        if key not in self._known:
            task = self.start, self.goal
            line = self.graph.shortest_polyline(sequence, *task, bounded=False)[0]
            moves = np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-9
            self._known[key] = self._pulled(line[np.append(True, moves)])
        return self._known[key]

    def _with_one_more(self, sequence: list[int], line: Points) -> Iterator[list[int]]:
        """The sequence with a region between two that hold a corner, and that holds it too."""
        for corner in line[1:-1]:
            holding = {*self.graph.holding(corner)}
            for at, (one, two) in enumerate(pairwise(sequence)):
                if {one, two} <= holding:
                    for more in holding - {*sequence}:
                        if self._adjacency[one, more] and self._adjacency[more, two]:
                            yield [*sequence[: at + 1], more, *sequence[at + 1 :]]

    def _bend(self, line: Points, at: int) -> str:
        """What a corner of a polyline goes round, and on which side; or past what it goes."""
        excess = [body.excess(line[at]) for body in self.bodies]
        if min(excess, default=np.inf) > BESIDE:
            return OPEN
        if min(excess) > TOUCH:
            return f"past {self.names[int(np.argmin(excess))]}"
        before, after = line[at] - line[at - 1], line[at + 1] - line[at]
        outward = before / np.linalg.norm(before) - after / np.linalg.norm(after)
        return f"{_side(outward @ self._turn)} {self.names[int(np.argmin(excess))]}"


def _middle(graph: RegionGraph, i: int, j: int) -> Point:
    """A place in a crossing, between those nearest to both centres."""
    crossing = graph.crossing(i, j)
    found = [nearest_point(crossing, graph.regions[k].ellipsoid.d).point for k in (i, j)]
    return np.mean([point for point in found if point is not None], axis=0)


def _side(normal: Point) -> str:
    if abs(normal[2]) > 0.7:
        return "over" if normal[2] > 0 else "under"
    axis = int(np.abs(normal[:2]).argmax())
    return f"on the {'+' if normal[axis] > 0 else '-'}{'xy'[axis]} side of"


def _spread_out(lengths: np.ndarray, count: int) -> np.ndarray:
    """Rows that are far from one another, each the furthest from those before it."""
    if not len(lengths):
        return np.empty(0, int)
    chosen = [0]
    while len(chosen) < min(count, len(lengths)):
        chosen.append(int(lengths[chosen].min(axis=0).argmax()))
    return np.unique(chosen)


def _by(before: dict[int, np.ndarray], vias: tuple[int, ...]) -> tuple[int, ...] | None:
    """Places from start to goal by way of others, each leg the shortest; None: no such way."""
    if any(before[0][via] < 0 or (via != 1 and before[1][via] < 0) for via in vias):
        return None
    way = _trace(before[0], vias[0])[::-1]
    for one, two in pairwise(vias):
        way += _trace(before[one], two)[::-1][1:]
    return (*way, *_trace(before[1], vias[-1])[1:])


def _trace(before: np.ndarray, at: int) -> list[int]:
    """From a place back to where the search began."""
    way = [at]
    while before[way[-1]] >= 0:
        way.append(int(before[way[-1]]))
    return way
