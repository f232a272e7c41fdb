"""Limits of Eq. 22 as counts of violations along a sampled trajectory (n_g of spec §9)."""

import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Int
from jaxsusp.mechanics.cables import component
from jaxsusp.mechanics.stability import stability, stability_factors
from jaxsusp.vec3 import Vec3, norm
from jaxsusp.world import Limits, Robots, World

WORKSPACE_TOLERANCE = 1e-3
"""m by which a sample may lie outside the workspace before it counts."""

# In float32 the limits are drawn in by a little more than the rounding error of what they bound,
# so that what a search finds admissible stays so when it is re-evaluated in float64.
SINGLE_PRECISION_TENSION = 1e-3  # N
DOUBLE_PRECISION_TENSION = 1e-9  # N, for tensions that are put exactly at their limit
SINGLE_PRECISION_LENGTH = 1e-4  # m
SINGLE_PRECISION_STABILITY = 1e-5


AXIS = 0.5
"""m by which an end that an arm moves keeps off the arm's own vertical axis, where the arm has
to whirl round. Ours: an end of 0.4 m/s turns it with 46 degrees a second there."""


def count_violations(
    world: World,
    position: Vec3,
    lengths: list[Array],
    tensions: list[Array],
    with_stability: bool,
    ends: Vec3 | None = None,
) -> Int[Array, "*batch"]:
    """Number n_g of violated limits: per (sample, cable) for tension and length, else per sample.

    A tension or length that is not finite violates its limit.

    Args:
        world: limits, workspace and ends.
        position: payload centre (m), samples on axis 0, any trailing batch axes.
        lengths: l_k (m), each of the shape of the position's components.
        tensions: T_k (N), likewise.
        with_stability: whether to check S_c >= S_cmin at all (it costs four cube roots a sample).
        ends: P_k packed along the first axis (m), where they are not the world's own.
    """
    limits = world.limits
    single = position.x.dtype == jnp.float32
    margin = SINGLE_PRECISION_LENGTH if single else 0.0
    tight = _drawn_in(limits, SINGLE_PRECISION_TENSION if single else 0.0)
    violated = jnp.zeros(position.x.shape, jnp.int32)
    for length, tension in zip(lengths, tensions, strict=True):
        violated += _count(~_within(tension, *tight))
        violated += _count(
            ~_within(length, limits.length_low + margin, limits.length_high - margin)
        )
    reach = WORKSPACE_TOLERANCE - margin
    violated += _count(
        ~_within(position.x, world.lower.x - reach, world.upper.x + reach)
        | ~_within(position.y, world.lower.y - reach, world.upper.y + reach)
        | ~_within(position.z, world.lower.z - reach, world.upper.z + reach)
    )
    if with_stability:
        extra = SINGLE_PRECISION_STABILITY if single else 0.0
        needed = jnp.where(limits.stability > 0, limits.stability + extra, 0)  # 0 is no limit
        violated += _count(~(stability_of(world, position, tensions, ends) >= needed))
    return violated.sum(axis=0)


def tight_tension_limits(limits: Limits, dtype) -> tuple[Array, Array]:
    """T_lo, T_hi (N) for distributing tensions: rounding then carries none beyond what is counted.

    In float32 twice as far inside as the limits that are counted there.
    """
    single = dtype == jnp.float32
    return _drawn_in(limits, 2 * SINGLE_PRECISION_TENSION if single else DOUBLE_PRECISION_TENSION)


def count_turned(world: World, turn: Array) -> Int[Array, "*batch"]:
    """Number of samples at which the load turns further than the posture limit."""
    return _count(~(turn <= world.limits.posture)).sum(axis=0)


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
            misplaced += _count(~in_reach(robots, k, end, margin))
        for other in range(k):
            apart = norm(end - component(ends, other))
            misplaced += _count(~(apart >= world.limits.separation + margin))
    return misplaced.sum(axis=0)


def in_reach(robots: Robots, k: int, end: Vec3, margin: float = 0.0) -> Bool[Array, "..."]:
    """Whether robot k can follow an end there: within its reach, and off its own axis (`AXIS`)."""
    way = end - component(robots.shoulder, k)
    distance, level = norm(way), norm(way._replace(z=jnp.zeros_like(way.z)))
    reached = _within(distance, robots.nearest[k] + margin, robots.farthest[k] - margin)
    return reached & (level >= AXIS + margin)


def stability_of(
    world: World, position: Vec3, tensions: list[Array], ends: Vec3 | None = None
) -> Array:
    """S_c at load positions with known tensions (Eq. 18)."""
    bodies, limits = world.bodies, world.limits
    hook = position + bodies.attachments.each(lambda c: c.mean(axis=0))
    factors = stability_factors(
        hook,
        bodies.ends if ends is None else ends,
        tensions,
        position.z,
        world.lower.z,
        (limits.tension_low, limits.tension_high),
    )
    return stability(factors)


def _drawn_in(limits: Limits, margin: float) -> tuple[Array, Array]:
    return jnp.asarray(limits.tension_low) + margin, jnp.asarray(limits.tension_high) - margin


def _within(value: Array, low: Array, high: Array) -> Array:
    return (value >= low) & (value <= high)


def _count(flags: Array) -> Array:
    return flags.astype(jnp.int32)
