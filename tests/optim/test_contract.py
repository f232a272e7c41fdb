"""What every optimiser owes: one table of algorithms times one table of problems."""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.tree_util import Partial

import jaxsusp as js
from jaxsusp.optim.algorithms.routed import CROWD, ISLANDS
from jaxsusp.optim.base import Best, Optimizer, best_of, better
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.optim.registry import algorithm, algorithms
from jaxsusp.problem.problem import stack_problems

PER_STEP = {"pso": 1, "ga": 1, "dbo": 1, "sdbo": 2, "dbo-task": 1, "sdbo-task": 2,
            "cmaes": 1, "jde": 1, "routed": 1}  # fmt: skip


@pytest.mark.fast
@pytest.mark.parametrize("name", [name for name in PER_STEP if "-" not in name])
def test_a_coefficient_that_there_is_not_is_told_with_those_there_are(name):
    with pytest.raises(js.InputError, match=f"coefficient of {name} = 'foo' is not known; choose"):
        getattr(js, name)(foo=3.0)


class RandomState(NamedTuple):
    best: Best


class RandomInfo(NamedTuple):
    improved: Any


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Landscape:
    """A paraboloid, whose faults are arguments: one compiled program serves all of them."""

    beyond: Any  # NaN where x[0] is more
    before: Any  # -inf where it is less

    def __call__(self, x):
        value = jnp.sum((x - 0.7) ** 2)
        beyond, before = (jnp.asarray(each, x.dtype) for each in (self.beyond, self.before))
        return jnp.where(x[0] > beyond, jnp.nan, jnp.where(x[0] < before, -jnp.inf, value))


sphere = Landscape(np.float64(np.inf), np.float64(-np.inf))
holes = Landscape(np.float64(1.0), np.float64(-1.5))
nowhere = Landscape(np.float64(-np.inf), np.float64(-np.inf))

SIZES = {"iterations": 60, "population": 20}
"""Of all searches that every algorithm makes; with three or four runs they share a program."""


def problem(function, dtype=np.float64, dim=4) -> js.Problem:
    return js.Problem(function, -2 * np.ones(dim, dtype), 2 * np.ones(dim, dtype))


def of(name: str) -> Optimizer:
    """An algorithm; one that is another with other coefficients shares its compiled program."""
    return replace(algorithm(name), name=name.removesuffix("-task"))


@pytest.mark.fast
def test_every_algorithm_is_known_everywhere_by_one_name():
    """A row here, a row in `optim.choices`, a public factory."""
    assert PER_STEP.keys() == js.ALGORITHMS.keys()
    for name in js.ALGORITHMS:
        assert algorithm(name).name == name
        assert hasattr(js, name.removesuffix("-task"))


