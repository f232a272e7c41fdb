"""Fitness terms against closed forms, finite differences and figures of straight lines."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from padded import problem_of, terms

import jaxsusp as js
from jaxsusp.problem import fitness
from jaxsusp.problem.suspension import Suspension
from jaxsusp.vec3 import Vec3

trajectory = jax.jit(fitness.trajectory, static_argnums=2)
curvature = jax.jit(fitness.curvature)
gradient = jax.jit(jax.grad(Suspension.__call__, argnums=1))

# Waypoints evenly on the start-goal line: (length, cable, tension rate) of odd and even scenarios,
# and the collisions of each scenario.
STRAIGHT = {0: (4.472, 27.449, 7.153), 1: (6.000, 26.544, 15.483)}
COLLISIONS = (43, 31, 60, 49, 71, 56)


def straight(scenario: js.Scenario, waypoints: int = 5) -> np.ndarray:
    return np.linspace(scenario.task.start, scenario.task.goal, waypoints + 2)[1:-1].ravel()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("i", range(6))
def test_straight_lines_give_the_known_figures(scenarios, problems, i, dtype):
    found = terms(problems[i], straight(scenarios[i]).astype(dtype))
    length, cable, rate = STRAIGHT[i % 2]
    assert found.total.dtype == dtype
    assert float(found.length) == pytest.approx(length, abs=5e-4)
    assert float(found.height) == pytest.approx(40.0, abs=1e-4)
    assert float(found.cable) == pytest.approx(cable, abs=5e-4)
    assert float(found.tension_rate) == pytest.approx(rate, abs=5e-4)
    assert float(found.curvature) == pytest.approx(0, abs=1e-9 if dtype == np.float64 else 1e-2)
    assert int(found.collisions) == COLLISIONS[i]
    assert int(found.violations) == 0
    assert float(found.penalty) == 1000 * COLLISIONS[i]


def test_total_is_the_weighted_sum(scenarios):
    weights = (2.0, 3.0, 0.5, 0.0, 4.0, 1.0)
    scenario = scenarios[0].model_copy(
        update={
            "fitness": scenarios[0].fitness.model_copy(update={"weights": weights, "kappa": 7.0})
        }
    )
    found = terms(problem_of(scenario), straight(scenario) + 0.1)
    parts = [found.length, found.height, found.cable, found.tension_rate, found.curvature]
    penalty = 7 * (int(found.collisions) + int(found.violations))
    assert float(found.penalty) == penalty
    expected = sum(w * float(f) for w, f in zip(weights, [*parts, penalty], strict=True))
    assert float(found.total) == pytest.approx(expected, rel=1e-12)


def test_batch_and_single_agree(problems):
    rng = np.random.default_rng(0)
    problem = problems[5]
    x = jnp.asarray(rng.uniform(problem.lower, problem.upper, (17, problem.dim)))
    single = np.stack([terms(problem, row).total for row in x])
    np.testing.assert_allclose(problem.evaluate(x), single, rtol=1e-12)
    mapped = jax.jit(jax.vmap(Suspension.__call__, in_axes=(None, 0)))
    np.testing.assert_allclose(mapped(problem.fitness, x), single, rtol=1e-12)


def test_gradient_matches_finite_differences(scenarios, problems):
    """Away from collisions the penalty is constant and the total differentiable."""
    rng = np.random.default_rng(1)
    checked = 0
    for scenario, problem in zip(scenarios[::5], problems[::5], strict=True):
        for _ in range(8):
            x = straight(scenario) + rng.normal(scale=0.3, size=problem.dim)
            h = 1e-6
            steps = h * np.eye(problem.dim)
            ahead, behind = (
                np.array([terms(problem, row).total for row in rows])
                for rows in (x + steps, x - steps)
            )
            if np.abs(ahead - behind).max() > 100:  # a count jumps: the total is not smooth here
                continue
            np.testing.assert_allclose(
                gradient(problem.fitness, x), (ahead - behind) / (2 * h), rtol=2e-5, atol=2e-5
            )
            checked += 1
    assert checked >= 10


def test_gradient_is_finite_where_the_load_rests(scenarios, problems):
    """All waypoints at the start: zero-length segments must not give NaN."""
    x = jnp.tile(jnp.asarray(scenarios[0].task.start), 5)
    assert np.isfinite(gradient(problems[0].fitness, x)).all()
    assert np.isfinite(terms(problems[0], x).total)


@given(
    radius=st.floats(0.1, 100),
    angle=st.floats(1e-3, 1.0),
    n=st.sampled_from([3, 4, 11, 60]),
    turn=st.floats(0, 6.3),
)
@settings(deadline=None, max_examples=50)
def test_curvature_of_a_circle(radius, angle, n, turn):
    """A polygon of chords c turns by θ per corner: Δχ / L = θ / (2 r sin(θ/2))."""
    t = turn + angle * np.arange(n)
    p = radius * np.stack([np.cos(t), np.sin(t), 0 * t])
    step = Vec3(*jnp.diff(jnp.asarray(p), axis=1))
    expected = angle / (2 * radius * np.sin(angle / 2))
    np.testing.assert_allclose(curvature(step), expected, rtol=1e-9)


def test_curvature_in_single_precision_on_a_smooth_path():
    """An arccos of the dot product is wrong by 0.3 in f5 here; this form is not."""
    t = np.linspace(0, 1, 40)
    path = np.stack([4 * t, 0.5 * t**2, 0.2 * t])
    exact = float(curvature(Vec3(*np.diff(path))).sum())
    single = float(curvature(Vec3(*jnp.diff(jnp.asarray(path, jnp.float32), axis=1))).sum())
    assert single == pytest.approx(exact, abs=5e-3)


@pytest.mark.fast
def test_reversal_turns_by_pi_and_a_halt_by_nothing():
    step = Vec3(*jnp.asarray([[1.0, -1.0, 0.0, 2.0], [0.0] * 4, [0.0] * 4]))
    np.testing.assert_allclose(curvature(step), [np.pi, 0, 0], atol=1e-12)


def test_tension_rate_by_the_definition(scenarios, problems):
    """f4 = Σ_k Σ_d |ΔT_k/dt · Δl_k/dt| with tensions and lengths found independently."""
    scenario, problem = scenarios[1], problems[1]
    x = straight(scenario) + np.random.default_rng(3).normal(scale=0.2, size=15)
    p = np.asarray(trajectory(problem.fitness.world, jnp.asarray(x), 40).to_array())
    ends = np.array([robot.end for robot in scenario.robots])
    cables = ends[None] - (p + np.array([0, 0, scenario.payload.height / 2]))[:, None]
    lengths = np.linalg.norm(cables, axis=-1)
    matrix = np.swapaxes(cables / lengths[..., None], 1, 2)
    tensions = np.linalg.solve(matrix, np.broadcast_to([0, 0, 98.1], (40, 3))[..., None])[..., 0]
    dt = 40 / 39
    expected = np.abs(np.diff(tensions, axis=0) / dt * np.diff(lengths, axis=0) / dt).sum()
    found = terms(problem, x)
    assert float(found.tension_rate) == pytest.approx(expected, rel=1e-10)
    assert float(found.cable) == pytest.approx(lengths.max(axis=0).sum(), rel=1e-12)
    assert float(found.height) == pytest.approx(np.abs(p[:, 2] - p[0, 2]).sum(), rel=1e-12)
    step = np.linalg.norm(np.diff(p, axis=0), axis=1)
    assert float(found.length) == pytest.approx(step.sum(), rel=1e-12)


def test_fitness_of_nan_is_never_finite(problems):
    x = np.full((17, 15), np.nan)  # as many as above, for the same program
    x[1] = 0.5
    value = np.asarray(problems[0].evaluate(jnp.asarray(x)))
    assert np.isfinite(value[1])
    assert np.isinf(np.delete(value, 1)).all()
