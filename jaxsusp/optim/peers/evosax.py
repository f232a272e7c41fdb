"""Algorithms of evosax, inside our batched program.

Any of evosax's registry by its name there, with its default coefficients. evosax minimises over all
of R^D, and its default steps are meant for functions such as COCO's, on -5 … 5: every variable is
measured so that its range is that one. A candidate outside is repaired before it is evaluated, and
evosax is told the point that was evaluated. The initial population is uniform, as ours is;
algorithms that adapt a distribution begin it at the best member, those that adapt several at
the best few.
"""

# pyright: reportMissingImports=false
import functools
import inspect
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from evosax.algorithms import algorithms as registry
from evosax.algorithms.population_based.base import PopulationBasedAlgorithm
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.errors import InputError, require, require_known
from jaxsusp.optim.base import Best, NoInfo, Optimizer, best_of, better
from jaxsusp.problem.given import held
from jaxsusp.problem.problem import Problem

SIDE = 5.0
"""Variables are between -SIDE and SIDE."""

CROWDS = 3
"""Populations of the algorithms that have several; evosax leaves their number to its user."""


class EvosaxState(NamedTuple):
    """evosax's own state, and what we keep beside it."""

    theirs: Any
    fitness: Float[Array, "pop"]  # of the latest candidates
    best: Best


def names() -> list[str]:
    """The names of its registry."""
    return sorted(registry)


def describe(name: str) -> str:
    """What an algorithm is, in its own words."""
    return (inspect.getdoc(registry[name]) or name).splitlines()[0]


def make(name: str, **coefficients: float) -> Optimizer:
    """An algorithm of evosax.

    Args:
        name: in its registry, such as "CMA_ES".
        **coefficients: any numbers among the fields of the algorithm's `Params`.

    Returns:
        The optimiser named "evosax:" and that.

    Raises:
        InputError: a name that its registry has not.
    """
    require_known("algorithm of evosax", name, names())
    init, step = _functions(name)
    return Optimizer(
        f"evosax:{name}",
        Partial(init, coefficients),
        Partial(step, coefficients),
        origin=f"evosax {version('evosax')}",
    )


@functools.cache  # the same functions every time, so that a program is compiled once
def _functions(name: str):
    def init(coefficients, key, problem: Problem, population: int, iterations) -> EvosaxState:
        del iterations
        return _init(name, coefficients, key, problem, population)

    def step(coefficients, key, problem: Problem, state: EvosaxState):
        return _step(name, coefficients, key, problem, state)

    return init, step


def _init(name: str, coefficients, key, problem: Problem, population: int) -> EvosaxState:
    key_sample, key_theirs = jax.random.split(key)
    x = problem.sample(key_sample, population)
    fitness = problem.evaluate(x)
    algorithm, params = _made(name, population, problem.dim, coefficients)
    with _their_ways():
        if isinstance(algorithm, PopulationBasedAlgorithm):
            theirs = algorithm.init(key_theirs, _measured(problem, x), fitness, params)
        else:
            means = _measured(problem, x[jnp.argsort(fitness, stable=True)])
            many = getattr(algorithm, "num_populations", None)
            theirs = algorithm.init(key_theirs, means[0] if many is None else means[:many], params)
    return EvosaxState(jax.tree.map(_strong, theirs), fitness, best_of(x, fitness))


def _step(name: str, coefficients, key, problem: Problem, state: EvosaxState):
    key_ask, key_tell = jax.random.split(key)
    algorithm, params = _made(name, len(state.fitness), problem.dim, coefficients)
    with _their_ways():
        candidates, theirs = algorithm.ask(key_ask, state.theirs, params)
    x = problem.repair(_placed(problem, candidates))
    fitness = problem.evaluate(x)
    with _their_ways():
        theirs, _ = algorithm.tell(key_tell, _measured(problem, x), fitness, theirs, params)
    theirs = jax.tree.map(lambda new, old: _strong(new, old.dtype), theirs, state.theirs)
    return EvosaxState(theirs, fitness, better(best_of(x, fitness), state.best)), NoInfo()


def _made(name: str, population: int, dim: int, coefficients):
    """The algorithm and its coefficients, those that were given in place of the defaults."""
    algorithm, params = _instance(name, population, dim, str(jnp.zeros(()).dtype))
    for each in coefficients:
        require_known(f"coefficient of evosax:{name}", each, params.__dataclass_fields__)
    return algorithm, params.replace(**coefficients)


@functools.lru_cache(maxsize=64)  # evosax compiles for every instance of an algorithm anew
def _instance(name: str, population: int, dim: int, dtype: str):
    """An instance and its default coefficients, in the precision of the calling program.

    It is made in a thread of its own, where no program is being traced: all of its arrays are
    plain numbers that any program may use.
    """
    with ThreadPoolExecutor(1) as aside:
        return aside.submit(_build, name, population, dim, dtype == "float64").result()


def _build(name: str, population: int, dim: int, double: bool):
    made, options = registry[name], {}
    asked = inspect.signature(made).parameters
    if "sampling_fn" in asked:  # random search is told where
        options["sampling_fn"] = functools.partial(_uniform, dim)
    if "num_populations" in asked:
        options["num_populations"], rest = CROWDS, population % CROWDS
        remedy = f"give a multiple of {CROWDS}, its populations"
        require(rest == 0, f"population of evosax:{name} = {population}: {remedy}")
        population //= CROWDS
    with jax.enable_x64(double), _their_ways():
        try:
            algorithm = made(population, solution=jnp.zeros(dim), **options)
        except AssertionError as error:  # what it asks of a population
            raise InputError(f"population of evosax:{name} = {population}: {error}") from None
        return algorithm, algorithm.default_params


def _uniform(dim: int, key) -> Array:
    return jax.random.uniform(key, (dim,), minval=-SIDE, maxval=SIDE)


def _measured(problem: Problem, x: Float[Array, "pop dim"]) -> Float[Array, "pop dim"]:
    """Points of the problem, every variable from -SIDE to SIDE."""
    return SIDE * (2 * (x - problem.low) / (problem.high - problem.low) - 1)


def _placed(problem: Problem, measured: Array) -> Float[Array, "pop dim"]:
    """Points of the problem from measured ones."""
    share = (measured.astype(held(problem.lower.dtype)) / SIDE + 1) / 2
    return problem.low + share * (problem.high - problem.low)


def _strong(leaf: Any, dtype: Any = None) -> Array:
    """An array whose type is its own, the same before and after an iteration."""
    leaf = jnp.asarray(leaf)
    if jnp.issubdtype(leaf.dtype, jax.dtypes.prng_key):
        return leaf
    return jax.lax.convert_element_type(leaf, dtype or leaf.dtype)


@contextmanager
def _their_ways() -> Iterator[None]:
    """What evosax counts on: JAX's usual promotion. What it is warned of is for its authors."""
    with (
        jax.numpy_dtype_promotion("standard"),
        jax.numpy_rank_promotion("allow"),
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("ignore", "Explicitly requested dtype", UserWarning)
        warnings.filterwarnings("ignore", category=DeprecationWarning)
        yield
