"""Searches on the host: side by side, with the numbering and counting of all others."""

# ruff: noqa: NPY002  the generator that all share is what some of them are about

import dataclasses

import jax
import numpy as np
import pytest
from jax.tree_util import Partial
from walking import SIZES, Walk, paraboloid, shared, walk

import jaxsusp as js
from jaxsusp.optim.base import HostOptimizer, require_compiled
from jaxsusp.optim.batch import evaluator, run_batch, time_iteration
from jaxsusp.optim.host import Aside, seed_of
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.problem.problem import stack_problems

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def problem():
    return js.Problem(paraboloid, np.full(3, -2.0), np.array([2.0, 2.0, 0.5]))


def test_a_search_on_the_host_is_minimised_like_any_other(problem):
    found = js.minimize(problem, walk(), runs=3, seed=4, **SIZES)
    assert found.x.shape == (3, 3)
    assert found.history.shape == (3, 12)
    assert found.evaluations == 9 + 12 * 6
    assert (np.diff(found.history, axis=1) <= 0).all()
    np.testing.assert_array_equal(found.history[:, -1], found.fitness)
    np.testing.assert_allclose([paraboloid(x) for x in found.x], found.fitness)
    assert (found.x <= problem.upper).all()
    assert found.fitness.max() < 0.6
    assert len(np.unique(found.fitness)) == 3, "runs must be independent"


@pytest.mark.parametrize("optimizer", [walk(), shared()], ids=["its own", "shared"])
def test_a_run_depends_on_seed_name_and_index_alone(problem, optimizer):
    few, many = (js.minimize(problem, optimizer, runs=n, seed=4, **SIZES) for n in (2, 5))
    np.testing.assert_array_equal(few.history, many.history[:2])
    np.testing.assert_array_equal(few.x, many.x[:2])
    stacked = stack_problems([problem])
    alone = run_batch(stacked, optimizer, 4, [3], **SIZES)
    np.testing.assert_array_equal(alone.x[0], many.x[3:4])
    other = js.minimize(problem, optimizer, runs=2, seed=5, **SIZES)
    assert not np.array_equal(few.x, other.x)
    renamed = dataclasses.replace(optimizer, name="other")
    assert not np.array_equal(few.x, js.minimize(problem, renamed, runs=2, seed=4, **SIZES).x)


def test_what_everybody_draws_from_is_left_as_it_was(problem):
    state = np.random.get_state()
    np.random.seed(1)
    expected = np.random.random(2)
    np.random.seed(1)
    drawn = [np.random.random()]
    js.minimize(problem, shared(), runs=2, **SIZES)
    drawn.append(np.random.random())
    np.random.set_state(state)
    np.testing.assert_array_equal(drawn, expected)


def test_a_search_that_is_interrupted_gives_the_generator_back():
    class Fails:
        def ask(self):
            np.random.random()
            raise KeyboardInterrupt

    before = np.random.get_state()[1].copy()
    search = Aside(3, Fails)
    with pytest.raises(KeyboardInterrupt):
        search.ask()
    np.testing.assert_array_equal(np.random.get_state()[1], before)


def test_scenarios_are_evaluated_each_by_its_own_fitness(problem):
    """Stacked, and on any number of devices: what is found is what is found alone."""
    moved = js.Problem(paraboloid, np.full(3, -1.0), np.full(3, 1.0))
    both = run_batch(stack_problems([problem, moved]), walk(), 0, range(2), **SIZES)
    assert both.x.shape == (2, 2, 3)
    for i, each in enumerate((problem, moved)):
        alone = run_batch(stack_problems([each]), walk(), 0, range(2), **SIZES)
        np.testing.assert_array_equal(both.x[i], alone.x[0])


@pytest.mark.parametrize("count", [1, 3, 4])
def test_any_number_of_candidates_is_shared_among_the_devices(problem, count):
    assert len(jax.devices()) == 2
    x = np.random.default_rng(0).uniform(-3, 3, (1, count, 3))
    points, fitness = evaluator(stack_problems([problem]))(x)
    np.testing.assert_array_equal(points[0], np.clip(x[0], problem.lower, problem.upper))
    np.testing.assert_allclose(fitness[0], [paraboloid(each) for each in points[0]])


def test_float32_searches_are_told_what_was_evaluated():
    problem = js.Problem(paraboloid, np.full(3, -2, np.float32), np.full(3, 2, np.float32))
    found = js.minimize(problem, walk(), runs=2, **SIZES)
    assert found.x.dtype == found.fitness.dtype == found.history.dtype == np.float32


def test_what_is_not_finite_never_becomes_a_best():
    def holes(x):
        return jax.numpy.where(x[0] < 1, jax.numpy.nan, paraboloid(x))

    bounds = np.full(3, -2.0), np.full(3, 2.0)
    found = js.minimize(js.Problem(holes, *bounds), walk(), runs=4, **SIZES)
    assert np.isfinite(found.fitness).all()
    assert (found.x[:, 0] >= 1).all()
    nowhere = js.Problem(lambda x: jax.numpy.nan * x.sum(), *bounds)
    found = js.minimize(nowhere, walk(), runs=2, **SIZES)
    assert np.isposinf(found.fitness).all()
    assert (found.x >= -2).all()


def test_a_search_that_asks_for_other_numbers_is_refused(problem):
    class Grows(Walk):
        def ask(self):
            self.population += 1
            return super().ask()

    with pytest.raises(js.InputError, match=r"grows: asks for .* equally many in every turn but"):
        js.minimize(problem, HostOptimizer("grows", Partial(Grows, 0.5)), runs=1, **SIZES)


def test_evaluations_are_counted_by_what_is_asked_for(problem):
    assert count_evaluations(walk(), problem, 30) == (33, 30)


def test_its_pace_is_measured(problem):
    assert time_iteration(stack_problems([problem]), walk(), 0, range(2), 4, 6) > 0


def test_seeds_are_numbers_that_any_generator_takes():
    seeds = [seed_of(0, "walk", run) for run in range(50)]
    assert len({*seeds}) == 50
    assert all(0 <= seed < 2**31 for seed in seeds)


def test_where_runs_are_compiled_whole_it_is_refused():
    with pytest.raises(js.InputError, match='"walk" is advanced on the host'):
        require_compiled(walk())
    require_compiled(js.pso())
