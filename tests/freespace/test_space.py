"""The free space of a scenario as a whole: sound, connected, kept, and honest where it is not."""

import functools
from itertools import pairwise
from typing import NamedTuple

import cvxpy as cp
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from test_bodies import contacts, count

import jaxsusp as js
from jaxsusp.freespace import build
from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.iris import Bodies, proved_apart
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.polylines import length
from jaxsusp.scenario.models import Box
from jaxsusp.scenario.world import build_world, obstacle_counts
from jaxsusp.vec3 import Vec3


@pytest.fixture(scope="module")
def spaces(scenarios) -> list[js.FreeSpace]:
    return [js.free_space(scenario) for scenario in scenarios]


@jax.jit
def in_a_region(A: jax.Array, b: jax.Array, points: jax.Array) -> jax.Array:
    """Which points (3, n) lie in a polytope {A p <= b}: ten times as fast as in numpy."""

    def look(found, region):
        held = jnp.ones_like(found)
        for (x, y, z), offset in zip(*region, strict=True):
            held &= x * points[0] + y * points[1] + z * points[2] <= offset
        return found | held, None

    return jax.lax.scan(look, jnp.zeros(points.shape[1], bool), (A, b))[0]


def padded(space: js.FreeSpace, regions: int = 48, faces: int = 16) -> tuple[np.ndarray, ...]:
    """A and b with regions that hold nothing, so that one program serves all scenarios."""
    count, rows = space.b.shape
    A = np.pad(space.A, [(0, regions - count), (0, faces - rows), (0, 0)])
    b = np.pad(space.b, [(0, 0), (0, faces - rows)], constant_values=1.0)
    return A, np.pad(b, [(0, regions - count), (0, 0)], constant_values=-1.0)


def sampled(space: js.FreeSpace, count: int) -> np.ndarray:
    """Uniform samples of the union of the regions."""
    random, found = np.random.default_rng(0), []
    polytopes = padded(space)
    while sum(map(len, found)) < count:
        points = random.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (400_000, 3))
        inside = np.asarray(in_a_region(*polytopes, points.T))
        np.testing.assert_array_equal(inside[:5000], space.contains(points[:5000]))
        found.append(points[inside])
    return np.concatenate(found)[:count]


@pytest.mark.parametrize("number", range(6))
def test_of_a_million_points_none_collides(scenarios, spaces, number):
    assert contacts(scenarios[number], sampled(spaces[number], 1_000_000)).max() == 0


@pytest.mark.parametrize("number", range(6))
def test_start_and_goal_are_connected_and_enough_is_covered(scenarios, spaces, number):
    scenario, space = scenarios[number], spaces[number]
    assert space.connected
    assert space.coverage >= 0.95
    ends = np.array([scenario.task.start, scenario.task.goal])
    np.testing.assert_array_equal(space.polyline[[0, -1]], ends)
    for region, corners in zip(
        space.route, np.stack([space.polyline, np.roll(space.polyline, -1, 0)], 1), strict=False
    ):
        assert (space.A[region] @ corners.T <= space.b[region][:, None] + 1e-8).all()
    straight = np.linalg.norm(np.subtract(*ends))
    assert straight < space.bound <= space.length
    assert space.length == pytest.approx(space.bound, rel=1e-6)
    assert space.length <= length(space.centerline)


class Sweep(NamedTuple):
    """Distance of a triangle from an obstacle of one kind, in cvxpy, which compiles it once."""

    problem: cp.Problem
    triangle: cp.Parameter  # rows
    center: cp.Parameter
    turn: cp.Parameter
    half: cp.Parameter  # extents along the obstacle's axes


@functools.cache
def sweep(kind: str) -> Sweep:
    triangle, center = cp.Parameter((3, 3)), cp.Parameter(3)
    turn, half = cp.Parameter((3, 3)), cp.Parameter(3)
    weights, q = cp.Variable(3, nonneg=True), cp.Variable(3)
    match kind:
        case "box":
            inside = [cp.abs(q) <= half]
        case "cylinder":
            inside = [cp.norm(q[:2]) <= half[0], cp.abs(q[2]) <= half[2]]
        case "sphere":
            inside = [cp.norm(q) <= half[0]]
    gap = triangle.T @ weights - (turn @ q + center)
    problem = cp.Problem(cp.Minimize(cp.norm(gap)), [*inside, cp.sum(weights) == 1])
    return Sweep(problem, triangle, center, turn, half)


