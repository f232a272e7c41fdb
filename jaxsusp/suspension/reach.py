"""Where robots can hold the ends of their cables, and which ends that move are too close."""

import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Int
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
    robots, margin = world.robots, SINGLE_PRECISION_LENGTH
    margin = margin if ends.x.dtype == jnp.float32 else 0.0
    misplaced = jnp.zeros(ends.x.shape[1:], jnp.int32)
    for k in range(world.cables):
        end = component(ends, k)
        if drive != "base":
            misplaced += (~in_reach(robots, k, end, margin)).astype(jnp.int32)
        for other in range(k):
            apart = norm(end - component(ends, other))
            misplaced += (~(apart >= world.limits.separation + margin)).astype(jnp.int32)
    return misplaced.sum(axis=0)


def in_reach(robots: Robots, k: int, end: Vec3, margin: float = 0.0) -> Bool[Array, "..."]:
    """Whether robot k can follow an end there: within its reach, and off its own axis (`AXIS`)."""
    way = end - component(robots.shoulder, k)
    distance, level = norm(way), norm(way._replace(z=jnp.zeros_like(way.z)))
    reached = within(distance, robots.nearest[k] + margin, robots.farthest[k] - margin)
    return reached & (level >= AXIS + margin)


def within(value: Array, low: Array, high: Array) -> Bool[Array, "..."]:
    """Whether values are in a range, its ends included; NaN is not."""
    return (value >= low) & (value <= high)
