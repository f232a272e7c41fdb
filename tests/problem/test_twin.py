"""The twin against the fitness where nothing counts, and its gradient against differences."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from padded import problem_of

import jaxsusp as js
from jaxsusp.problem.hardturns import gently
from jaxsusp.problem.suspension import Suspension

QUICKLY = {"xla_backend_optimization_level": 0, "xla_llvm_disable_expensive_passes": True}
"""To compile what runs for milliseconds."""
TOLERANCE = {np.float64: 1e-12, np.float32: 3e-5}

quickly = functools.partial(jax.jit, compiler_options=QUICKLY)


@quickly
def both(problem: js.Problem, x: jax.Array):
    """The twin, and the terms of the fitness."""
    return problem.twin(x), problem.fitness.terms(x.T)


@quickly
def with_slopes(problem: js.Problem, x: jax.Array, band):
    """The twin with its gradients."""

    def total(x):
        values = problem.twin(x, band)
        return values.sum(), values

    (_, values), slopes = jax.value_and_grad(total, has_aux=True)(x)
    return values, slopes


def near_the_straight_line(problem: js.Problem, scale: float, count: int = 60) -> np.ndarray:
    rng = np.random.default_rng(2)
    return (problem.reference + rng.normal(scale=scale, size=(count, problem.dim))).astype(
        problem.lower.dtype
    )


def compare(problem: js.Problem, x: np.ndarray) -> tuple[int, int]:
    """Hold the twin against the fitness; how many are clear, and how many are not."""
    twin, terms = both(problem, x)
    total, dtype = np.asarray(terms.total), problem.lower.dtype.type
    clear = np.asarray((terms.collisions == 0) & (terms.violations == 0))
    assert twin.dtype == dtype
    np.testing.assert_allclose(np.asarray(twin)[clear], total[clear], rtol=TOLERANCE[dtype])
    smooth = total - np.asarray(terms.penalty)
    faulty = ~clear & np.isfinite(total)  # not everywhere is there a posture at all
    assert (np.asarray(twin)[faulty] > smooth[faulty]).all()
    return int(clear.sum()), int(faulty.sum())


def without_obstacles(name: str) -> js.Scenario:
    return js.load_scenario(name).model_copy(update={"obstacles": ()})


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_it_is_the_fitness_where_nothing_counts_and_more_elsewhere(scenarios, dtype):
    """On trajectories from the straight line, which collides, to above all obstacles."""
    counted = np.zeros(2, int)
    for i in (0, 4):
        problem = problem_of(scenarios[i], dtype=dtype)
        x = near_the_straight_line(problem, 0.3)
        x[:, 2::3] += np.linspace(0, 2.5, len(x), dtype=dtype)[:, None]
        counted += compare(problem, x)
    assert counted.min() > 10


def test_of_the_papers_check_as_well(scenarios):
    """Contacts at the samples alone: of the same trajectories no fewer are clear."""
    counted = np.zeros(2, int)
    for i in (0, 4):
        problem, sound = (problem_of(scenarios[i], contacts=each) for each in ("sampled", "swept"))
        x = near_the_straight_line(problem, 0.3)
        x[:, 2::3] += np.linspace(0, 2.5, len(x))[:, None]
        counted += compare(problem, x)
        at_samples, swept = (np.asarray(both(each, x)[1].collisions) for each in (problem, sound))
        assert ((at_samples == 0) | (swept > 0)).all()
    assert counted.min() > 10


@pytest.mark.fast
def test_another_check_than_the_two_is_refused(scenarios):
    with pytest.raises(js.InputError, match=r"contacts = 'sample' .* did you mean"):
        problem_of(scenarios[0], contacts="sample")


@pytest.mark.parametrize("name", ["rim", "end-driven", "base-driven", "hybrid"])
def test_of_every_drive_mode_as_well(name):
    """From near the straight line, in the empty room, to far from it, where limits are violated."""
    problem = js.Problem.from_scenario(without_obstacles(name), 3, 12, "box")
    x = near_the_straight_line(problem, 1.0)
    x = problem.reference + (x - problem.reference) * np.linspace(0.01, 3, len(x))[:, None] ** 2
    counted = compare(problem, x)
    assert min(counted) > 3


@pytest.fixture(scope="module")
def problem(problems) -> js.Problem:
    """The scenario with ten obstacles of all kinds."""
    return problems[4]


@pytest.mark.parametrize("band", [0.0, 0.03])
def test_gradient_matches_central_differences(problem, band):
    """Along random directions; few of the trajectories are at a kink."""
    x = near_the_straight_line(problem, 0.5)
    aside = np.random.default_rng(3).normal(size=x.shape)
    values, slopes = with_slopes(problem, x, band)
    ahead, behind = (with_slopes(problem, x + h * aside, band)[0] for h in (1e-6, -1e-6))
    found, expected = (ahead - behind) / 2e-6, (np.asarray(slopes) * aside).sum(axis=1)
    assert np.isclose(found, expected, rtol=1e-4, atol=1e-3).mean() > 0.9
    assert (np.asarray(values) > 1000).mean() > 0.5, "most have contacts"


def test_gradient_is_finite_where_the_load_rests(scenarios, problem):
    """All waypoints at the start, at the goal, on the line; and at an obstacle's centre."""
    task, obstacle = scenarios[4].task, scenarios[4].obstacles[0]
    places = np.array([task.start, task.goal, obstacle.center])
    x = np.resize(np.concatenate([np.tile(places, 5), problem.reference[None]]), (60, 15))
    values, slopes = with_slopes(problem, x, 0.03)
    assert np.isfinite(values).all()
    assert np.isfinite(slopes).all()


def test_a_band_costs_more_and_nothing_far_from_all_limits(problem):
    x = near_the_straight_line(problem, 0.5)
    bare, wide = (np.asarray(with_slopes(problem, x, band)[0]) for band in (0.0, 0.03))
    assert (wide >= bare - 1e-9).all()
    assert (wide > bare).any()


@pytest.mark.fast
def test_of_a_generic_problem_it_is_the_fitness_itself():
    generic = js.Problem(lambda x: ((x - 1) ** 2).sum(), np.zeros(2), np.full(2, 3.0))
    x = jnp.asarray([[1.0, 1.0], [2.0, 3.0]])
    np.testing.assert_array_equal(generic.twin(x, 0.1), [0, 5])


def test_a_price_on_hard_turns_is_on_the_twin_too(problem, monkeypatch):
    monkeypatch.setattr(Suspension, "twin", lambda _, x, band: x[:, 0] + band)
    monkeypatch.setattr(Suspension, "population", lambda _, x: 0 * x[:, 0])
    x = jnp.asarray(near_the_straight_line(problem, 0.5))
    price, twin = quickly(lambda p, x: (p.fitness.population(x), p.twin(x, 3.0)))(
        gently(problem), x
    )
    assert price.max() > 0
    np.testing.assert_allclose(twin, price + x[:, 0] + 3)
