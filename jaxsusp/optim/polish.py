"""Local descent along the gradient of the fitness's smooth twin.

Population algorithms end near an optimum rather than at it. Every run goes on from its best point
with the twin of the fitness (`Problem.twin`), whose band about contacts and limits shrinks on the
way: L-BFGS gives one direction (Liu & Nocedal 1989), Adam another (Kingma & Ba 2015), for where the
first stalls; a few steps along both are tried at once, and the best is taken. In the end the true
fitness decides among all points on the way: nothing gets worse by it.
"""

import time
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax

from jaxsusp._types import Array, Float
from jaxsusp.optim.base import Best
from jaxsusp.optim.outcome import Outcome
from jaxsusp.problem.problem import Problem

STEPS = 60

NEWTON = (1.0, 0.3, 0.08, 0.02)
"""Steps that are tried along the direction of L-BFGS, in its own measure."""

ADAM = (3e-3, 6e-4, 1e-4, 1e-5)
"""Steps that are tried along the direction of Adam, in shares of the range of every variable."""

WIDE, NARROW = 0.03, 0.0003
"""Band of the twin at first and in the end, see `Problem.twin`."""

GRADIENT = 3
"""Evaluations that a gradient counts as."""

EVALUATIONS = STEPS * (GRADIENT + 1 + len(NEWTON) + len(ADAM) + 1) + 1
"""What a run costs: all points that are tried count, be it with the twin or the true fitness."""


def polish(problem: Problem, x: Float[np.ndarray, "runs dim"]) -> Float[np.ndarray, "runs dim"]:
    """Improve points of a problem, each on its own, in the dtype of the problem's bounds.

    Args:
        problem: what to minimise.
        x: points to begin from.

    Returns:
        Points of the same shape; none is worse than it was.
    """
    dtype = problem.lower.dtype
    with jax.enable_x64(dtype == np.float64):
        problem, x = jax.tree.map(jnp.asarray, (problem, np.asarray(x, dtype)))
        return np.asarray(_polish(problem, x).x)


def polish_batch(problems: Problem, outcome: Outcome) -> Outcome:
    """Polish the best of every run of a batch; the history stays that of the search.

    Args:
        problems: the stacked problems of the batch, which are taken in turn by one program.
        outcome: what their runs found.

    Returns:
        The outcome with what is better in place of what it held, and with the time it took.
    """
    better, seconds_compile, seconds_run = [], 0.0, 0.0
    with jax.enable_x64(problems.lower.dtype == np.float64):
        for i, x in enumerate(outcome.x):
            problem = jax.tree.map(lambda leaf, i=i: jnp.asarray(leaf[i]), problems)
            clock = time.perf_counter()
            program = _polish.lower(problem, jnp.asarray(x)).compile()  # JAX keeps it
            seconds_compile += time.perf_counter() - clock
            clock = time.perf_counter()
            better.append(jax.tree.map(np.asarray, program(problem, jnp.asarray(x))))
            seconds_run += time.perf_counter() - clock
    found = Best(*map(np.stack, zip(*better, strict=True)))
    wins = found.fitness < outcome.fitness
    return outcome._replace(
        x=np.where(wins[..., None], found.x, outcome.x),
        fitness=np.where(wins, found.fitness, outcome.fitness),
        seconds_compile=outcome.seconds_compile + seconds_compile,
        seconds_run=outcome.seconds_run + seconds_run,
    )


class _Walk(NamedTuple):
    """Where every run is."""

    unit: Float[Array, "runs dim"]  # in shares of the range
    memory: Any  # of L-BFGS and Adam


_METHODS = ((optax.scale_by_lbfgs(), NEWTON), (optax.scale_by_adam(), ADAM))


@jax.jit
def _polish(problem: Problem, x: Array) -> Best:
    runs, dim = x.shape
    low, span, dtype = problem.low, problem.high - problem.low, x.dtype

    def twin(unit: Array, band: Array) -> Array:
        value = problem.twin(low + span * unit.reshape(-1, dim), band)
        return jnp.where(jnp.isfinite(value), value, jnp.inf).reshape(unit.shape[:-1])

    def step(walk: _Walk, band: Array) -> tuple[_Walk, Array]:
        slopes = jax.grad(lambda unit: twin(unit, band).sum())(walk.unit)  # runs do not meet
        slopes = jnp.where(jnp.isfinite(slopes), slopes, 0)
        tried, memory = _tried(walk, slopes)
        best = jnp.argmin(twin(tried, band), axis=1)  # the first, where it is, if nothing is better
        unit = jnp.take_along_axis(tried, best[:, None, None], axis=1)[:, 0]
        return _Walk(unit, memory), unit

    unit = jnp.clip((x - low) / span, 0, 1)
    memory = tuple(jax.vmap(method.init)(unit) for method, _ in _METHODS)
    bands = jnp.geomspace(WIDE, NARROW, STEPS, dtype=dtype)
    way = jax.lax.scan(step, _Walk(unit, memory), bands)[1]
    found = problem.repair(low + span * way.reshape(-1, dim)).reshape(way.shape)
    seen = jnp.concatenate([x[None], found])
    fitness = problem.evaluate(seen.reshape(-1, dim)).reshape(-1, runs)
    best = jnp.argmin(fitness, axis=0)[None]  # the first, where it began, if nothing is better
    return Best(
        jnp.take_along_axis(seen, best[..., None], axis=0)[0],
        jnp.take_along_axis(fitness, best, axis=0)[0],
    )


def _tried(walk: _Walk, slopes: Array) -> tuple[Array, Any]:
    """Where a run is, and steps from there along the directions of both methods."""
    tried, memory = [walk.unit[:, None]], []
    for (method, steps), known in zip(_METHODS, walk.memory, strict=True):
        # Optax counts on JAX's usual promotion, which a program may have made strict.
        with jax.numpy_dtype_promotion("standard"), jax.numpy_rank_promotion("allow"):
            direction, known = jax.vmap(method.update)(slopes, known, walk.unit)
        steps = jnp.asarray(steps, walk.unit.dtype)[None, :, None]
        tried.append(walk.unit[:, None] - steps * jnp.asarray(direction)[:, None])
        memory.append(known)
    return jnp.clip(jnp.concatenate(tried, axis=1), 0, 1), tuple(memory)
