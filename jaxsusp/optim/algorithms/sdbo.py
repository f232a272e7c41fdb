"""Stable dung beetle optimisation, the paper's algorithm (Eq. 13-19).

DBO with four additions: opposition-based initial population (Eq. 13), sine-cosine moves for the
last few thieves (Eq. 14-16), a pull of every beetle towards the best (Eq. 17), and a scaling of
waypoints by their stability factor S_c where it lies in [0.6, 0.9] (Eq. 18, 19). An iteration costs
about three evaluations per beetle where DBO costs one.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.stability import WINDOW
from jaxsusp.optim.algorithms.dbo import (
    DboCoefficients,
    DboState,
    forage,
    frame_coefficient,
    framed_name,
    origin_of,
    remember,
    roles,
    settle,
    start,
)
from jaxsusp.optim.base import NoInfo, Optimizer, chosen_of
from jaxsusp.problem.problem import Problem


class SdboCoefficients(NamedTuple):
    """Defaults: the paper's, but for Eq. 16: it runs negative as printed; here w falls linearly."""

    dbo: DboCoefficients = DboCoefficients()
    amplitude: float = 2.0  # c of Eq. 15
    inertia_start: float = 0.9  # w of Eq. 14
    inertia_end: float = 0.4
    branch: float = 0.5  # threshold of r4 in Eq. 14, as printed


class StabilityMove(NamedTuple):
    """How Eq. 19 fared in one iteration, as shares of the beetles."""

    acted: Float[Array, ""]  # had a waypoint with S_c in the window
    kept: Float[Array, ""]  # and became better by it


def sdbo(frame: str = "world", **coefficients: float) -> Optimizer:
    """Stable dung beetle optimisation.

    Args:
        frame: "world" (the paper) or "task", see `jaxsusp.dbo`; Eq. 19 scales about the
            same origin.
        **coefficients: any other field of `SdboCoefficients`.

    Returns:
        The optimiser named "sdbo" ("sdbo-task" in the task frame). Its info tells how often the
        stability move acted; on a generic problem, which has no S_c, the move is left out.
    """
    moves = DboCoefficients(task_frame=frame_coefficient(frame))
    chosen = chosen_of("sdbo", SdboCoefficients, {"dbo": moves, **coefficients})
    return Optimizer(framed_name("sdbo", frame), Partial(_init, chosen), Partial(_step, chosen))


def _init(coefficients, key, problem: Problem, population: int, iterations) -> DboState:
    """The best half of a random population and its opposites a + b - X (Eq. 13)."""
    del coefficients
    roles(population)
    x = problem.sample(key, population)
    x = jnp.concatenate([x, problem.repair(problem.low + problem.high - x)])
    fitness = problem.evaluate(x)
    fittest = jnp.argsort(fitness, stable=True)[:population]
    return start(problem, x[fittest], fitness[fittest], iterations)


def _step(coefficients, key, problem: Problem, state: DboState):
    key_forage, key_pull = jax.random.split(key)
    last = Partial(_sine_cosine, coefficients, problem, state)
    x, fitness = forage(coefficients.dbo, key_forage, problem, state, last)  # phase A
    state = settle(state, x, fitness)
    state = _try(problem, state, _pull_to_best(key_pull, state))[0]  # phase B
    return _stabilise(coefficients, problem, state)  # phase C


def _sine_cosine(
    c: SdboCoefficients, problem: Problem, state: DboState, key, thieves: Array
) -> Array:
    """Replace the last sixth of the population, the paper's beetles 26-30, by Eq. 14."""
    count = min(len(thieves), round(len(state.x) * 5 / 30))
    if count == 0:
        return thieves
    dtype, origin = state.x.dtype, origin_of(c.dbo, problem)
    p, best = state.personal[-count:] - origin, state.best.x[None] - origin
    progress = state.clock.fraction(dtype)
    inertia = c.inertia_start + (c.inertia_end - c.inertia_start) * progress  # Eq. 16
    r1 = c.amplitude * jnp.exp(-2 * progress**4)  # Eq. 15
    unit = jax.random.uniform(key, (3, *p.shape), dtype)
    r2, r3, r4 = 2 * jnp.pi * unit[0], 4 * unit[1] - 2, 2 * unit[2] - 1
    wave = jnp.where(r4 < c.branch, jnp.sin(r2), jnp.cos(r2))
    moved = inertia * p + r1 * wave * jnp.abs(r3 * best - p)
    return jnp.concatenate([thieves[:-count], origin + moved])


def _pull_to_best(key, state: DboState) -> Array:
    """Optimal individual variation (Eq. 17)."""
    r = jax.random.uniform(key, (len(state.x), 1), state.x.dtype)
    return state.personal + r * (state.best.x[None] - state.personal)


def _stabilise(c: SdboCoefficients, problem: Problem, state: DboState):
    """Scale every waypoint of p_i whose own S_c lies in the window by that S_c (Eq. 18, 19)."""
    factor = problem.stability(state.personal)
    if factor is None:
        return state, NoInfo()
    acts = jnp.logical_and(factor >= WINDOW[0], factor <= WINDOW[1])
    scale = jnp.repeat(jnp.where(acts, factor, 1), 3, axis=1)
    origin = origin_of(c.dbo, problem)
    acted = acts.any(axis=1)
    proposal = jnp.where(acted[:, None], origin + scale * (state.personal - origin), state.personal)
    state, kept = _try(problem, state, proposal)
    dtype = state.x.dtype
    return state, StabilityMove(acted.mean(dtype=dtype), (kept & acted).mean(dtype=dtype))


def _try(problem: Problem, state: DboState, proposal: Array) -> tuple[DboState, Array]:
    """Evaluate one proposal per beetle; a better one replaces p_i and x_i (and X^b where due)."""
    proposal = problem.repair(proposal)
    fitness = problem.evaluate(proposal)
    improved = jnp.less(fitness, state.personal_fitness)[:, None]
    moved = state._replace(
        x=jnp.where(improved, proposal, state.x),
        fitness=jnp.where(improved[:, 0], fitness, state.fitness),
    )
    return remember(moved, proposal, fitness), improved[:, 0]
