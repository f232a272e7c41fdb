"""Real-coded genetic algorithm with pymoo's default operators.

Binary tournament, bounded simulated binary crossover and bounded polynomial mutation (Deb &
Agrawal 1995; Deb & Goyal 1996), (μ+λ) survival with duplicates kept.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float, Int, Key
from jaxsusp.optim.base import Best, NoInfo, Optimizer, best_of, chosen_of
from jaxsusp.problem.problem import Problem


class GaCoefficients(NamedTuple):
    """Defaults: those of pymoo's `GA`."""

    crossover_index: float = 15.0  # η of SBX
    crossover_probability: float = 0.9  # per mating
    crossover_per_variable: float = 0.5
    mutation_index: float = 20.0  # η of polynomial mutation
    mutation_probability: float = 0.9  # per offspring; each variable then with min(½, 1/D)


class GaState(NamedTuple):
    """The parents, best first after the first step."""

    x: Float[Array, "pop dim"]
    fitness: Float[Array, "pop"]
    best: Best


def ga(**coefficients: float) -> Optimizer:
    """Real-coded genetic algorithm.

    Args:
        **coefficients: any field of `GaCoefficients`.

    Returns:
        The optimiser named "ga".
    """
    chosen = chosen_of("ga", GaCoefficients, coefficients)
    return Optimizer("ga", Partial(_init, chosen), Partial(_step, chosen))


def _init(coefficients, key, problem: Problem, population: int, iterations) -> GaState:
    del coefficients, iterations
    x = problem.sample(key, population)
    fitness = problem.evaluate(x)
    return GaState(x, fitness, best_of(x, fitness))


def _step(coefficients, key, problem: Problem, state: GaState) -> tuple[GaState, NoInfo]:
    c, count = coefficients, len(state.fitness)
    key_select, key_cross, key_mutate = jax.random.split(key, 3)
    parents = state.x[tournament(key_select, state.fitness, 2 * ((count + 1) // 2))]
    children = crossover(key_cross, parents[0::2], parents[1::2], problem, c)[:count]
    children = problem.repair(mutate(key_mutate, children, problem, c))

    x = jnp.concatenate([state.x, children])
    fitness = jnp.concatenate([state.fitness, problem.evaluate(children)])
    survivors = jax.lax.top_k(-fitness, count)[1]
    x, fitness = x[survivors], fitness[survivors]
    return GaState(x, fitness, Best(x[0], fitness[0])), NoInfo()


def tournament(key: Key[Array, ""], fitness: Float[Array, "pop"], count: int) -> Int[Array, "n"]:
    """Indices of `count` winners of binary tournaments.

    Contestants come from whole permutations of the population, so that every member competes
    equally often; ties are decided by the draw.
    """
    members = len(fitness)
    rounds = -(-2 * count // members)
    draws = jax.random.uniform(key, (rounds, members), fitness.dtype)
    contestants = jnp.argsort(draws, axis=1).reshape(-1)[: 2 * count].reshape(count, 2)
    first, second = contestants[:, 0], contestants[:, 1]
    return jnp.where(fitness[second] < fitness[first], second, first)


def crossover(
    key: Key[Array, ""],
    mother: Float[Array, "matings dim"],
    father: Float[Array, "matings dim"],
    problem: Problem,
    coefficients: GaCoefficients,
) -> Float[Array, "children dim"]:
    """Bounded simulated binary crossover; two children per mating, first all of one kind."""
    c = coefficients
    key_mating, key_variable, key_spread, key_swap = jax.random.split(key, 4)
    shape, dtype = mother.shape, mother.dtype
    low, high = jnp.minimum(mother, father), jnp.maximum(mother, father)
    distance = high - low
    crossed = (
        (jax.random.uniform(key_mating, (shape[0], 1), dtype) < c.crossover_probability)
        & (jax.random.uniform(key_variable, shape, dtype) < c.crossover_per_variable)
        & (distance > 1e-14)
    )
    distance = jnp.where(crossed, distance, 1)[None]
    draw = jax.random.uniform(key_spread, shape, dtype)[None]
    swap = jax.random.uniform(key_swap, shape, dtype) < 0.5

    # Two children at once, by the side of the middle on which each variable lies.
    is_first = jnp.asarray([True, False])[:, None, None]
    is_above = swap[None] == is_first
    room = jnp.where(is_above, (problem.high - high)[None], (low - problem.low)[None]).clip(0)
    power = 1 / (c.crossover_index + 1)
    alpha = 2 - _power(1 + 2 * room / distance, -(c.crossover_index + 1))
    contracts = draw * alpha <= 1
    spread = _power(jnp.where(contracts, draw * alpha, 1 / (2 - draw * alpha)), power)
    reach = 0.5 * distance * spread
    children = 0.5 * (low + high)[None] + jnp.where(is_above, reach, -reach)
    children = jnp.where(crossed[None], children, jnp.where(is_first, mother[None], father[None]))
    return children.reshape(-1, shape[1])


def _power(base: Array, exponent) -> Array:
    """Base to the exponent, the base not below 0 but for rounding.

    XLA has a CPU call the C library for every power; exponentials and logarithms are vectorised.
    """
    return jnp.exp(exponent * jnp.log(base.clip(0)))


def mutate(
    key: Key[Array, ""],
    x: Float[Array, "pop dim"],
    problem: Problem,
    coefficients: GaCoefficients,
) -> Float[Array, "pop dim"]:
    """Bounded polynomial mutation of each variable with probability min(½, 1/D)."""
    c = coefficients
    key_member, key_variable, key_size = jax.random.split(key, 3)
    dtype, (count, dim) = x.dtype, x.shape
    mutated = (jax.random.uniform(key_member, (count, 1), dtype) <= c.mutation_probability) & (
        jax.random.uniform(key_variable, x.shape, dtype) < min(0.5, 1 / dim)
    )
    draw = jax.random.uniform(key_size, x.shape, dtype)
    extent = problem.high - problem.low
    power = c.mutation_index + 1

    def reach(room, weight):
        """Relative step towards a bound at relative distance `room`; weight in [0, 1]."""
        return 1 - _power(weight + (1 - weight) * _power(1 - room, power), 1 / power)

    down = reach((x - problem.low) / extent, 2 * draw)
    up = reach((problem.high - x) / extent, 2 * (1 - draw))
    step = jnp.where(draw <= 0.5, -down, up)
    return jnp.where(mutated, x + step * extent, x)
