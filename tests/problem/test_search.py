"""Search rules against the rule written out in numpy."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from drawn import SIZES, drawn

import jaxsusp as js
from jaxsusp.comparison.workunit import stack_scenarios
from jaxsusp.problem.search import pad_regions, regions_of
from jaxsusp.scenario.models import Box


@pytest.fixture(scope="module")
def space(scenarios) -> js.FreeSpace:
    return js.free_space(scenarios[4])


def gauges(space: js.FreeSpace, search: str, x: np.ndarray) -> np.ndarray:
    """Gauge of points (n, 3) in every region, (n, R); 1 on its boundary."""
    if search == "ellipsoid":
        away = x[:, None] - space.d
        return np.linalg.norm(np.einsum("rij,nrj->nri", np.linalg.inv(space.C), away), axis=2)
    found = []
    for region in space.regions:
        (A, b), d = region.polytope, region.ellipsoid.d
        found.append(((x - d) @ A.T / (b - A @ d)).max(axis=1))
    return np.stack(found, axis=1)


@pytest.mark.parametrize("search", ["free-space", "ellipsoid"])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_stray_waypoint_goes_to_the_border_of_the_nearest_region(scenarios, space, search, dtype):
    problem = js.Problem.from_scenario(scenarios[4], search=search, dtype=dtype, space=space)
    x = np.random.default_rng(0).uniform(problem.lower, problem.upper, (400, 15)).astype(dtype)
    repaired = np.asarray(jax.jit(problem.repair)(x))
    assert repaired.dtype == dtype
    before, after = (np.float64(each).reshape(-1, 3) for each in (x, repaired))
    gauge = gauges(space, search, before)
    least, nearest = gauge.min(axis=1), gauge.argmin(axis=1)
    free = least < 1 - 1e-4
    assert 0.2 < free.mean() < 0.8
    np.testing.assert_array_equal(after[free], before[free])
    d = space.d[nearest]
    expected = d + (before - d) / np.maximum(least, 1)[:, None]
    np.testing.assert_allclose(after, expected, atol=5e-4)
    assert gauges(space, search, after).min(axis=1).max() <= 1
    assert space.contains(after).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_what_was_repaired_stays(scenarios, space, dtype):
    problem = js.Problem.from_scenario(scenarios[4], dtype=dtype, space=space)
    x = np.random.default_rng(1).uniform(problem.lower, problem.upper, (600, 15)).astype(dtype)
    once = problem.repair(x)
    np.testing.assert_array_equal(problem.repair(once), once)


def test_runs_and_stacked_scenarios_see_the_same_rule(scenarios):
    """vmap over runs, and scenarios with different numbers of regions padded to the greatest."""
    problems = [js.Problem.from_scenario(scenarios[i], dtype=np.float32) for i in (0, 5)]
    assert problems[0].regions.table.shape != problems[1].regions.table.shape
    x = np.random.default_rng(2).uniform(-4, 6, (2, 3, 30, 15)).astype(np.float32)
    over_runs = jax.vmap(js.Problem.repair, in_axes=(None, 0))
    (group,) = stack_scenarios([scenarios[0], scenarios[5]], 5, 40, "free-space")
    stacked = jax.jit(jax.vmap(over_runs))(group.problems, x)
    for i, problem in enumerate(problems):
        for run in range(3):
            np.testing.assert_array_equal(stacked[i, run], problem.repair(x[i, run]))


@pytest.mark.fast
def test_padding_attracts_nothing(space):
    regions = regions_of(space, "free-space")
    count, rows, _ = regions.table.shape
    padded = pad_regions(regions, count + 5, rows + 3)
    point = jnp.zeros(3, jnp.float32)
    for at in range(count, count + 5):
        gauge = padded.gauge(padded.table[at].astype(np.float32), js.vec3.Vec3(*point))
        assert 1e14 < gauge < np.inf


def test_every_run_stays_in_the_free_space(scenarios, space):
    """Whatever the moves: waypoints of the best candidates are clear with all their cables."""
    centers = np.float32([obstacle.center for obstacle in scenarios[4].obstacles[:5]])
    assert not space.contains(np.float64(centers)).any()
    into_the_walls = drawn(scenarios[4], centers)
    for algorithm in ("pso", "ga", "sdbo-task"):
        found = js.minimize(into_the_walls, algorithm, **SIZES)
        assert space.contains(np.float64(found.x).reshape(-1, 3)).all()


@pytest.mark.fast
def test_box_is_the_workspace(scenarios):
    problem = js.Problem.from_scenario(scenarios[0], search="box")
    assert problem.regions is None
    x = np.random.default_rng(0).uniform(-9, 9, (50, 15))
    np.testing.assert_array_equal(problem.repair(x), np.clip(x, problem.lower, problem.upper))


def test_an_unknown_rule_is_refused(scenarios):
    with pytest.raises(js.InputError, match=r"search = 'elipsoid' .*did you mean \"ellipsoid\""):
        js.Problem.from_scenario(scenarios[0], search="elipsoid")


@pytest.mark.parametrize("height", [2.6, 1.5])
def test_the_whole_box_is_advised_only_where_nothing_is_proved(scenarios, height):
    """A wall up to the ceiling, and one that the load can be lifted over."""
    task = scenarios[0].task.model_copy(update={"goal": (0.0, -2.5, 1.0)})
    room = scenarios[0].workspace.model_copy(update={"upper": (3.5, 3.5, 2.7)})
    wall = Box(name="wall", center=(0.0, 0.0, height / 2), size=(8.0, 0.2, height))
    walled = scenarios[0].model_copy(
        update={"obstacles": (wall,), "task": task, "workspace": room, "name": "walled"}
    )
    space = js.free_space(walled, coverage=0.05, limit=2, routes=False)
    assert not space.connected
    with pytest.raises(js.InputError, match='walled: search = "free-space": no coll') as refused:
        js.Problem.from_scenario(walled, space=space)
    proved = "it is proved that there is none, see jaxsusp.why_not" in str(refused.value)
    assert proved == (height > 2)
    assert proved != ('search = "box"' in str(refused.value))
