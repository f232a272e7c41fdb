"""Particle swarm optimisation with linearly decreasing inertia (Shi & Eberhart 1998)."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.optim.base import Best, Clock, NoInfo, Optimizer, best_of, better, chosen_of
from jaxsusp.problem.problem import Problem


class PsoCoefficients(NamedTuple):
    """Defaults: Shi & Eberhart's inertia schedule and acceleration constants."""

    inertia_start: float = 0.9
    inertia_end: float = 0.4
    cognitive: float = 2.0
    social: float = 2.0
    max_velocity: float = 0.2  # share of the range per step


class PsoState(NamedTuple):
    """Positions, velocities and what each particle remembers."""

    x: Float[Array, "pop dim"]
    velocity: Float[Array, "pop dim"]
    personal: Float[Array, "pop dim"]
    personal_fitness: Float[Array, "pop"]
    best: Best
    clock: Clock


def pso(**coefficients: float) -> Optimizer:
    """Global-best particle swarm.

    Args:
        **coefficients: any field of `PsoCoefficients`.

    Returns:
        The optimiser named "pso".
    """
    chosen = chosen_of("pso", PsoCoefficients, coefficients)
    return Optimizer("pso", Partial(_init, chosen), Partial(_step, chosen))


def _init(coefficients, key, problem: Problem, population: int, iterations) -> PsoState:
    del coefficients
    x = problem.sample(key, population)
    fitness = problem.evaluate(x)
    return PsoState(x, jnp.zeros_like(x), x, fitness, best_of(x, fitness), Clock.start(iterations))


def _step(coefficients, key, problem: Problem, state: PsoState) -> tuple[PsoState, NoInfo]:
    c = coefficients
    inertia = c.inertia_start + (c.inertia_end - c.inertia_start) * state.clock.fraction(
        state.x.dtype
    )
    pull = jax.random.uniform(key, (2, *state.x.shape), state.x.dtype)
    velocity = (
        inertia * state.velocity
        + c.cognitive * pull[0] * (state.personal - state.x)
        + c.social * pull[1] * (state.best.x[None] - state.x)
    )
    limit = c.max_velocity * (problem.high - problem.low)
    velocity = jnp.clip(velocity, -limit, limit)
    proposal = state.x + velocity
    x = problem.repair(proposal)
    velocity = jnp.where(x == proposal, velocity, 0)  # a particle stops where it is held back

    fitness = problem.evaluate(x)
    improved = fitness < state.personal_fitness
    return (
        PsoState(
            x,
            velocity,
            jnp.where(improved[:, None], x, state.personal),
            jnp.where(improved, fitness, state.personal_fitness),
            better(best_of(x, fitness), state.best),
            state.clock.tick(),
        ),
        NoInfo(),
    )
