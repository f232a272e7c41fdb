"""Routes and shortest polylines against closed forms and another solver."""

import numpy as np
import pytest
from scipy.optimize import minimize

from jaxsusp.freespace.ellipsoid import largest_ellipsoid
from jaxsusp.freespace.graph import RegionGraph
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.polylines import length


def graph(*boxes) -> RegionGraph:
    built = RegionGraph()
    for lower, upper in boxes:
        halves = HalfSpaces.box(np.array(lower, float), np.array(upper, float))
        built.add(Region(halves, largest_ellipsoid(halves)))
    return built


CORNER = graph(([0, 0, 0], [1, 4, 1]), ([0, 3, 0], [4, 4, 1]), ([9, 9, 0], [10, 10, 1]))


@pytest.mark.fast
def test_round_a_corner():
    """The shortest way through an L goes through its inner corner (1, 3)."""
    start, goal = np.array([0.5, 0, 0.5]), np.array([4, 3.5, 0.5])
    assert CORNER.adjacency.tolist() == [[False, True, False], [True, False, False], [False] * 3]
    assert CORNER.connect(start, goal)
    route = CORNER.route(start, goal)
    assert route == [0, 1]
    polyline, bound = CORNER.shortest_polyline(route, start, goal)
    expected = np.hypot(0.5, 3) + np.hypot(3, 0.5)
    assert length(polyline) == pytest.approx(expected, rel=1e-6)
    assert bound == pytest.approx(expected, rel=1e-6)
    np.testing.assert_allclose(polyline[1], [1, 3, 0.5], atol=1e-3)


@pytest.mark.fast
def test_no_way_to_another_part():
    start, elsewhere = np.array([0.5, 0, 0.5]), np.array([9.5, 9.5, 0.5])
    assert not CORNER.connect(start, elsewhere)
    assert CORNER.route(start, elsewhere) == []
    assert len(set(CORNER.parts.tolist())) == 2


@pytest.mark.fast
def test_one_region_is_a_straight_line():
    start, goal = np.array([0.5, 0, 0.5]), np.array([0.5, 2, 0.5])
    route = CORNER.route(start, goal)
    polyline, bound = CORNER.shortest_polyline(route, start, goal)
    np.testing.assert_array_equal(polyline, [start, goal])
    assert bound == 2


@pytest.mark.fast
def test_the_shorter_of_two_ways_is_taken():
    """A ring of four corridors round a block: the way over the near side."""
    ring = graph(
        ([0, 0, 0], [1, 6, 1]), ([0, 5, 0], [6, 6, 1]), ([5, 0, 0], [6, 6, 1]),
        ([0, 0, 0], [6, 1, 1]),
    )  # fmt: skip
    assert ring.route(np.array([0.5, 2, 0.5]), np.array([5.5, 2, 0.5])) == [0, 3, 2]
    assert ring.route(np.array([0.5, 4, 0.5]), np.array([5.5, 4, 0.5])) == [0, 1, 2]


def test_shortest_polyline_is_that_of_another_solver():
    """Random chains of overlapping boxes against scipy's trust-region method."""
    random = np.random.default_rng(3)
    for _ in range(4):
        centers = np.cumsum(random.uniform(0.6, 1.4, (4, 3)) * [1, -1, 0.5], axis=0)
        boxes = [(c - 0.9, c + 0.9) for c in centers]
        chain = graph(*boxes)
        start, goal = centers[0] - 0.5, centers[-1] + 0.5
        polyline, bound = chain.shortest_polyline([0, 1, 2, 3], start, goal)
        low = np.concatenate([np.maximum(boxes[i][0], boxes[i + 1][0]) for i in range(3)])
        high = np.concatenate([np.minimum(boxes[i][1], boxes[i + 1][1]) for i in range(3)])

        def total(x, start=start, goal=goal):
            return length(np.array([start, *x.reshape(-1, 3), goal]))

        other = minimize(
            total,
            (low + high) / 2,
            bounds=list(zip(low, high, strict=True)),
            method="trust-constr",
        )
        assert length(polyline) == pytest.approx(other.fun, rel=1e-4)
        assert bound <= other.fun * (1 + 1e-6)


@pytest.mark.fast
def test_a_straight_line_in_one_of_several_shared_regions_stays_straight():
    """Start and goal lie in the same two regions, and other regions would be a detour."""
    shared = graph(
        ([0, 0, 0], [4, 2, 1]), ([-1, 0, 0], [5, 2, 1]), ([-1, 0, 0], [1, 3, 1]),
        ([3, 0, 0], [5, 3, 1]),
    )  # fmt: skip
    start, goal = np.array([0.5, 0.1, 0.5]), np.array([3.5, 0.5, 0.5])
    route = shared.route(start, goal)
    assert len(route) == 1
    assert shared.shortest_polyline(route, start, goal)[1] == np.linalg.norm(goal - start)