@pytest.mark.parametrize("name", js.ALGORITHMS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_minimises_in_the_dtype_of_the_bounds(name, dtype):
    result = js.minimize(problem(sphere, dtype), of(name), runs=3, **SIZES)
    assert repr(result).startswith("<Result: 3 runs, ")
    assert repr(result).endswith(f" each; best fitness {result.fitness.min():.6g}>")
    assert result.x.shape == (3, 4)
    assert result.x.dtype == result.fitness.dtype == result.history.dtype == dtype
    assert result.history.shape == (3, 60)
    assert (np.diff(result.history, axis=1) <= 0).all()
    np.testing.assert_array_equal(result.history[:, -1], result.fitness)
    np.testing.assert_allclose([sphere(x) for x in result.x], result.fitness, rtol=1e-4, atol=1e-12)
    assert (np.abs(result.x) <= 2).all()
    assert result.fitness.max() < 0.3
    assert len(np.unique(result.fitness)) == 3, "runs must be independent"


@pytest.mark.parametrize("name", js.ALGORITHMS)
def test_what_is_not_finite_never_becomes_a_best(name):
    result = js.minimize(problem(holes), of(name), runs=4, **SIZES)
    assert np.isfinite(result.fitness).all()
    assert np.isfinite(result.x).all()
    assert ((result.x[:, 0] <= 1) & (result.x[:, 0] >= -1.5)).all()
    np.testing.assert_allclose([holes(x) for x in result.x], result.fitness)


@pytest.mark.parametrize("name", js.ALGORITHMS)
def test_nothing_but_nan_is_reported_as_infinite(name):
    result = js.minimize(problem(nowhere), of(name), runs=4, **SIZES)
    assert np.isposinf(result.fitness).all()
    assert np.isposinf(result.history).all()


@pytest.mark.parametrize("name", js.ALGORITHMS)
def test_evaluations_are_counted_by_what_the_program_does(name, problems):
    generic = count_evaluations(algorithm(name), problem(sphere), 30)
    first = {"sdbo": 60, "sdbo-task": 60, "routed": ISLANDS + CROWD}.get(name, 30)
    assert generic == (first, 30 * PER_STEP[name])
    suspended = count_evaluations(algorithm(name), problems[0], 30)
    stability_move = 1 if name.startswith("sdbo") else 0
    assert suspended == (first, 30 * (PER_STEP[name] + stability_move))


@pytest.mark.parametrize("name", js.ALGORITHMS)
def test_a_run_depends_on_seed_name_and_index_alone(name):
    """Bit-equal whatever the number of runs that share the program; the seed changes it."""
    few = js.minimize(problem(sphere), of(name), seed=5, runs=3, **SIZES)
    many = js.minimize(problem(sphere), of(name), seed=5, runs=7, **SIZES)
    np.testing.assert_array_equal(few.x, many.x[:3])
    np.testing.assert_array_equal(few.history, many.history[:3])
    other = js.minimize(problem(sphere), of(name), seed=6, runs=3, **SIZES)
    assert not np.array_equal(few.history, other.history)


def test_chunks_do_not_change_a_run():
    """The driver advances in parts for the progress bar; the parts leave no trace."""
    from jaxsusp.optim import batch

    stacked = stack_problems([problem(sphere)])
    whole = run_batch(stacked, js.pso(), 0, range(3), **SIZES)
    told = []
    original = batch.CHUNKS
    try:
        batch.CHUNKS = 1
        single = run_batch(stacked, js.pso(), 0, range(3), **SIZES, report=told.append)
    finally:
        batch.CHUNKS = original
    assert told == [60]
    np.testing.assert_array_equal(whole.history, single.history)


def test_coefficients_are_arguments_not_constants():
    """Another coefficient, or another call of a factory, compiles nothing anew."""
    traced = []

    def counted(landscape, x):
        traced.append(None)
        return landscape(x)

    shared = problem(Partial(counted, sphere))
    js.minimize(shared, js.pso(), runs=3, **SIZES)
    after_first = len(traced)
    js.minimize(shared, js.pso(inertia_start=0.7), runs=3, **SIZES)
    js.minimize(shared, js.pso(), seed=3, runs=3, **SIZES)
    compiled_again = len(traced) - after_first
    evaluations_counted = 2 * 2  # counting the evaluations looks at the structure, not at fitness
    assert compiled_again <= evaluations_counted
    assert after_first > 0


def test_a_users_optimizer_is_one_pair_of_functions():
    """Random search, as a newcomer would write it."""

    def init(key, problem, population, iterations):
        x = problem.sample(key, population)
        return RandomState(best_of(x, problem.evaluate(x)))

    def step(key, problem, state):
        x = problem.sample(key, 10)
        challenger = best_of(x, problem.evaluate(x))
        improved = (challenger.fitness < state.best.fitness).astype(x.dtype)
        return RandomState(better(challenger, state.best)), RandomInfo(improved)

    def plain(x):
        return jnp.sum((x - 0.7) ** 2)

    random_search = Optimizer("random", init, step)
    result = js.minimize(problem(plain), random_search, runs=2, iterations=200, population=10)
    assert result.evaluations == 10 + 200 * 10
    assert result.fitness.max() < 1
    falls = (np.diff(result.history, axis=1) < 0).sum(axis=1)
    improved = (200 * result.info.improved).round()  # the first iteration is no difference
    assert ((improved == falls) | (improved == falls + 1)).all()


@pytest.mark.fast
def test_bad_choices_have_clear_messages():
    with pytest.raises(js.InputError, match=r"'sdob' is not known; did you mean \"sdbo\""):
        algorithm("sdob")
    with pytest.raises(js.InputError, match="'pso' is repeated"):
        algorithms(["pso", "ga", js.pso()])
    with pytest.raises(js.InputError, match="none given"):
        algorithms([])
    with pytest.raises(js.InputError, match="frame = 'moon'"):
        js.dbo(frame="moon")
    with pytest.raises(js.InputError, match="population of dung beetles = 3"):
        js.minimize(problem(sphere), "dbo", population=3)
    for name in ("runs", "iterations", "population"):
        with pytest.raises(js.InputError, match=f"{name} = 0"):
            js.minimize(problem(sphere), "pso", **{name: 0})
    with pytest.raises(js.InputError, match="lower < upper"):
        js.Problem(sphere, np.zeros(3), np.array([1.0, 0.0, 1.0]))
    with pytest.raises(js.InputError, match="one length"):
        js.Problem(sphere, np.zeros(3), np.ones(4))
    with pytest.raises(js.InputError, match="finite"):
        js.Problem(sphere, np.zeros(2), np.array([1.0, np.inf]))


@pytest.mark.fast
def test_gradients_and_vmap_go_through_a_problem():
    shared = problem(sphere)
    x = jnp.full(4, 0.2)
    np.testing.assert_allclose(jax.grad(shared.fitness)(x), 2 * (x - 0.7))
    with pytest.raises(AttributeError, match="from_scenario"):
        shared.terms(x)
