"""Local refinement of what a population search found: a (1, λ) step with elitism per run.

Population algorithms end near an optimum rather than at it, and the last corners of a path cost
acceleration. Every run draws λ normal steps about its best point, half of them in a few variables
only, and keeps the best if it is better; the step grows with success and shrinks without
(Rechenberg's rule). Nothing gets worse by it.
"""

import functools

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.problem.problem import Problem

FIRST_STEP = 0.02  # of the range of every variable
GROW, SHRINK = 1.3, 0.8
FEW = 3
"""Variables that a sparse step moves on average: one waypoint's worth."""


def refine(
    problem: Problem,
    x: Float[np.ndarray, "runs dim"],
    seed: int = 0,
    iterations: int = 200,
    candidates: int = 48,
) -> tuple[Float[np.ndarray, "runs dim"], Float[np.ndarray, "runs"]]:
    """Improve points of a problem, each on its own, in the dtype of the problem's bounds.

    Args:
        problem: what to minimise.
        x: points to begin from.
        seed: of the random steps.
        iterations: number of steps.
        candidates: λ, points tried per step and run.

    Returns:
        Points of the same shape, none worse than it was, and their fitness.
    """
    dtype = problem.lower.dtype
    with jax.enable_x64(dtype == np.float64):
        problem = jax.tree.map(jnp.asarray, problem)
        keys = jax.random.split(jax.random.key(seed), iterations)
        found, fitness = _refine(problem, jnp.asarray(x, dtype), keys, candidates)
        return np.asarray(found), np.asarray(fitness)


@functools.partial(jax.jit, static_argnums=3)
def _refine(problem: Problem, x, keys, candidates: int):
    runs, dim = x.shape
    dtype, sparse = x.dtype, candidates // 2
    span = (problem.high - problem.low)[None]
    chosen = min(1.0, FEW / dim)

    def step(carry, key):
        x, fitness, size = carry
        key_step, key_mask = jax.random.split(key)
        move = jax.random.normal(key_step, (runs, candidates, dim), dtype)
        some = jax.random.bernoulli(key_mask, chosen, (runs, sparse, dim)).astype(dtype)
        move = move.at[:, :sparse].multiply(some / chosen**0.5)
        tried = x[:, None] + size[:, None, None] * span * move
        tried = problem.repair(tried.reshape(-1, dim))
        value = problem.evaluate(tried).reshape(runs, candidates)
        best = value.argmin(axis=1)[:, None]
        value = jnp.take_along_axis(value, best, axis=1)[:, 0]
        tried = tried.reshape(runs, candidates, dim)
        tried = jnp.take_along_axis(tried, best[..., None], axis=1)[:, 0]
        better = value < fitness
        x = jnp.where(better[:, None], tried, x)
        size = jnp.clip(jnp.where(better, GROW * size, SHRINK * size), 1e-5, 0.1)
        return (x, jnp.where(better, value, fitness), size), None

    start = x, problem.evaluate(x), jnp.full(runs, FIRST_STEP, dtype)
    return jax.lax.scan(step, start, keys)[0][:2]