def swept_distance(scenario: js.Scenario, robot, obstacle, a: np.ndarray, b: np.ndarray) -> float:
    """Distance of an obstacle from all that a cable sweeps between two positions of the load.

    The triangle of the upper end and the hook's way, against the obstacle itself.
    """
    program = sweep(obstacle.kind)
    hook = np.array([0, 0, scenario.payload.height / 2])
    yaw = np.deg2rad(getattr(obstacle, "yaw_deg", 0.0))
    c, s = np.cos(yaw), np.sin(yaw)
    program.triangle.value = np.array([a + hook, b + hook, robot.end])
    program.center.value = np.array(obstacle.center)
    program.turn.value = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    match obstacle.kind:
        case "box":
            program.half.value = np.array(obstacle.size) / 2
        case "cylinder":
            radius = obstacle.radius
            program.half.value = np.array([radius, radius, obstacle.height / 2])
        case "sphere":
            program.half.value = np.full(3, obstacle.radius)
    return float(program.problem.solve("CLARABEL", warm_start=False))


@pytest.mark.parametrize("number", range(6))
def test_the_polyline_is_clear_at_every_instant(scenarios, spaces, number):
    """Cables by the distance of what they sweep; the load, without cables, by the exact test."""
    scenario, polyline = scenarios[number], spaces[number].polyline
    least = scenario.limits.cable_radius + scenario.limits.clearance
    for a, b in pairwise(polyline):
        for obstacle in scenario.obstacles:
            for robot in scenario.robots:
                assert swept_distance(scenario, robot, obstacle, a, b) >= least
        world = build_world(scenario, obstacle_counts(scenarios))
        load = world.bodies._replace(ends=world.bodies.ends.each(lambda c: c[:0]))
        assert int(count(Vec3(*jnp.asarray([a, b]).T), load, world.obstacles)) == 0


@pytest.mark.parametrize("number", range(6))
def test_no_region_meets_a_body(scenarios, spaces, number):
    """But for a thousandth of a millimetre, which is what proofs of almost touching need."""
    bodies = Bodies(bodies_of(scenarios[number]))
    for region in spaces[number].regions:
        polytope = HalfSpaces(region.polytope.A, region.polytope.b - 1e-6)
        beyond = [bodies.beyond(*face) for face in zip(*polytope, strict=True)]
        rest = np.flatnonzero(~np.any(beyond, axis=0))  # what no face keeps out alone
        assert all(proved_apart(polytope, bodies.bodies[i]) for i in rest)


def test_arrays_are_frozen_and_padding_is_no_face(spaces):
    space = spaces[0]
    with pytest.raises(ValueError, match="read-only"):
        space.A[0, 0, 0] = 1.0
    padding = np.abs(space.A).sum(axis=2) == 0
    assert (space.b[padding] == 1).all()
    np.testing.assert_allclose(space.C, space.C.transpose(0, 2, 1), atol=1e-12)
    assert (space.volumes[:, 1] <= space.volumes[:, 0]).all()
    assert space.contains(space.d).all()


def test_a_file_loads_back_exactly(spaces, tmp_path):
    spaces[2].save(tmp_path / "deep" / "space.nc")
    loaded = js.load_free_space(tmp_path / "deep" / "space.nc")
    for name in ("A", "b", "C", "d", "adjacency", "route", "polyline"):
        np.testing.assert_array_equal(getattr(loaded, name), getattr(spaces[2], name))
    assert (loaded.bound, loaded.coverage) == (spaces[2].bound, spaces[2].coverage)
    assert loaded.details == spaces[2].details


@pytest.mark.parametrize("content", [b"", b"not a free space", None])
def test_a_damaged_file_is_one_message(tmp_path, content, spaces):
    path = tmp_path / "space.nc"
    if content is None:
        spaces[0].save(path)
        content = path.read_bytes()[:3000]
    path.write_bytes(content)
    with pytest.raises(js.InputError, match=r"space\.nc: is not a saved free space"):
        js.load_free_space(path)
    with pytest.raises(js.InputError, match="no such file"):
        js.load_free_space(tmp_path / "other.nc")


def test_it_is_computed_once_by_content(scenarios, spaces, monkeypatch):
    def refuse(*_):
        raise AssertionError("computed again")

    kept = js.free_space(scenarios[2])
    monkeypatch.setattr(build, "_Builder", refuse)
    again = js.free_space(js.load_scenario("scenario-3"))
    np.testing.assert_array_equal(again.A, kept.A)
    moved = scenarios[2].model_copy(update={"name": "another"})
    for other in (lambda: js.free_space(moved), lambda: js.free_space(scenarios[2], seed=1)):
        with pytest.raises(AssertionError, match="computed again"):
            other()


