"""How deep payload and cables are in obstacles along a polyline: the twin of `collisions`.

The same swept bodies are held against the same obstacles, by depth instead of by contact. Each
obstacle's gradient is worked out together with its depths, in one loop: reverse mode through the
loop would keep everything of every obstacle for the way back, and takes longer to compile.
"""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.geometry.collisions import (
    Bodies,
    Motion,
    SweptCable,
    held_against,
    kinds_of,
    with_margin,
)
from jaxsusp.geometry.depths import DEPTHS
from jaxsusp.geometry.obstacles import Obstacles, over_bodies
from jaxsusp.vec3 import Vec3


def charge(depth: Float[Array, "..."], band) -> Float[Array, "..."]:
    """What a depth counts: the depth where it is positive, else nothing.

    With a band b > 0 what is nearer than b to its limit counts already, with the square, and from
    a depth of b on the depth itself: smooth, and what minimises it keeps clear by a little.
    """
    wide = jnp.maximum(band, 1e-9)
    near = jnp.clip(depth + wide, 0, 2 * wide) ** 2 / (4 * wide)
    return jnp.where(depth > wide, depth, near)


class _Moving(NamedTuple):
    """What a gradient is taken by: where load and ends are as segments begin and stop."""

    start: Vec3
    stop: Vec3
    ends: tuple[Vec3, Vec3] | None  # (K, segments, …) each; None: the ends stay


class _Still(NamedTuple):
    bodies: Bodies
    obstacles: Obstacles
    unit: Array
    band: Array


def sum_depths(
    position: Vec3, bodies: Bodies, obstacles: Obstacles, unit, band, at_samples: bool = False
) -> Float[Array, "*batch"]:
    """Sum over every (segment, body, obstacle) of what its depth counts.

    Args:
        position: payload centre, samples on axis 0, any trailing batch axes (m).
        bodies: payload and cables; where ends move, (K, samples, …).
        obstacles: packed obstacles of one scenario.
        unit: depth that counts as 1 (m).
        band: of `charge`, in units.
        at_samples: whether to look at the samples alone, as `count_at_samples` does.

    Returns:
        The sum per trajectory; its gradient is by positions, and by ends that move.
    """
    dtype = position.x.dtype
    ends = None
    if bodies.ends.x.ndim > 1:
        ends = bodies.ends.each(lambda c: c[:, :-1]), bodies.ends.each(lambda c: c[:, 1:])
        ends = (bodies.ends, bodies.ends) if at_samples else ends
    moving = _Moving(position.each(lambda c: c[:-1]), position.each(lambda c: c[1:]), ends)
    if at_samples:
        moving = moving._replace(start=position, stop=position)
    still = _Still(
        with_margin(bodies, dtype), obstacles, jnp.asarray(unit, dtype), jnp.asarray(band, dtype)
    )
    return _summed(moving, still)


@jax.custom_vjp
def _summed(moving: _Moving, still: _Still) -> Array:
    total = jnp.zeros(moving.start.x.shape, moving.start.x.dtype)
    for kind, packed in kinds_of(still.bodies, still.obstacles):

        def add(total, obstacle, kind=kind):
            return total + _counted(kind, obstacle, moving, still)

        total = over_bodies(add, packed, total)
    return total.sum(axis=0)


def _forward(moving: _Moving, still: _Still) -> tuple[Array, _Moving]:
    total = jnp.zeros(moving.start.x.shape, moving.start.x.dtype)
    carry = total, jax.tree.map(jnp.zeros_like, moving)
    for kind, packed in kinds_of(still.bodies, still.obstacles):

        def add(carry, obstacle, kind=kind):
            total, gradient = carry

            def counted(moving: _Moving) -> Array:
                return _counted(kind, obstacle, moving, still)

            value, back = jax.vjp(counted, moving)
            gradient = jax.tree.map(jnp.add, gradient, back(jnp.ones_like(value))[0])
            return total + value, gradient

        carry = over_bodies(add, packed, carry)
    total, gradient = carry
    return total.sum(axis=0), gradient


def _backward(gradient: _Moving, cotangent: Array) -> tuple[Any, None]:
    def scaled(leaf: Array) -> Array:
        return leaf * cotangent.reshape(*(1,) * (leaf.ndim - cotangent.ndim), *cotangent.shape)

    return jax.tree.map(scaled, gradient), None


_summed.defvjp(_forward, _backward)


def _counted(kind: str, obstacle: Any, moving: _Moving, still: _Still) -> Array:
    """What load and cables count against one obstacle, (segments, …)."""
    before, after = (each.each(lambda c: c[None]) for each in (moving.start, moving.stop))
    motion, bodies = Motion.between(before, after), still.bodies  # beside the cables' axis
    cables = _all_cables(moving, bodies)
    depths = held_against(kind, obstacle, motion, bodies, cables, DEPTHS)
    told = (depth for depth in depths if depth is not None)
    amounts = [charge(depth / still.unit, still.band).sum(axis=0) for depth in told]
    if not amounts:  # nothing but the load, which its sums tell of
        return jnp.zeros(moving.start.x.shape, moving.start.x.dtype)
    return functools.reduce(jnp.add, amounts)


def _all_cables(moving: _Moving, bodies: Bodies) -> tuple[SweptCable, ...]:
    """The cables as one, packed along a new first axis: the code is once there for all of them."""
    count, rank = bodies.ends.x.shape[0], moving.start.x.ndim
    if count == 0:
        return ()

    def beside(packed: Vec3) -> Vec3:
        return packed.each(lambda c: c.reshape(-1, *(1,) * rank))

    attachments = beside(bodies.attachments)
    if moving.ends is None:
        return (SweptCable(attachments, beside(bodies.ends), None),)
    before, after = moving.ends
    return (SweptCable(attachments, 0.5 * (before + after), after - before),)


class Deepest(NamedTuple):
    """How deep load and cables are at the samples where they are deepest (m)."""

    load: Float[Array, "*batch"]
    cables: Float[Array, "*batch"]


def deepest(position: Vec3, bodies: Bodies, obstacles: Obstacles) -> Deepest:
    """The greatest depth at the samples of a trajectory, which are to be many.

    Args:
        position: payload centre, samples on axis 0, any trailing batch axes (m).
        bodies: payload and cables whose ends stay; their clearance is part of the obstacles.
        obstacles: packed obstacles of one scenario.

    Returns:
        How far a body would have to go to get out of an obstacle; negative where all are apart,
        and then no distance (see `depths`).
    """
    bodies = with_margin(bodies, position.x.dtype)
    cables = _all_cables(_Moving(position, position, None), bodies)
    resting = position.each(lambda c: c[None])  # beside the cables' axis
    motion = Motion.between(resting, resting)
    nothing = jnp.full(position.x.shape, -jnp.inf, position.x.dtype)
    found = nothing, nothing
    for kind, packed in kinds_of(bodies, obstacles):

        def deeper(found, obstacle, kind=kind):
            depths = held_against(kind, obstacle, motion, bodies, cables, DEPTHS)
            depths = [nothing if each is None else each.max(axis=0) for each in depths]
            return *map(jnp.maximum, found, depths), *found[len(depths) :]

        found = over_bodies(deeper, packed, found)
    return Deepest(*(depth.max(axis=0) for depth in found))
