"""The one driver of all optimisers: it owns the loop, the keys, the history and the counting.

Everything here is for a single run; `optim.batch` maps it over runs and scenarios. A trip of the
loop is given by two numbers that are arguments of the compiled program, so a run may be advanced
in chunks of any size, for a progress bar, without a second compilation and with the same result.
"""

import zlib
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float, Int, Key
from jaxsusp.optim.base import AnyOptimizer, HostOptimizer, HostSearch, Optimizer
from jaxsusp.problem.problem import Problem


class Progress(NamedTuple):
    """A run on its way: optimiser state, best fitness per iteration, and sums of the info."""

    state: Any
    history: Float[jax.Array, "iterations"]
    info: Any


class Evaluations(NamedTuple):
    """Fitness evaluations of the initial population and of every step."""

    initial: int
    per_step: int

    def total(self, iterations: int) -> int:
        """Evaluations of all iterations of a run, and before."""
        return self.initial + iterations * self.per_step

    def affordable(self, budget: int) -> int:
        """The most iterations that stay within a budget of evaluations, at least one."""
        return max(1, (budget - self.initial) // max(1, self.per_step))


class Portions(NamedTuple):
    """Sizes of the populations that are evaluated one after the other."""

    initial: tuple[int, ...]
    step: tuple[int, ...]


def run_key(seed: int, name: str, run: int | Int[Array, ""]) -> Key[Array, ""]:
    """Key of one run: it depends on seed, algorithm name and run index, and on nothing else."""
    return jax.random.fold_in(
        jax.random.fold_in(jax.random.key(seed), zlib.crc32(name.encode())), run
    )


def begin(
    optimizer: Optimizer,
    problem: Problem,
    key: Key[Array, ""],
    population: int,
    iterations: int,
    room: int = 0,
) -> Progress:
    """Evaluate the initial population of one run; its history has room for no less iterations."""
    state = optimizer.init(jax.random.fold_in(key, 0), problem, population, iterations)
    info = jax.eval_shape(optimizer.step, key, problem, state)[1]
    return Progress(
        state,
        jnp.full((max(iterations, room),), jnp.inf, state.best.fitness.dtype),
        jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), info),
    )


def advance(
    optimizer: Optimizer, problem: Problem, key: Key[Array, ""], progress: Progress, first, stop
) -> Progress:
    """Iterations first … stop-1 (counted from 1) of one run."""

    def iterate(t, progress: Progress) -> Progress:
        state, info = optimizer.step(jax.random.fold_in(key, t), problem, progress.state)
        return Progress(
            state,
            progress.history.at[t - 1].set(state.best.fitness),
            jax.tree.map(jnp.add, progress.info, info),
        )

    return jax.lax.fori_loop(first, stop, iterate, progress)


def count_evaluations(optimizer: AnyOptimizer, problem: Problem, population: int) -> Evaluations:
    """Count what a program evaluates by tracing it, so that no algorithm reports its own cost."""
    portions = evaluation_sizes(optimizer, problem, population)
    return Evaluations(sum(portions.initial), sum(portions.step))


def evaluation_sizes(optimizer: AnyOptimizer, problem: Problem, population: int) -> Portions:
    """The portions in which an optimiser evaluates, found by tracing it with another fitness."""
    if isinstance(optimizer, HostOptimizer):
        return _asked_sizes(optimizer, problem, population)
    recorder = _Recorder(problem)
    key = jax.eval_shape(lambda: jax.random.key(0))
    state = jax.eval_shape(
        lambda key: optimizer.init(key, recorder.problem, population, _LONG), key
    )
    initial, recorder.sizes = tuple(recorder.sizes), []
    jax.eval_shape(lambda key, state: optimizer.step(key, recorder.problem, state), key, state)
    return Portions(initial, tuple(recorder.sizes))


def _asked_sizes(optimizer: HostOptimizer, problem: Problem, population: int) -> Portions:
    """The portions that a search on the host asks for, found by playing two turns of it."""
    search = begin_on_host(optimizer, problem, 0, population, _LONG)
    sizes = []
    for _ in range(2):
        x = np.clip(search.ask(), problem.lower, problem.upper)
        search.tell(x, x.sum(axis=1))
        sizes.append(len(x))
    return Portions((sizes[0],), (sizes[1],))


def begin_on_host(
    optimizer: HostOptimizer, problem: Problem, seed: int, population: int, iterations: int
) -> HostSearch:
    """Begin one run of a search on the host, on one problem."""
    bounds = (np.asarray(each, np.float64) for each in (problem.lower, problem.upper))
    return optimizer.begin(seed, *bounds, population, iterations)


def require_begun(
    optimizer: AnyOptimizer, problem: Problem, population: int, iterations: int
) -> None:
    """Let an optimiser refuse what is too little for it, by tracing it: nothing is computed."""
    if isinstance(optimizer, HostOptimizer):
        begin_on_host(optimizer, problem, 0, population, iterations)
        return
    recorder, key = _Recorder(problem), jax.eval_shape(lambda: jax.random.key(0))
    jax.eval_shape(lambda key: optimizer.init(key, recorder.problem, population, iterations), key)


_LONG = 1_000_000
"""Iterations, of which the portions do not depend, but more than any optimiser asks for."""


class _Recorder:
    """A problem of the same shape whose fitness records how many candidates it is asked for."""

    def __init__(self, problem: Problem):
        self.sizes: list[int] = []
        self.problem = problem.with_fitness(self)
        self.problem.regions = None  # a search rule evaluates nothing
        self.stability = getattr(problem.fitness, "stability", None)

    def __call__(self, x: Array) -> Array:
        self.sizes.append(1)
        return x.sum()

    def population(self, x: Array) -> Array:
        self.sizes.append(len(x))
        return x.sum(axis=1)
