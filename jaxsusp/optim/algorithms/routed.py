"""Islands on distinct ways, raced: the house algorithm.

Every island is a CMA-ES (`cmaes`) with a start of its own: a way through the free space with its
waypoints spaced in one of several manners (`Problem.starts`), or anywhere where the problem knows
no ways. At first an island's step in every waypoint is in proportion to the room between that
waypoint and its neighbours. In every iteration those islands draw, evaluate and learn that have had
the fewest generations. In every part of the run only the better half of those goes on that the part
before ended with (successive halving: Karnin, Koren & Somekh 2013): what cannot win leaves its
budget to what can.

One island more knows nothing of ways: it begins wide, about the best of a random crowd.

Candidates are kept within the bounds alone. Regions leave out slivers beside the obstacles, which
is where the best ways go; islands begin on clear ways, and contacts cost what they cost.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Bool, Float
from jaxsusp.errors import InputError, require_count
from jaxsusp.optim.algorithms.cmaes import (
    SEPARABLE,
    Gaussian,
    draw,
    from_unit,
    gaussian,
    learn,
    to_unit,
)
from jaxsusp.optim.base import Best, Clock, NoInfo, Optimizer, best_of, better, chosen_of
from jaxsusp.problem.problem import Problem

ISLANDS = 8
"""Islands where the problem gives no starts."""

CROWD = 30
"""Candidates that an island draws in a generation, if the population holds as many."""

PARTS = 3
"""Parts of a run, in each of which half as many islands go on as in the one before."""

LEAST = 4
"""Smallest population."""


class RoutedCoefficients(NamedTuple):
    """First step sizes, and whether islands are raced."""

    step: float = 0.1  # about a given start, in shares of its spread
    wide: float = 0.3  # about a random start, in shares of the range
    halving: float = 1.0  # 0: all islands go on to the end


class RoutedState(NamedTuple):
    """All islands, and the best candidate of any."""

    islands: Gaussian  # leading axis: islands
    fitness: Float[Array, "islands"]  # best so far of each; +inf where there is none
    there: Bool[Array, "islands"]  # others only fill up
    latest: Float[Array, "pop"]  # fitness of the latest candidates
    best: Best
    clock: Clock


def routed(**coefficients: float) -> Optimizer:
    """Islands of CMA-ES on distinct routes, raced by successive halving.

    Args:
        **coefficients: any field of `RoutedCoefficients`.

    Returns:
        The optimiser named "routed".
    """
    chosen = chosen_of("routed", RoutedCoefficients, coefficients)
    return Optimizer("routed", Partial(_init, chosen), Partial(_step, chosen), thorough=True)


def _init(c: RoutedCoefficients, key, problem: Problem, population: int, iterations: int):
    require_count("population of routed", population, least=LEAST)
    starts = problem.starts
    if starts is None:
        x = problem.sample(key, ISLANDS)
        there, spread = jnp.ones(ISLANDS, bool), jnp.full_like(x, c.wide)
    else:
        there = jnp.isfinite(starts.x).all(axis=1)
        x = problem.clip(jnp.where(there[:, None], starts.x, problem.reference[None]))
        share = c.step * starts.spread / (problem.high - problem.low)
        spread = jnp.where(there[:, None], share, c.wide).astype(x.dtype)
    islands = len(x) + 1
    _require_time(population, iterations, islands)
    seeds = jnp.concatenate([x, problem.sample(key, CROWD)])
    value = problem.evaluate(seeds)
    free = best_of(seeds[len(x) :], value[len(x) :])
    x = jnp.concatenate([x, free.x[None]])
    spread = jnp.concatenate([spread, jnp.full_like(x[:1], c.wide)])
    there = jnp.append(there, True)
    fitness = jnp.append(jnp.where(there[:-1], value[: islands - 1], jnp.inf), free.fitness)
    begun = jax.vmap(gaussian, in_axes=(0, 0, None))
    return RoutedState(
        begun(to_unit(problem, x), spread, problem.dim > SEPARABLE),
        fitness,
        there,
        jnp.zeros(population, x.dtype),
        best_of(x, fitness),
        Clock.start(iterations),
    )


def _lanes(population: int, islands: int) -> int:
    """Islands that have a generation in the same iteration."""
    return min(islands, max(1, population // CROWD))


def _require_time(population: int, iterations: int, islands: int) -> None:
    """Refuse a run whose first part does not reach every island."""
    least = -(-PARTS * islands // _lanes(population, islands))
    if iterations < least:
        raise InputError(
            f"iterations = {iterations}: too few for {islands} islands of routed with "
            f"population = {population}; give at least {least} iterations"
        )


def _step(c: RoutedCoefficients, key, problem: Problem, state: RoutedState):
    islands, population = len(state.fitness), len(state.latest)
    lanes = _lanes(population, islands)
    turn = _whose_turn(c, state, lanes)
    chosen: Gaussian = jax.tree.map(lambda leaf: leaf[turn], state.islands)

    keys, crowd = jax.random.split(key, lanes), population // lanes
    drawn = jax.vmap(draw, in_axes=(0, 0, None))(keys, chosen, crowd)
    x = problem.clip(from_unit(problem, drawn.reshape(lanes * crowd, -1)))
    fitness = problem.evaluate(x)
    found = fitness.reshape(lanes, crowd)
    learned = jax.vmap(learn)(chosen, to_unit(problem, x).reshape(drawn.shape), found)
    return (
        state._replace(
            islands=jax.tree.map(lambda old, new: _put(old, turn, new), state.islands, learned),
            fitness=_put(state.fitness, turn, jnp.minimum(state.fitness[turn], found.min(axis=1))),
            best=better(best_of(x, fitness), state.best),
            clock=state.clock.tick(),
        ),
        NoInfo(),
    )


def _put(old: Array, rows: Array, new: Array) -> Array:
    return jnp.asarray(old).at[rows].set(new)


def _whose_turn(c: RoutedCoefficients, state: RoutedState, lanes: int) -> Array:
    """Which islands go on now: of those in the race, those with the fewest generations."""
    dtype = state.fitness.dtype
    part = PARTS * (state.clock.iteration - 1) // state.clock.horizon
    left = jnp.ceil(state.there.astype(dtype).sum() / 2 ** (c.halving * part.astype(dtype)))
    left = jnp.maximum(left, lanes)
    rank = jnp.argsort(jnp.argsort(state.fitness, stable=True), stable=True).astype(dtype)
    out = jnp.iinfo(jnp.int32).max
    return jnp.argsort(jnp.where(rank < left, state.islands.generation, out), stable=True)[:lanes]
