"""Cells of the workspace: what is called blocked is in contact, what is called free is not."""

import functools
from itertools import combinations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import anywhere, frame
from scipy import ndimage

import jaxsusp as js
from jaxsusp.freespace.cells.forbidden import Errand, forbidden_of
from jaxsusp.freespace.cells.removal import least_removal, smallest_opening
from jaxsusp.freespace.cells.subdivision import NAMED, Cells, subdivide
from jaxsusp.freespace.cells.ways import joined, shortest, widest
from jaxsusp.scenario.models import Box, Mesh
from jaxsusp.scenario.world import attachments_of, warning_shape
from jaxsusp.verify.bodies import Body, named_shapes
from jaxsusp.verify.scene import Scene


def measured(scenario: js.Scenario, points: np.ndarray) -> np.ndarray:
    """Room of load and cables in view of every obstacle by MuJoCo, (points, obstacles, 1 + K)."""
    shape, ends = warning_shape(scenario), [robot.end for robot in scenario.robots]
    lines = [Body("cable", radius=shape.cable_radius) for _ in ends]
    stones = [
        Body(name, obstacle=shape)
        for each in scenario.obstacles
        for name, shape in named_shapes(each, "stone")
    ]
    load = Body("load", radius=shape.radius, half_height=shape.half_height)
    scene, first = Scene([load, *lines, *stones]), 1 + len(ends)
    found = np.empty((len(points), len(stones), first))
    for row, point in enumerate(points):
        scene.place(0, point, point)
        for k, (end, hung) in enumerate(zip(ends, attachments_of(scenario), strict=True)):
            scene.place(k + 1, point + hung, np.array(end))
        for stone in range(len(stones)):
            found[row, stone] = [scene.distance(first + stone, i)[0] for i in range(first)]
    return found - scenario.limits.clearance


def some(cells: Cells, which: np.ndarray, random, count: int = 25) -> tuple[np.ndarray, np.ndarray]:
    """Cells on the border of those chosen, and a random point in each, some of them corners."""
    index = np.argwhere(which & ndimage.binary_dilation(~which))
    index = index[random.permutation(len(index))[:count]]
    inside = random.uniform(size=(len(index), 3))
    inside[::3] = inside[::3].round()
    return index, cells.lower + (index + inside) * cells.size


@settings(max_examples=12, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(1, 5), st.sampled_from([3, 4]), st.sampled_from([0, 5]))
def test_blocked_is_in_contact_and_free_is_clear(seed, count, robots, clearance_cm):
    random = np.random.default_rng(seed)
    scenario = anywhere(random, count, robots)
    limits = scenario.limits.model_copy(update={"clearance": clearance_cm / 100})
    scenario = scenario.model_copy(update={"limits": limits})
    errand = Errand.of(scenario, 2e-3)
    cells = subdivide(forbidden_of(scenario), errand, 32, all_obstacles=True)
    assert not (cells.free & ~cells.open).any()
    index, points = some(cells, ~cells.open, random)
    rooms = measured(scenario, points).min(axis=2)
    for place, room in zip(index, rooms, strict=True):
        held = int(cells.blocked[tuple(place)])
        assert all(room[i] < -1e-6 for i in range(count) if held >> i & 1)
    _, points = some(cells, cells.free, random)
    assert (measured(scenario, points) >= 0).all()


@settings(max_examples=15, deadline=None, derandomize=True)
@given(st.integers(0, 10**6))
def test_room_is_the_distance_that_a_certificate_measures(seed):
    random = np.random.default_rng(seed)
    scenario = anywhere(random, 3, 3)
    forbidden = forbidden_of(scenario)
    points = random.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (8, 3))
    exact = measured(scenario, points)
    for body, (stone, cable) in enumerate(zip(forbidden.owner, forbidden.cable, strict=True)):
        which, asked = exact[:, stone, cable + 1], np.full(len(points), body)
        apart = which > -scenario.limits.clearance  # MuJoCo tells depths as well
        lower = forbidden.room(points, asked)[apart]
        upper = forbidden.room(points, asked, inner=True)[apart]
        np.testing.assert_allclose(lower, which[apart], atol=5e-4)
        assert (lower <= which[apart] + 1e-6).all()
        assert (upper >= which[apart] + 1e-6).all()


@pytest.mark.parametrize("shape", ["box", "hull"])
def test_a_mesh_blocks_as_what_stands_for_it_in_a_certificate(tmp_path, shape):
    trimesh.creation.icosphere(radius=1.0).export(tmp_path / "ball.stl")
    ball = Mesh(center=(0.0, 0.0, 1.5), shape=shape, file=str(tmp_path / "ball.stl"), yaw_deg=30.0)
    scenario = frame().model_copy(update={"obstacles": (ball,)})
    cells = subdivide(forbidden_of(scenario), Errand.of(scenario), 64, all_obstacles=True)
    random = np.random.default_rng(0)
    assert measured(scenario, some(cells, ~cells.open, random)[1]).min(axis=(1, 2)).max() < -1e-6
    assert measured(scenario, some(cells, cells.free, random)[1]).min() >= 0


