"""Algorithms of other libraries by name, against their libraries driven by hand."""

from importlib import import_module

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.optim.base import HostOptimizer
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.host import seed_of
from jaxsusp.optim.loop import count_evaluations, run_key
from jaxsusp.optim.registry import algorithm, describe, peers
from jaxsusp.problem.problem import stack_problems

evosax = pytest.importorskip("evosax.algorithms")
pymoo = pytest.importorskip("pymoo.optimize")

SIZES = {"iterations": 15, "population": 18}
NAMES = peers()
COMPILED = [name for name in NAMES if name.startswith("evosax")]
SOME = [
    *("evosax:PSO", "evosax:CMA_ES", "evosax:DifferentialEvolution", "evosax:SV_Open_ES"),
    *(name for name in NAMES if name.startswith("pymoo")),
]


def valley(x):
    return ((x - 0.7) ** 2).sum() + 3 * (x[1:] * x[:-1]).sum() ** 2


def problem_of(dtype=np.float64) -> js.Problem:
    return js.Problem(valley, np.full(4, -2, dtype), np.array([2, 2, 2, 0.5], dtype))


@pytest.fixture(scope="module")
def problem() -> js.Problem:
    return problem_of()


def test_both_libraries_are_there_with_all_that_they_have():
    assert {name.removeprefix("evosax:") for name in COMPILED} == set(evosax.algorithms)
    assert {"pymoo:GA", "pymoo:PSO", "pymoo:DE", "pymoo:CMAES"} <= {*NAMES}
    assert all(0 < len(describe(name)) < 100 for name in NAMES)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("evosax:cma_es", 'did you mean "CMA_ES"'),
        ("pymoo:NSGA", "algorithm of pymoo = 'NSGA' is not known"),
    ],
)
def test_a_mistyped_algorithm_is_told(name, message):
    with pytest.raises(js.InputError, match=message):
        algorithm(name)


@pytest.mark.parametrize(
    ("name", "population", "message"),
    [
        ("evosax:Open_ES", 7, r"population of evosax:Open_ES = 7: .*even"),
        ("evosax:SV_CMA_ES", 7, "give a multiple of 3"),
        ("pymoo:DE", 3, "give a whole number of at least 4"),
    ],
)
def test_a_population_that_does_not_do_is_refused(problem, name, population, message):
    with pytest.raises(js.InputError, match=message):
        js.minimize(problem, name, runs=1, population=population)


