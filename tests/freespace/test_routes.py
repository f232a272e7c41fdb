"""Distinct ways: worlds of posts with known lengths, brute force, and what a way owes."""

from itertools import pairwise, product

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.errors import InputError
from jaxsusp.freespace import routes
from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.graph import RegionGraph
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.polylines import GRAZE, Polyhedra, along, distinct, length, same_way
from jaxsusp.freespace.space import assemble

LOW, HIGH = np.array([-4.0, -4.0, 0.0]), np.array([4.0, 4.0, 1.0])


def box(low, high) -> HalfSpaces:
    return HalfSpaces.box(np.array(low, float), np.array(high, float))


def space_of(regions: list[HalfSpaces], bodies: list[HalfSpaces]) -> js.FreeSpace:
    graph = RegionGraph()
    for polytope in regions:
        lower, upper = -polytope.b[3:], polytope.b[:3]
        graph.add(Region(polytope, Ellipsoid.ball((lower + upper) / 2, (upper - lower).min() / 2)))
    return assemble(
        graph.regions, adjacency=graph.adjacency, route=np.empty(0, int),
        polyline=np.empty((0, 3)), bound=np.inf, coverage=1.0, bodies=tuple(bodies),
        body_names=tuple(f"post {i + 1}" for i in range(len(bodies))),
    )  # fmt: skip


def posts(*centers: float) -> js.FreeSpace:
    """Square posts of width 2 from floor to ceiling, at y = 0; exact regions around them."""
    bodies = [box([x - 1, -1, -9], [x + 1, 1, 9]) for x in centers]
    edges = [LOW[0], *(x + side for x in centers for side in (-1, 1)), HIGH[0]]
    gaps = [box([a, -4, 0], [b, 4, 1]) for a, b in list(pairwise(edges))[::2]]
    sides = [box([-4, 1, 0], [4, 4, 1]), box([-4, -4, 0], [4, -1, 1])]
    return space_of(gaps + sides, bodies)


@pytest.mark.fast
def test_a_post_is_passed_on_either_side():
    found = js.routes(posts(0.0), [-3, 0, 0.5], [3, 0, 0.5])
    assert [each.length for each in found] == pytest.approx([2 * np.hypot(2, 1) + 2] * 2)
    assert sorted(np.sign(each.polyline[1, 1]) for each in found) == [-1, 1]
    assert sorted(each.bends[0] for each in found) == ["on the +y side of post 1",
                                                       "on the -y side of post 1"]  # fmt: skip


@pytest.mark.fast
def test_a_bend_away_from_bodies_is_past_the_nearest_or_in_the_open():
    """Regions that keep off the post: the way is taut in them, and not round the post itself."""
    for off, said in ((0.2, "past post 1"), (0.5, routes.OPEN)):
        post = [box([-1 + off, -1 + off, -9], [1 - off, 1 - off, 9])]
        space = space_of([each.polytope for each in posts(0.0).regions], post)
        found = js.routes(space, [-3, 0, 0.5], [3, 0, 0.5])
        assert [each.bends for each in found] == [(said,)] * 2


@pytest.mark.fast
def test_two_posts_are_passed_in_four_ways():
    """Straight by either side, or across between them."""
    found = js.routes(posts(-2.0, 2.0), [-4, 0, 0.5], [4, 0, 0.5], 9)
    straight = 2 * np.hypot(1, 1) + 6
    across = 2 * np.hypot(1, 1) + 4 + np.hypot(2, 2)
    assert [each.length for each in found] == pytest.approx([straight] * 2 + [across] * 2)
    assert [each.length for each in js.routes(posts(-2.0, 2.0), [-4, 0, 0.5], [4, 0, 0.5], 1)] == [
        pytest.approx(straight)
    ]


@pytest.mark.fast
def test_regions_alone_make_no_second_way():
    """Three ways through other regions, and no body: one way."""
    regions = [
        box([-4, -4, 0], [1, 4, 1]),
        box([-1, -4, 0], [4, 1, 1]),
        box([-1, -1, 0], [4, 4, 1]),
    ]
    found = js.routes(space_of(regions, []), [-3, 0, 0.5], [3, 0, 0.5])
    assert [each.length for each in found] == pytest.approx([6.0])
    assert found[0].bends == ()


@pytest.mark.fast
def test_what_is_in_no_region_is_refused():
    with pytest.raises(InputError, match=r"goal = \[0\.0, 0\.0, 0\.5\] is in no region"):
        js.routes(posts(0.0), [-3, 0, 0.5], [0, 0, 0.5])
    with pytest.raises(InputError, match="count = 0"):
        js.routes(posts(0.0), [-3, 0, 0.5], [3, 0, 0.5], 0)
    with pytest.raises(InputError, match=r"space: give a FreeSpace, see jaxsusp\.free_space"):
        js.routes("scenario-1")
    with pytest.raises(InputError, match="the space does not connect its own"):
        js.routes(posts(0.0))


def simple_sequences(graph: RegionGraph, at: list[int], goals: set[int]):
    if at[-1] in goals:
        yield at
    for other in np.flatnonzero(graph.adjacency[at[-1]]).tolist():
        if other not in at:
            yield from simple_sequences(graph, [*at, other], goals)


