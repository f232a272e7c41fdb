"""Dung beetle optimisation (Xue & Shen 2022; Eq. 8-12 as the authors' program has them).

p is each beetle's personal best, p' the personal bests one iteration earlier, x the latest
candidates, X* the best of the current x, X^b the best so far.

The moves scale positions and are therefore tied to an origin. `frame="world"` uses the world's, as
the paper does, wherever the scenario lies: what they find depends on it. `frame="task"` uses the
problem's reference point (the evenly spaced waypoints of the straight start-goal line), so that the
result does not depend on where the world's origin is.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float, Key
from jaxsusp.errors import require_count, require_known
from jaxsusp.optim.base import Best, Clock, NoInfo, Optimizer, best_of, better, chosen_of
from jaxsusp.problem.problem import Problem

FRAMES = ("world", "task")


class DboCoefficients(NamedTuple):
    """Defaults: the authors' published program."""

    task_frame: float = 0.0  # 0: the world's origin, 1: the problem's reference point
    rolling: float = 0.9  # probability that the rollers roll rather than dance
    forward: float = 0.9  # probability that the deflection coefficient ζ is +1
    light: float = 0.3  # ξ of Eq. 8
    deflection: float = 0.1  # σ of Eq. 8
    theft: float = 0.5  # Q of Eq. 12


class DboState(NamedTuple):
    """The beetles' latest candidates and what they remember."""

    x: Float[Array, "pop dim"]
    fitness: Float[Array, "pop"]
    personal: Float[Array, "pop dim"]
    personal_fitness: Float[Array, "pop"]
    previous: Float[Array, "pop dim"]
    best: Best
    clock: Clock


class Roles(NamedTuple):
    """How many beetles roll, brood, forage and steal."""

    rollers: int
    brood: int
    foragers: int
    thieves: int


def roles(population: int) -> Roles:
    """6, 6, 7 and 11 of 30 (the paper's Sect. 2.4); other populations keep the proportions."""
    require_count("population of dung beetles", population, least=4)  # one per role
    rollers = brood = max(1, round(population * 6 / 30))
    foragers = max(1, round(population * 7 / 30))
    return Roles(rollers, brood, foragers, population - rollers - brood - foragers)


def frame_coefficient(frame: str) -> float:
    """The value of `task_frame` for a frame's name."""
    require_known("frame", frame, FRAMES)
    return float(frame == "task")


def framed_name(name: str, frame: str) -> str:
    """Name under which an algorithm with this frame is recorded and seeded."""
    return name if frame == "world" else f"{name}-{frame}"


def origin_of(c: DboCoefficients, problem: Problem) -> Float[Array, "1 dim"]:
    """What positions are scaled about, as a row beside a population."""
    # Exactly one or the other: a difference of far points would be rounded.
    return ((1 - c.task_frame) * problem.origin + c.task_frame * problem.reference)[None]


def dbo(frame: str = "world", **coefficients: float) -> Optimizer:
    """Dung beetle optimisation.

    Args:
        frame: "world" (the paper) or "task"; see the module's docstring.
        **coefficients: any other field of `DboCoefficients`.

    Returns:
        The optimiser named "dbo" ("dbo-task" in the task frame).
    """
    chosen = chosen_of(
        "dbo", DboCoefficients, {"task_frame": frame_coefficient(frame), **coefficients}
    )
    return Optimizer(framed_name("dbo", frame), Partial(_init, chosen), Partial(_step, chosen))


def start(problem: Problem, x: Array, fitness: Array, iterations) -> DboState:
    """State of a population that has just been evaluated."""
    return DboState(x, fitness, x, fitness, x, best_of(x, fitness), Clock.start(iterations))


def _init(coefficients, key, problem: Problem, population: int, iterations) -> DboState:
    del coefficients
    roles(population)  # refuses populations that are too small
    x = problem.sample(key, population)
    return start(problem, x, problem.evaluate(x), iterations)


def _step(coefficients, key, problem: Problem, state: DboState) -> tuple[DboState, NoInfo]:
    return settle(state, *forage(coefficients, key, problem, state)), NoInfo()


def settle(state: DboState, x: Array, fitness: Array) -> DboState:
    """Step 7: p' ← p, p ← x where strictly better, X^b updated; x itself is kept as it is."""
    return remember(state, x, fitness)._replace(
        x=x, fitness=fitness, previous=state.personal, clock=state.clock.tick()
    )


def remember(state: DboState, x: Array, fitness: Array) -> DboState:
    """Update personal bests and X^b from candidates, one per beetle."""
    improved = fitness < state.personal_fitness
    return state._replace(
        personal=jnp.where(improved[:, None], x, state.personal),
        personal_fitness=jnp.where(improved, fitness, state.personal_fitness),
        best=better(best_of(x, fitness), state.best),
    )


