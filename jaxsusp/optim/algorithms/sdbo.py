"""Stable dung beetle optimisation, the paper's algorithm (Eq. 13-19).

DBO with four additions: opposition-based initial population (Eq. 13), sine-cosine moves for the
last few thieves (Eq. 14-16), a pull of every beetle towards the best (Eq. 17), and a scaling of
waypoints by their stability factor S_c where it lies in [0.6, 0.9] (Eq. 18, 19). An iteration costs
about three evaluations per beetle where DBO costs one: the last two cost one each.

Each can be left out. Without any of them what remains is DBO, to the bit where both are given one
name, which keys the randomness.
"""

from dataclasses import dataclass, fields
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float
from jaxsusp.errors import require
from jaxsusp.mechanics.stability import WINDOW
from jaxsusp.optim.algorithms.dbo import (
    DboCoefficients,
    DboState,
    as_they_are,
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


@jax.tree_util.register_static
@dataclass(frozen=True)
class Improvements:
    """Which additions to DBO are made: structure, so that what is left out costs nothing."""

    opposition: bool = True  # Eq. 13
    sine_cosine: bool = True  # Eq. 14-16
    pull: bool = True  # Eq. 17
    stability: bool = True  # Eq. 18, 19

    @property
    def left_out(self) -> str:
        """What an algorithm's name says of those that are not made."""
        names = [each.name for each in fields(self) if not getattr(self, each.name)]
        return "-without-" + "-".join(names) if names else ""


class StabilityMove(NamedTuple):
    """How Eq. 19 fared in one iteration, as shares of the beetles."""

    acted: Float[Array, ""]  # had a waypoint with S_c in the window
    kept: Float[Array, ""]  # and became better by it


def sdbo(
    frame: str = "world",
    opposition: bool = True,
    sine_cosine: bool = True,
    pull: bool = True,
    stability: bool = True,
    **coefficients: float,
) -> Optimizer:
    """Stable dung beetle optimisation.

    Args:
        frame: "world" (the paper) or "task", see `jaxsusp.dbo`; Eq. 19 scales about the
            same origin.
        opposition: whether the initial population is the best half of a random one and its
            opposites (Eq. 13).
        sine_cosine: whether the last thieves make sine-cosine moves (Eq. 14-16).
        pull: whether every beetle is pulled to the best (Eq. 17), one evaluation each.
        stability: whether waypoints are scaled by their stability (Eq. 18, 19), one more.
        **coefficients: any other field of `SdboCoefficients`.

    Returns:
        The optimiser named "sdbo" ("sdbo-task" in the task frame), and after what it is without,
        "sdbo-without-pull". Its info tells how often the stability move acted; on a generic
        problem, which has no S_c, the move is left out.
    """
    switches = (opposition, sine_cosine, pull, stability)
    for each, on in zip(fields(Improvements), switches, strict=True):
        require(isinstance(on, bool), f"{each.name} = {on!r}: give True or False")
    made = Improvements(*switches)
    moves = DboCoefficients(task_frame=frame_coefficient(frame))
    chosen = chosen_of("sdbo", SdboCoefficients, {"dbo": moves, **coefficients})
    name = framed_name("sdbo", frame) + made.left_out
    return Optimizer(name, Partial(_init, made, chosen), Partial(_step, made, chosen))


def _init(made: Improvements, coefficients, key, problem: Problem, population: int, iterations):
    """The best half of a random population and its opposites a + b - X (Eq. 13)."""
    del coefficients
    roles(population)
    x = problem.sample(key, population)
    if not made.opposition:
        return start(problem, x, problem.evaluate(x), iterations)
    x = jnp.concatenate([x, problem.repair(problem.low + problem.high - x)])
    fitness = problem.evaluate(x)
    fittest = jnp.argsort(fitness, stable=True)[:population]
    return start(problem, x[fittest], fitness[fittest], iterations)


def _step(made: Improvements, c: SdboCoefficients, key, problem: Problem, state: DboState):
    key_forage, key_pull = jax.random.split(key) if made.pull else (key, key)
    last = Partial(sine_cosine_moves, c, problem, state) if made.sine_cosine else as_they_are
    state = settle(state, *forage(c.dbo, key_forage, problem, state, last))  # phase A
    if made.pull:
        state = pulled(key_pull, problem, state)  # phase B
    return stabilised(c, problem, state) if made.stability else (state, NoInfo())  # phase C


def sine_cosine_moves(
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


def pulled(key, problem: Problem, state: DboState) -> DboState:
    """Optimal individual variation, a pull of every beetle to the best (Eq. 17)."""
    r = jax.random.uniform(key, (len(state.x), 1), state.x.dtype)
    proposal = state.personal + r * (state.best.x[None] - state.personal)
    return _try(problem, state, proposal)[0]


def stabilised(c: SdboCoefficients, problem: Problem, state: DboState):
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