def test_a_coefficient_that_there_is_not_is_told(problem):
    from jaxsusp.optim.peers.evosax import make

    with pytest.raises(js.InputError, match=r"evosax:PSO = 'foo' is not known; choose from cog"):
        js.minimize(problem, make("PSO", foo=1.0), runs=1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("name", COMPILED)
def test_every_algorithm_is_init_and_step_of_one_state(name, dtype):
    """Traced, not run: a step takes and gives the same types, and evaluates a population."""
    problem, optimizer = problem_of(dtype), algorithm(name)
    with jax.enable_x64(dtype == np.float64):
        assert count_evaluations(optimizer, problem, 12) == (12, 12)
        key = jax.eval_shape(lambda: jax.random.key(0))
        first = jax.eval_shape(lambda key: optimizer.init(key, problem, 12, 9), key)
        then, _ = jax.eval_shape(lambda key, state: optimizer.step(key, problem, state), key, first)
    assert jax.tree.structure(first) == jax.tree.structure(then)
    kinds = [[(x.shape, x.dtype, x.weak_type) for x in jax.tree.leaves(s)] for s in (first, then)]
    assert kinds[0] == kinds[1]
    assert first.best.x.dtype == dtype


@pytest.mark.parametrize("name", SOME)
def test_a_run_alone_is_the_same_run_in_a_batch(problem, name):
    many = js.minimize(problem, name, seed=3, runs=5, **SIZES)
    alone = run_batch(stack_problems([problem]), algorithm(name), 3, [3], **SIZES)
    np.testing.assert_allclose(alone.history[0, 0], many.history[3], rtol=1e-12)
    assert (many.x <= problem.upper).all()
    assert (many.x >= problem.lower).all()
    np.testing.assert_allclose([valley(x) for x in many.x], many.fitness)
    assert (np.diff(many.history, axis=1) <= 0).all()
    assert len(np.unique(many.fitness)) == 5


@pytest.mark.parametrize("name", ["PSO", "CMA_ES", "DifferentialEvolution"])
def test_evosax_by_hand_finds_the_same(problem, name):
    """Its own ask and tell in a plain loop, with the keys that a run of ours takes."""
    ours = js.minimize(problem, f"evosax:{name}", seed=1, runs=1, **SIZES)
    low, span = np.asarray(problem.lower), np.asarray(problem.upper) - np.asarray(problem.lower)
    key = run_key(1, f"evosax:{name}", 0)
    key_sample, key_theirs = jax.random.split(jax.random.fold_in(key, 0))
    x = low + span * np.asarray(jax.random.uniform(key_sample, (18, 4), np.float64))

    def evaluated(x):
        return np.array([valley(row) for row in x])

    with jax.numpy_dtype_promotion("standard"), jax.numpy_rank_promotion("allow"):
        theirs = evosax.algorithms[name](18, np.zeros(4))
        params, measured, fitness = theirs.default_params, 10 * (x - low) / span - 5, evaluated(x)
        best = [fitness.min()]
        if name == "CMA_ES":
            state = theirs.init(key_theirs, measured[fitness.argmin()], params)
        else:
            state = theirs.init(key_theirs, measured, fitness, params)
        for t in range(1, SIZES["iterations"] + 1):
            key_ask, key_tell = jax.random.split(jax.random.fold_in(key, t))
            asked, state = theirs.ask(key_ask, state, params)
            x = np.clip(low + span * (np.asarray(asked) + 5) / 10, problem.lower, problem.upper)
            fitness = evaluated(x)
            state, _ = theirs.tell(key_tell, 10 * (x - low) / span - 5, fitness, state, params)
            best.append(min(best[-1], fitness.min()))
    np.testing.assert_allclose(ours.history[0], best[1:], rtol=1e-6)
    assert best[-1] < best[0]


@pytest.mark.parametrize("name", [name for name in SOME if name.startswith("pymoo")])
def test_pymoo_by_hand_finds_the_same(problem, name):
    """Its own `minimize`, from the seed that a run of ours takes."""
    from pymoo.core.problem import Problem

    from jaxsusp.optim.peers.pymoo import ALGORITHMS

    class Stated(Problem):
        def __init__(self):
            super().__init__(n_var=4, n_obj=1, xl=problem.lower, xu=problem.upper)

        def _evaluate(self, x, out, *args, **kwargs):
            out["F"] = np.array([valley(row) for row in x])

    class_name = name.removeprefix("pymoo:")
    row, seed = ALGORITHMS[class_name], seed_of(2, name, 1)
    kind = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{row.module}"), class_name)
    generations = ("n_gen", SIZES["iterations"] + 1)
    state = np.random.get_state()  # noqa: NPY002  what its CMA-ES draws from
    theirs = pymoo.minimize(Stated(), kind(**row.options(18)), generations, seed=seed)
    np.random.set_state(state)  # noqa: NPY002
    ours = js.minimize(problem, name, seed=2, runs=2, **SIZES)
    np.testing.assert_allclose(ours.fitness[1], theirs.F[0], rtol=1e-9)
    np.testing.assert_allclose(ours.x[1], theirs.X, rtol=1e-6, atol=1e-9)


def test_through_compare_both_find_what_our_fitness_says_they_do(tmp_path):
    settings = {"iterations": 6, "population": 8, "search": "box", "output": tmp_path}
    names = ["pso", "evosax:PSO", "pymoo:GA"]
    one = js.compare("scenario-1", names, 1, **settings)
    two = js.compare("scenario-1", names, 2, **settings, resume=True)
    assert two["algorithm"].values.tolist() == names
    assert (two["evaluations"] == 8 * 7).all()
    np.testing.assert_array_equal(one["x"][:, :, 0], two["x"][:, :, 0])
    np.testing.assert_allclose(two["history"][..., -1], two["fitness"], rtol=1e-3)
    together = js.compare("scenario-1", names, 2, **{**settings, "output": None})
    np.testing.assert_array_equal(together["x"], two["x"])


def test_kinds_are_as_they_should_be():
    assert isinstance(algorithm("pymoo:GA"), HostOptimizer)
    assert isinstance(algorithm("evosax:PSO"), js.Optimizer)
    assert algorithm("evosax:PSO").origin.startswith("evosax 0.")