@pytest.mark.fast
def test_a_damaged_cache_is_written_anew(monkeypatch, tmp_path):
    monkeypatch.setenv("JAXSUSP_CACHE", str(tmp_path))
    open_field = js.load_scenario("scenario-1").model_copy(update={"obstacles": ()})
    first = js.free_space(open_field)
    (file,) = tmp_path.rglob("*.nc")
    file.write_bytes(b"broken")
    np.testing.assert_array_equal(js.free_space(open_field).A, first.A)
    assert file.stat().st_size > 100
    assert len(first.d) == 1, "without obstacles one region is the whole domain"
    assert first.coverage == 1.0


def walled(scenario: js.Scenario, **wall) -> js.Scenario:
    return scenario.model_copy(update={"obstacles": (Box(**wall),)})


def test_a_wall_across_the_workspace_is_a_clear_no(scenarios):
    """Too high for the load under a low ceiling, and low enough for the cables at both ends."""
    wall = walled(scenarios[0], center=(0.0, 0.0, 1.3), size=(8.0, 0.2, 2.6))
    ceiling = wall.workspace.model_copy(update={"upper": (3.5, 3.5, 2.7)})
    task = wall.task.model_copy(update={"goal": (0.0, -2.5, 1.0)})
    wall = wall.model_copy(update={"workspace": ceiling, "task": task})
    space = js.free_space(wall, coverage=0.5, limit=12, cache=False)
    assert not space.connected
    assert space.reason.startswith("no collision-free route found: start and goal stay in separate")
    assert np.isinf(space.bound)
    assert len(space.polyline) == 0
    with pytest.raises(js.InputError, match=r'search = "free-space": no collision-free route'):
        js.Problem.from_scenario(wall, space=space)
    assert js.Problem.from_scenario(wall, search="box", space=space).regions is None


def test_a_blocked_start_is_named(scenarios):
    block = walled(scenarios[0], center=scenarios[0].task.start, size=(0.4, 0.4, 0.4))
    space = js.free_space(block, cache=False)
    assert not space.connected
    assert space.reason == (
        "task.start = [0.0, 2.0, 1.0] has no free space around it: it is in obstacles[0] (load), "
        "round obstacles taken up to 2 % larger"
    )


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"coverage": 1.0}, "coverage = 1.0: give a share between 0 and 1"),
        ({"coverage": float("nan")}, "coverage = nan"),
        ({"limit": 1}, "limit = 1: give a whole number of at least 2"),
        ({"seed": -1}, "seed = -1"),
        ({"solver": "MOSEKK"}, "solver = 'MOSEKK' is not known"),
        ({"solver": "HIGHS"}, "solver = 'HIGHS' is not known"),
    ],
)
def test_bad_settings_are_refused(scenarios, settings, message):
    with pytest.raises(js.InputError, match=message):
        js.free_space(scenarios[0], **settings)


def test_progress_tells_of_every_region(scenarios):
    told = []
    space = js.free_space(scenarios[0], coverage=0.3, cache=False, progress=told.append)
    assert [growth.regions for growth in told] == list(range(1, len(space.d) + 1))
    assert told[-1].connected


@pytest.mark.parametrize("far", [1e3, 1e5])
def test_a_site_far_from_the_origin_is_the_same_site(scenarios, far):
    """Site coordinates in a national grid, say."""
    near = scenarios[1]

    def shift(point):
        return (point[0] + far, point[1] + far, point[2])

    def shifted(part, *names):
        return part.model_copy(update={name: shift(getattr(part, name)) for name in names})

    moved = near.model_copy(
        update={
            "robots": tuple(shifted(robot, "base", "end") for robot in near.robots),
            "obstacles": tuple(shifted(obstacle, "center") for obstacle in near.obstacles),
            "task": shifted(near.task, "start", "goal"),
            "workspace": shifted(near.workspace, "lower", "upper"),
        }
    )
    here, there = (js.free_space(each, coverage=0.5, cache=False) for each in (near, moved))
    np.testing.assert_array_equal(here.adjacency, there.adjacency)
    assert there.length == pytest.approx(here.length, rel=0.02)  # samples are rounded otherwise


def test_it_is_the_same_whatever_was_computed_before(scenarios):
    first, _, again = (js.free_space(scenarios[i], coverage=0.5, cache=False) for i in (0, 3, 0))
    np.testing.assert_array_equal(first.A, again.A)
    np.testing.assert_array_equal(first.polyline, again.polyline)
