"""Limits of Eq. 22 as counts of violations along a sampled trajectory (n_g, our part of f6)."""

import jax.numpy as jnp

from jaxsusp._types import Array, Int
from jaxsusp.scenario.world import World
from jaxsusp.suspension.levelload import SINGLE_PRECISION_TENSION, drawn_in, stability_of
from jaxsusp.suspension.reach import SINGLE_PRECISION_LENGTH, within
from jaxsusp.vec3 import Vec3

WORKSPACE_TOLERANCE = 1e-3
"""m by which a sample may lie outside the workspace before it counts."""

SINGLE_PRECISION_STABILITY = 1e-5
"""By which S_cmin is raised where the arithmetic is float32, see `suspension.levelload`."""


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
    tight = drawn_in(limits, SINGLE_PRECISION_TENSION if single else 0.0)
    violated = jnp.zeros(position.x.shape, jnp.int32)
    for length, tension in zip(lengths, tensions, strict=True):
        violated += _count(~within(tension, *tight))
        violated += _count(~within(length, limits.length_low + margin, limits.length_high - margin))
    reach = WORKSPACE_TOLERANCE - margin
    violated += _count(
        ~within(position.x, world.lower.x - reach, world.upper.x + reach)
        | ~within(position.y, world.lower.y - reach, world.upper.y + reach)
        | ~within(position.z, world.floor - reach, world.upper.z + reach)
    )
    if with_stability:
        extra = SINGLE_PRECISION_STABILITY if single else 0.0
        needed = jnp.where(limits.stability > 0, limits.stability + extra, 0)  # 0 is no limit
        violated += _count(~(stability_of(world, position, tensions, ends) >= needed))
    return violated.sum(axis=0)


def count_turned(world: World, turn: Array) -> Int[Array, "*batch"]:
    """Number of samples at which the load turns further than the posture limit."""
    return _count(~(turn <= world.limits.posture)).sum(axis=0)


def _count(flags: Array) -> Array:
    return flags.astype(jnp.int32)