def as_they_are(key: Key[Array, ""], thieves: Array) -> Array:
    """The thieves' candidates, whose last few SDBO replaces."""
    del key
    return thieves


def forage(
    coefficients: DboCoefficients,
    key: Key[Array, ""],
    problem: Problem,
    state: DboState,
    last_thief=as_they_are,
) -> tuple[Float[Array, "pop dim"], Float[Array, "pop"]]:
    """Steps 1-6: the new candidates x of all beetles and their fitness.

    Rollers move and are evaluated first, because X* of the others is the best of all x after
    rolling.

    Args:
        coefficients: of the moves.
        key: randomness of this iteration.
        problem: what is minimised.
        state: the beetles before the iteration.
        last_thief: maps (key, thieves' candidates) to those that are evaluated; SDBO replaces the
            last few here.
    """
    c, (count, _) = coefficients, state.x.shape
    role = roles(count)
    key_roll, key_brood, key_forage, key_steal, key_last = jax.random.split(key, 5)
    origin = origin_of(c, problem)
    edges = (role.rollers, role.rollers + role.brood, count - role.thieves)
    p_roll, p_brood, p_forage, p_steal = jnp.split(state.personal, edges)

    worst = state.x[jnp.argmax(state.fitness)][None]
    rolled = problem.repair(
        roll(c, key_roll, p_roll, state.previous[: role.rollers], worst, origin)
    )
    rolled_fitness = problem.evaluate(rolled)
    x = jnp.concatenate([rolled, state.x[role.rollers :]])
    fitness = jnp.concatenate([rolled_fitness, state.fitness[role.rollers :]])
    local, best = x[jnp.argmin(fitness)][None], state.best.x[None]  # X*, X^b

    shrink = 1 - state.clock.fraction(x.dtype)  # R
    spawn = area(problem, local, shrink, origin)
    feed = area(problem, best, shrink, origin)
    others = problem.repair(
        jnp.concatenate(
            [
                brood(key_brood, p_brood, local, spawn),
                wander(key_forage, p_forage, feed),
                last_thief(key_last, steal(c, key_steal, p_steal, best, local)),
            ]
        )
    )
    return (
        jnp.concatenate([rolled, others]),
        jnp.concatenate([rolled_fitness, problem.evaluate(others)]),
    )


def roll(c: DboCoefficients, key, p: Array, previous: Array, worst: Array, origin: Array) -> Array:
    """Rolling (Eq. 8), or for all rollers at once dancing (Eq. 9)."""
    key_choice, key_way, key_angle = jax.random.split(key, 3)
    dtype, count = p.dtype, len(p)
    way = jnp.where(jax.random.uniform(key_way, (count, 1), dtype) < c.forward, 1, -1).astype(dtype)
    rolled = p + c.light * jnp.abs(p - worst) + way * c.deflection * (previous - origin)

    degrees = jax.random.randint(key_angle, (count, 1), 1, 181)
    still = (degrees == 90) | (degrees == 180)
    turn = jnp.where(still, 0, jnp.tan(jnp.deg2rad(jnp.where(still, 0, degrees).astype(dtype))))
    danced = p + turn * jnp.abs(p - previous)
    return jnp.where(jax.random.uniform(key_choice, (), dtype) < c.rolling, rolled, danced)


def area(problem: Problem, center: Array, shrink: Array, origin: Array) -> tuple[Array, Array]:
    """(Lb, Ub) of the spawning or foraging area about X* or X^b.

    Scaled about the origin, so for coordinates below it Lb > Ub: the published program does not
    sort them, and neither do we.
    """
    offset = center - origin

    def edge(scale: Array) -> Array:
        return jnp.clip(origin + offset * scale, problem.low, problem.high)

    return edge(1 - shrink), edge(1 + shrink)


def brood(key, p: Array, local: Array, spawn: tuple[Array, Array]) -> Array:
    """Spawning about X* inside its area (Eq. 10)."""
    low, high = spawn
    b = jax.random.uniform(key, (2, *p.shape), p.dtype)
    x = local + b[0] * (p - low) + b[1] * (p - high)
    return jnp.minimum(jnp.maximum(x, low), high)


def wander(key, p: Array, feed: tuple[Array, Array]) -> Array:
    """Foraging in the area about X^b (Eq. 11)."""
    low, high = feed
    key_scalar, key_vector = jax.random.split(key)
    c1 = jax.random.normal(key_scalar, (len(p), 1), p.dtype)
    c2 = jax.random.uniform(key_vector, p.shape, p.dtype)
    return p + c1 * (p - low) + c2 * (p - high)


def steal(c: DboCoefficients, key, p: Array, best: Array, local: Array) -> Array:
    """Stealing near X^b (Eq. 12)."""
    g = jax.random.normal(key, p.shape, p.dtype)
    return best + c.theft * g * (jnp.abs(p - local) + jnp.abs(p - best))
