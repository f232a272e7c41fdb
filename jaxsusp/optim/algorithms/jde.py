"""Self-adapting differential evolution, jDE (Brest et al. 2006; Storn & Price 1997).

DE/rand/1/bin whose scale factor F and crossover rate CR belong to the members: each is drawn anew
with probability τ before it is used, and survives with the trial vector that it made. Numbers of
equations are those of Brest et al., IEEE Trans. Evol. Comput. 10(6), 2006.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.errors import require_count
from jaxsusp.optim.base import Best, Clock, NoInfo, Optimizer, best_of, better, chosen_of
from jaxsusp.problem.problem import Problem

LEAST = 4
"""Smallest population: a member and three others."""


class JdeCoefficients(NamedTuple):
    """Defaults: Brest et al., Sect. IV."""

    scale: float = 0.5  # F of every member at first
    crossover: float = 0.9  # CR of every member at first
    least_scale: float = 0.1  # F_l
    scale_range: float = 0.9  # F_u
    renew_scale: float = 0.1  # τ1
    renew_crossover: float = 0.1  # τ2


class JdeState(NamedTuple):
    """Members with the factors that made them."""

    x: Float[Array, "pop dim"]
    fitness: Float[Array, "pop"]
    scale: Float[Array, "pop"]  # F
    crossover: Float[Array, "pop"]  # CR
    best: Best
    clock: Clock


def jde(**coefficients: float) -> Optimizer:
    """Self-adapting differential evolution, DE/rand/1/bin (Brest et al. 2006).

    Args:
        **coefficients: any field of `JdeCoefficients`.

    Returns:
        The optimiser named "jde".
    """
    chosen = chosen_of("jde", JdeCoefficients, coefficients)
    return Optimizer("jde", Partial(_init, chosen), Partial(_step, chosen))


def _init(c: JdeCoefficients, key, problem: Problem, population: int, iterations) -> JdeState:
    require_count("population of jde", population, least=LEAST)
    x = problem.sample(key, population)
    fitness = problem.evaluate(x)
    factor = jnp.ones(population, x.dtype)
    best = best_of(x, fitness)
    return JdeState(
        x, fitness, c.scale * factor, c.crossover * factor, best, Clock.start(iterations)
    )


def _step(c: JdeCoefficients, key, problem: Problem, state: JdeState) -> tuple[JdeState, NoInfo]:
    key_factors, key_others, key_cross, key_certain = jax.random.split(key, 4)
    (count, dim), dtype = state.x.shape, state.x.dtype
    draw = jax.random.uniform(key_factors, (4, count), dtype)
    fresh = c.least_scale + draw[0] * c.scale_range
    scale = jnp.where(draw[1] < c.renew_scale, fresh, state.scale)  # Eq. 8
    crossover = jnp.where(draw[3] < c.renew_crossover, draw[2], state.crossover)  # Eq. 9

    one, two, three = (state.x[rows] for rows in others(key_others, count))
    mutant = one + scale[:, None] * (two - three)  # Eq. 1
    certain = jnp.arange(dim)[None] == jax.random.randint(key_certain, (count, 1), 0, dim)
    crossed = jax.random.uniform(key_cross, (count, dim), dtype) < crossover[:, None]
    trial = problem.repair(jnp.where(crossed | certain, mutant, state.x))  # Eq. 2

    fitness = problem.evaluate(trial)
    stays = fitness > state.fitness  # Eq. 4, equals replace
    return (
        JdeState(
            jnp.where(stays[:, None], state.x, trial),
            jnp.where(stays, state.fitness, fitness),
            jnp.where(stays, state.scale, scale),
            jnp.where(stays, state.crossover, crossover),
            better(best_of(trial, fitness), state.best),
            state.clock.tick(),
        ),
        NoInfo(),
    )


def others(key, count: int) -> tuple[Array, Array, Array]:
    """For every member, three others that differ from it and from each other, uniformly.

    The j-th is drawn among those left and then moved past those taken, in ascending order.
    """
    member = jnp.arange(count)
    picked = []
    for j, key_j in enumerate(jax.random.split(key, 3)):
        pick = jax.random.randint(key_j, (count,), 0, count - 1 - j)
        for taken in jnp.sort(jnp.stack([member, *picked]), axis=0):
            pick = pick + (pick >= taken).astype(pick.dtype)
        picked.append(pick)
    return picked[0], picked[1], picked[2]
