"""Which regions meet, the way through them from start to goal, and the shortest polyline on it."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Int
from scipy.optimize import linprog
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from jaxsusp.freespace.ellipsoid import SOLVER
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces, Point, Points, nearest_point


class RegionGraph:
    """Regions joined where their polytopes intersect; grows by one region at a time."""

    def __init__(self):
        self.regions: list[Region] = []
        self._meets: list[list[bool]] = []

    @classmethod
    def of(cls, regions: Sequence[Region], adjacency: Bool[np.ndarray, "n n"]) -> "RegionGraph":
        """A graph whose adjacency is known."""
        graph = cls()
        graph.regions = list(regions)
        graph._meets = [row[:i].tolist() for i, row in enumerate(adjacency)]
        return graph

    def add(self, region: Region) -> None:
        """Take in a region."""
        self._meets.append([_meet(region, other) for other in self.regions])
        self.regions.append(region)

    @property
    def adjacency(self) -> Bool[np.ndarray, "regions regions"]:
        """Which regions intersect; symmetric, False on the diagonal."""
        count = len(self.regions)
        found = np.zeros((count, count), bool)
        for i, row in enumerate(self._meets):
            found[i, :i] = row
        return found | found.T

    @property
    def parts(self) -> Int[np.ndarray, " regions"]:
        """Number of the connected part that each region belongs to."""
        return connected_components(csr_array(self.adjacency), directed=False)[1]

    def holding(self, point: Point) -> list[int]:
        """Regions that a point lies in."""
        return [i for i, r in enumerate(self.regions) if r.polytope.excess(point) <= _TOUCH]

    def connect(self, start: Point, goal: Point) -> bool:
        """Whether a way through intersecting regions leads from start to goal."""
        if not self.regions:
            return False
        parts = self.parts
        return not {*parts[self.holding(start)]}.isdisjoint(parts[self.holding(goal)])

    def route(self, start: Point, goal: Point) -> list[int]:
        """The sequence of regions whose way from centre to centre of their crossings is shortest.

        The vertices of the search are the crossings (pairs of adjacent regions) and the two ends;
        an edge leads through one region.

        Returns:
            Indices of regions, the first holding start and the last goal; empty where there is
            no way.
        """
        crossings = np.argwhere(np.triu(self.adjacency)).tolist()
        places = np.array(
            [start, goal, *(center(self.crossing(i, j)) for i, j in crossings)], np.float64
        )
        members: list[set[int]] = [set(self.holding(start)), set(self.holding(goal))]
        members += [set(pair) for pair in crossings]
        edges = sorted(
            {
                pair
                for region in range(len(self.regions))
                for pair in _pairs([at for at, regions in enumerate(members) if region in regions])
            }
        )
        if not edges:
            return []
        rows, columns = np.array(edges).T
        # A length of zero would mean "no edge".
        lengths = np.linalg.norm(places[rows] - places[columns], axis=1) + 1e-9
        weights = csr_array((lengths, (rows, columns)), shape=(len(places),) * 2)
        _, before = dijkstra(weights, directed=False, indices=0, return_predecessors=True)
        if before[1] < 0:
            return []
        way = [1]
        while way[-1] != 0:
            way.append(int(before[way[-1]]))
        steps = pairwise(members[at] for at in reversed(way))
        return _without_detours([min(one & two) for one, two in steps])

    def shortest_polyline(
        self,
        route: Sequence[int],
        start: Point,
        goal: Point,
        solver: str = SOLVER,
        bounded: bool = True,
    ) -> tuple[Points, float]:
        """The shortest polyline through a sequence of regions, one point per crossing.

        A second-order cone program: minimise Σ ‖x_{i+1} - x_i‖ with x_i in the i-th crossing. Each
        segment lies in one convex region, so the polyline is as clear as the regions are.

        Returns:
            The polyline (m) with start and goal, and a lower bound (m) that holds for every
            polyline through this sequence of regions, whatever the solver's tolerance; 0 if it is
            not asked for (`bounded`).
        """
        crossings = [self.crossing(i, j) for i, j in pairwise(route)]
        if not crossings:
            return np.array([start, goal]), float(np.linalg.norm(goal - start))
        import cvxpy as cp  # takes long, and most free spaces come from a cache

        x = cp.Variable((len(crossings), 3))
        points = cp.vstack([start[None], x, goal[None]])
        lengths = cp.Variable(len(crossings) + 1)
        steps = cp.SOC(lengths, (points[1:] - points[:-1]).T)
        inside = [c.A @ x[i] <= c.b for i, c in enumerate(crossings)]
        problem = cp.Problem(cp.Minimize(cp.sum(lengths)), [steps, *inside])
        problem.solve(solver=solver)
        assert x.value is not None, problem.status
        # Solvers stop a little outside: the nearest points inside are exactly in both regions.
        exact = [
            nearest_point(crossing, point).point
            for crossing, point in zip(crossings, np.asarray(x.value), strict=True)
        ]
        assert all(point is not None for point in exact)
        assert steps.dual_value is not None
        line = np.array([start, *exact, goal])
        if not bounded:
            return line, 0.0
        pulls = -np.asarray(steps.dual_value[1]).T
        return line, _least_length(crossings, pulls, start, goal)

    def crossing(self, i: int, j: int) -> HalfSpaces:
        """What two regions share."""
        return self.regions[i].polytope & self.regions[j].polytope


_TOUCH = 1e-9
"""m that a point may lie outside a region it is said to be in."""

_ROOM = 1e-6
"""Radius (m) of a ball that two regions must share to count as intersecting: what is thinner is
below the tolerances of solvers, and of any crane."""


def worth_keeping(
    found: Sequence[Region], samples: Points, covered: np.ndarray, share: float
) -> Iterator[Region]:
    """The region that covers most more samples, and others that add at least a share of that.

    Updates `covered` before it hands one on.
    """
    gains = {i: region.polytope.excess(samples) <= 0 for i, region in enumerate(found)}
    least = 0.0
    while gains:
        sums = {i: int((gain & ~covered).sum()) for i, gain in gains.items()}
        best = max(sums, key=sums.__getitem__)
        if sums[best] < least:
            return
        least = least or share * max(sums[best], 1)
        covered |= gains.pop(best)
        yield found[best]


def _meet(one: Region, two: Region) -> bool:
    """Whether two polytopes share more than a touch."""
    both = one.polytope & two.polytope
    roomy = HalfSpaces(both.A, both.b - _ROOM)
    found = nearest_point(roomy, one.ellipsoid.d).point
    return found is not None and bool(both.excess(found) < 0)  # where they all but touch, look


def _least_length(crossings: list[HalfSpaces], pulls: Points, start: Point, goal: Point) -> float:
    """A length that no polyline through the crossings falls below, by weak duality.

    For any vectors y_i with ‖y_i‖ <= 1, Σ ‖x_{i+1} - x_i‖ >= Σ y_i · (x_{i+1} - x_i), whose least
    value over every crossing is a linear program. The solver's dual variables make it tight.
    """
    y = pulls / np.maximum(1, np.linalg.norm(pulls, axis=1, keepdims=True))
    least = float(y[-1] @ goal - y[0] @ start)
    for crossing, cost in zip(crossings, y[:-1] - y[1:], strict=True):
        found = linprog(cost, crossing.A, crossing.b, bounds=(None, None), method="highs")
        least += found.fun if found.fun is not None else -np.inf
    return least - 1e-7 * (1 + abs(least))  # HiGHS is exact to 1e-7


def center(halves: HalfSpaces) -> Point:
    """Centre of the largest ball in a polytope (m)."""
    rows = np.column_stack([halves.A, np.ones(len(halves.b))])
    free = [(None, None)] * 3 + [(0, None)]
    found = linprog([0, 0, 0, -1], rows, halves.b, bounds=free, method="highs")
    assert found.x is not None, found.message  # a crossing has room, as _meet knows
    return found.x[:3]


def _pairs(items: list[int]) -> list[tuple[int, int]]:
    return [(one, two) for at, one in enumerate(items) for two in items[at + 1 :]]


def _without_detours(route: list[int]) -> list[int]:
    """The route with every region once in a row."""
    return [region for at, region in enumerate(route) if at == 0 or region != route[at - 1]]