@pytest.mark.parametrize("seed", range(6))
def test_brute_force_finds_the_same(seed, monkeypatch):
    """Every sequence of regions, pulled taut, among posts of random places and heights."""
    random = np.random.default_rng(seed)
    x, y = random.uniform(-2.5, 2.5), random.uniform(-0.8, 0.8)
    tall = random.uniform(0.3, 0.9)
    post = box([x - 0.5, y - 1, -9], [x + 0.5, y + 1, tall])
    regions = [
        box([-4, -4, 0], [x - 0.5, 4, 1]), box([x + 0.5, -4, 0], [4, 4, 1]),
        box([-4, y + 1, 0], [4, 4, 1]), box([-4, -4, 0], [4, y - 1, 1]), box([-4, -4, tall], HIGH),
    ]  # fmt: skip
    space = space_of(regions, [post])
    start, goal = np.array([-3.9, 0.1, 0.1]), np.array([3.9, -0.1, 0.1])
    graph = RegionGraph.of(space.regions, space.adjacency)
    goals, every = set(graph.holding(goal)), []
    for first in graph.holding(start):
        for sequence in simple_sequences(graph, [first], goals):
            every.append(graph.shortest_polyline(sequence, start, goal)[0])
    every.sort(key=length)
    solid = Polyhedra(space.bodies, -GRAZE)
    known = [length(line) for line in distinct(solid, every)]
    found = [each.length for each in js.routes(space, start, goal, 9)]
    assert found == pytest.approx(known, abs=1e-6)
    monkeypatch.setattr(routes, "FEW", 0)  # as in larger graphs, where not all are looked at
    found = [each.length for each in js.routes(space, start, goal, 9)]
    assert found[0] <= known[0] + 2e-3
    assert set(np.round(found, 3)) <= set(np.round([length(line) for line in every], 3))


def test_a_way_is_in_its_regions_and_clear_of_all_bodies(scenarios):
    for scenario in (scenarios[0], scenarios[4]):
        space = js.free_space(scenario)
        found = js.routes(space, scenario.task.start, scenario.task.goal, 8)
        assert all(each.bends for each in found)
        assert [each.length for each in found] == sorted(each.length for each in found)
        assert found[0].length <= space.length + 1e-9
        for each in found:
            points = along(each.polyline, np.linspace(0, 1, 500))
            assert min(body.excess(points).min() for body in space.bodies) > 0
            inside = [space.regions[r].polytope.excess(points) <= 2e-9 for r in each.regions]
            assert np.any(inside, axis=0).all()
        solid = Polyhedra(space.bodies, -GRAZE)
        for one, two in product(found, found):
            assert same_way(solid, one.polyline, two.polyline) == (one is two)
        again = [each.length for each in space.routes]
        assert again == pytest.approx([each.length for each in found])


def test_ways_survive_a_file(scenarios, tmp_path):
    space = js.free_space(scenarios[3])
    space.save(tmp_path / "space.nc")
    again = js.load_free_space(tmp_path / "space.nc")
    assert len(again.routes) == len(space.routes) > 0
    for one, two in zip(space.routes, again.routes, strict=True):
        np.testing.assert_array_equal(one.polyline, two.polyline)
        assert one[1:] == two[1:]
    assert all(map(np.array_equal, space.level, again.level))
    assert again.body_names == space.body_names
    for one, two in zip(space.bodies, again.bodies, strict=True):
        np.testing.assert_array_equal(one.A, two.A)


@pytest.mark.fast
def test_a_segment_is_cut_where_it_enters_and_leaves():
    cubes = Polyhedra([box([0, 0, 0], [1, 1, 1]), box([3, -1, -1], [4, 2, 2])])
    low, high = cubes.cut(np.array([-1.0, 0.5, 0.5]), np.array([4.0, 0.5, 0.5]))
    np.testing.assert_allclose(low, [0.2, 0.8])
    np.testing.assert_allclose(high, [0.4, 1.0])
    assert not cubes.met(np.array([[-1.0, 5, 0]]), np.array([[9.0, 5, 0]])).any()
    assert cubes.cover(np.array([0.1, 0.5, 0.5]), np.array([0.9, 0.5, 0.5])) == [0]
    assert cubes.cover(np.array([0.1, 0.5, 0.5]), np.array([3.9, 0.5, 0.5])) == []


@pytest.mark.fast
@pytest.mark.parametrize("place", [(0, 0), (0, 0, 0, 0), "abc", (np.inf, 0, 0), (np.nan, 0, 0)])
def test_places_that_are_none_are_told(place):
    corner = np.zeros(3)
    with pytest.raises(js.InputError, match=r"give each as three finite numbers \[x, y, z\] in m"):
        js.routes(an_empty_space(), place, corner)


def an_empty_space() -> js.FreeSpace:
    return js.FreeSpace(
        np.zeros((0, 4, 3)), np.zeros((0, 4)), np.zeros((0, 3, 3)), np.zeros((0, 3)),
        np.zeros((0, 0), bool), np.zeros(0, int), np.zeros((0, 3)), np.inf, 0.0,
    )  # fmt: skip