def walls(*boxes: tuple, **changes) -> js.Scenario:
    """Scenario 1 with other obstacles, (x, y, z) and size each, and the load alone to look at."""
    obstacles = tuple(Box(center=center, size=size) for center, size in boxes)
    return frame().model_copy(update={"obstacles": obstacles, "drive": "hybrid", **changes})


def decided(scenario: js.Scenario) -> Cells:
    return subdivide(forbidden_of(scenario), Errand.of(scenario, 2e-3))


def test_a_gap_that_is_too_small_is_proved_and_a_larger_one_is_not():
    """The load is 0.2 m wide and keeps 0.05 m on either side."""
    sides = {}
    for gap in (0.29, 0.31):
        x = 2 + gap / 2
        sides[gap] = decided(walls(((-x, 0, 4), (4, 0.2, 8)), ((x, 0, 4), (4, 0.2, 8))))
    assert sides[0.29].verdict == "blocked"
    assert sides[0.31].verdict == "undecided"
    assert not joined(sides[0.31].free, sides[0.31].start, sides[0.31].goal)
    x = 2 + 0.6 / 2
    assert decided(walls(((-x, 0, 4), (4, 0.2, 8)), ((x, 0, 4), (4, 0.2, 8)))).verdict == "open"


def test_what_has_more_room_than_a_diagonal_is_free():
    scenario = anywhere(np.random.default_rng(3), 4, 3)
    forbidden = forbidden_of(scenario)
    cells = subdivide(forbidden, Errand.of(scenario), 32, all_obstacles=True)
    corners = cells.centers + cells.size / 2
    roomy = forbidden.least(corners.reshape(-1, 3)).reshape(cells.free.shape) > cells.diagonal
    assert roomy.any()
    assert cells.free[roomy].all()


def brute_force(cells: Cells, obstacles: int) -> int | None:
    """Size of the smallest set of obstacles that opens a way."""
    for size in range(obstacles + 1):
        for gone in combinations(range(obstacles), size):
            mask = np.uint64(sum(1 << i for i in gone))
            if joined((cells.blocked & ~mask) == 0, cells.start, cells.goal):
                return size
    return None


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.integers(2, 5))
def test_the_fewest_obstacles_are_as_few_as_of_all_sets(seed, obstacles):
    random = np.random.default_rng(seed)
    shape = (5, 4, 3)
    held = random.random((*shape, obstacles)) < random.uniform(0.3, 0.7)
    blocked = (held * (1 << np.arange(obstacles))).sum(axis=-1).astype(np.uint64)
    cells = Cells(np.zeros(3), np.ones(3), blocked, blocked == 0, (0, 0, 0), (4, 3, 2))
    found = smallest_opening(cells)
    assert found is not None
    assert len(found) == brute_force(cells, obstacles)
    mask = np.uint64(sum(1 << i for i in found))
    assert joined((blocked & ~mask) == 0, cells.start, cells.goal)


def test_of_two_walls_with_a_crate_in_between_both_walls_must_go():
    wall = functools.partial(lambda y: ((0, y, 4), (8, 0.2, 8)))
    scenario = walls(wall(0.5), ((0, 0, 1), (0.5, 0.5, 0.5)), wall(-0.5))
    found = least_removal(forbidden_of(scenario), Errand.of(scenario), decided(scenario))
    assert found.obstacles == {0, 2}
    assert found.opens
    assert brute_force(found.cells, 3) == 2


def test_a_narrow_slit_that_coarse_cells_take_for_open_is_looked_at_again():
    """Cells that prove the wall do not see that the slit behind it is too narrow."""
    x = 2 + 0.29 / 2
    slit = ((-x, -1, 4), (4, 0.2, 8)), ((x, -1, 4), (4, 0.2, 8))
    scenario = walls(((0, 0.2, 4), (8, 0.2, 8)), *slit)
    first = decided(scenario)
    assert max(first.blocked.shape) < max(decided(walls(*slit)).blocked.shape)
    found = least_removal(forbidden_of(scenario), Errand.of(scenario), first)
    assert found.opens
    assert len(found.obstacles or ()) == 2
    assert 0 in (found.obstacles or ())


def test_obstacles_beyond_those_that_are_told_apart_are_not_named():
    crate = ((3, 3, 0.3), (0.1, 0.1, 0.1))
    scenario = walls(*[crate] * NAMED, ((0, 0, 4), (8, 0.2, 8)))
    cells = decided(scenario)
    assert cells.verdict == "blocked"
    assert least_removal(forbidden_of(scenario), Errand.of(scenario), cells).obstacles is None


@pytest.mark.fast
def test_the_widest_way_goes_round():
    values = np.zeros((5, 5, 1))
    values[:, 2] = [[3], [1], [-1], [-2], [2]]
    values[0, 1:4] = 2.5
    values[:, 0] = values[:, 4] = 4
    assert widest(values, (2, 0, 0), (2, 4, 0)) == 2.5
    way = shortest(values >= 2.5, np.ones(3), (2, 0, 0), (2, 4, 0))
    assert way[0].tolist() == [2, 0, 0]
    assert way[-1].tolist() == [2, 4, 0]
    assert (np.abs(np.diff(way, axis=0)).max(axis=1) == 1).all()
    assert values[tuple(way.T)].min() == 2.5
