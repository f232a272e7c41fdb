"""Where robots can hold the ends of their cables, and which ends that move are too close."""

from collections.abc import Iterator

import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.scenario.world import Robots, World
from jaxsusp.vec3 import Vec3, component, norm

SINGLE_PRECISION_LENGTH = 1e-4
"""m by which limits of lengths are drawn in where the arithmetic is float32, so that what a search
finds admissible stays so in float64."""

AXIS = 0.5
"""m by which an end that an arm moves keeps off the arm's own vertical axis, where the arm has
to whirl round. Ours: an end of 0.4 m/s turns it with 46 degrees a second there."""


def count_misplaced(world: World, ends: Vec3, drive: str) -> Int[Array, "*batch"]:
    """Number of violations of moving ends: out of the arm's reach, over its axis, or too close.

    Args:
        world: robots and limits.
        ends: P_k, (K, samples, …) (m).
        drive: the mode that moves them; bases that roll keep their arm as it is.
    """
    faults = [(~(excess <= 0)).astype(jnp.int32) for excess in misplacement(world, ends, drive)]
    misplaced = sum(faults, jnp.zeros(ends.x.shape[1:], jnp.int32))
    return misplaced.sum(axis=0)


def misplacement(world: World, ends: Vec3, drive: str) -> Iterator[Float[Array, "..."]]:
    """By how much (m) moving ends are out of reach or too close; not positive where all is well.

    Args:
        world: robots and limits.
        ends: P_k, (K, samples, …) (m).
        drive: the mode that moves them; bases that roll keep their arm as it is.
    """
    margin = SINGLE_PRECISION_LENGTH if ends.x.dtype == jnp.float32 else 0.0
    for k in range(world.cables):
        end = component(ends, k)
        if drive != "base":
            yield out_of_reach(world.robots, k, end, margin)
        for other in range(k):
            yield world.limits.separation + margin - norm(end - component(ends, other))


def in_reach(robots: Robots, k: int, end: Vec3) -> Bool[Array, "..."]:
    """Whether robot k can follow an end there: within its reach, and off its own axis (`AXIS`)."""
    return out_of_reach(robots, k, end) <= 0


def out_of_reach(robots: Robots, k: int, end: Vec3, margin: float = 0.0) -> Float[Array, "..."]:
    """By how much (m) robot k misses an end, or an end is too near to its own axis (`AXIS`)."""
    way = end - component(robots.shoulder, k)
    distance, level = norm(way), norm(way._replace(z=jnp.zeros_like(way.z)))
    missed = jnp.maximum(
        robots.nearest[k] + margin - distance, distance - (robots.farthest[k] - margin)
    )
    return jnp.maximum(missed, AXIS + margin - level)


def within(value: Array, low: Array, high: Array) -> Bool[Array, "..."]:
    """Whether values are in a range, its ends included; NaN is not."""
    return (value >= low) & (value <= high)
