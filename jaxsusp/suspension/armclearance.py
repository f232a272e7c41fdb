"""The robots beside the load: where their columns and links are, and how close things come.

Written for one set of ends, in the dtype of what it is given; the search maps it over candidates.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.geometry.segments import segment_distance
from jaxsusp.mechanics import arm
from jaxsusp.scenario.world import Robots, World
from jaxsusp.vec3 import Vec3, rows_of

PARTS = 3
"""Bodies of an arm: column, upper link, lower link."""

NEAR_END = 0.1
"""Share of a cable's length, from its upper end, that may touch the link at whose end it begins."""

ARM_MARGIN = 0.02
"""m of clearance of arms beyond what is required: they are looked at at the samples only."""


class Posture(NamedTuple):
    """How every robot holds its end."""

    joints: Float[Array, "cables joints"]  # rad
    chains: Float[Array, "cables points=4 xyz"]  # foot, shoulder, elbow, end; m
    slack: Float[Array, "cables"]  # clearance beyond what is required at the samples, m
    elbow_up: Bool[Array, "cables"]


def choose_postures(world: World, position: Vec3, ends: Float[Array, "cables xyz"]) -> Posture:
    """Elbow up, or down where the elbow would be in the way and down is better.

    An arm whose elbow is up leans over its own column, where its own cable may pass: with the
    nominal ends of the benchmark it does. What is in the way is told at the samples: obstacles,
    the load, and cables; of the own cable the first tenth may touch the lower link.

    Args:
        world: robots, obstacles, load and distances required.
        position: the load's centre at samples along axis 0 (m).
        ends: P_k (m).
    """
    joints, chains, slack = _branches(world, world.robots, position, ends)
    up = _prefer(slack)
    return Posture(
        jnp.where(up[:, None], *joints),
        jnp.where(up[:, None, None], *chains),
        jnp.where(up, *slack),
        up,
    )


def choose_elbows(
    world: World,
    position: Float[Array, "samples xyz"],
    ends: Float[Array, "samples cables xyz"],
    bases: Float[Array, "samples cables xyz"],
) -> Bool[Array, "cables"]:
    """Elbow up or down of arms that move, one choice per robot for the whole motion."""
    return _prefer(_slacks(world, position, ends, bases).min(axis=0))


def count_arm_contacts(
    world: World, position: Vec3, ends: Vec3, bases: Vec3
) -> Int[Array, "*batch"]:
    """Number of (sample, robot) at which an arm that moves is too close to something.

    Of every robot with the elbow that is in the way less often. Looked at at the samples only.

    Args:
        world: robots, obstacles, load and distances required.
        position: the load's centre, samples on axis 0, any trailing batch axes (m).
        ends: P_k packed (K, samples, …) (m).
        bases: O_k packed (K, samples, …) (m).
    """
    faulty = (arm_excess(world, position, ends, bases) > 0).sum(axis=-3, dtype=jnp.int32)
    return faulty.min(axis=-2).sum(axis=-1)


def arm_excess(
    world: World, position: Vec3, ends: Vec3, bases: Vec3
) -> Float[Array, "*batch samples elbows=2 cables"]:
    """What moving arms lack of their clearance (m) at samples, with elbows up, then down.

    Args:
        world: robots, obstacles, load and distances required.
        position: the load's centre, samples on axis 0, any trailing batch axes (m).
        ends: P_k packed (K, samples, …) (m).
        bases: O_k packed (K, samples, …) (m).
    """
    batch = position.x.shape[1:]
    where = position.to_array().reshape(len(position.x), -1, 3)
    held, feet = (rows_of(each).reshape(*where.shape[:2], -1, 3) for each in (ends, bases))
    slack = jax.vmap(_slacks, in_axes=(None, 1, 1, 1))(world, where, held, feet)
    return (ARM_MARGIN - slack).reshape(*batch, *slack.shape[1:])


def _slacks(world: World, position, ends, bases) -> Float[Array, "samples elbows=2 cables"]:
    """Slack at every sample with elbows up, then down."""

    def at(where: Array, end: Array, base: Array) -> Array:
        still = Vec3.from_array(where[None])
        return _branches(world, world.robots._replace(base=base), still, end)[2]

    return jax.vmap(at)(position, ends, bases)


def _branches(world: World, robots: Robots, position: Vec3, ends) -> tuple[Array, Array, Array]:
    """Joints, chains and slack with elbows up, then down; -1 where a joint limit forbids it."""
    solution = arm.inverse(robots.base, robots.links, ends)
    joints = jnp.stack([solution.elbow_up, solution.elbow_down])
    chains = jax.vmap(arm.chain, in_axes=(None, None, 0))(robots.base, robots.links, joints)
    slack = jax.vmap(_slack, in_axes=(None, None, None, None, 0))(
        world, robots, position, ends, chains
    )
    allowed = (joints >= robots.joint_low[None]) & (joints <= robots.joint_high[None])
    return joints, chains, jnp.where(allowed.all(axis=-1), slack, -1)


def _prefer(slack: Float[Array, "elbows=2 cables"]) -> Bool[Array, "cables"]:
    return jnp.logical_or(slack[0] >= 0, slack[0] >= slack[1])


def separation_slack(world: World, chains: Float[Array, "cables points=4 xyz"]) -> Array:
    """Least distance between arms, or ends, of different robots beyond what is required (m)."""
    one, other = np.triu_indices(len(chains), 1)
    starts, stops = _parts(chains)

    def pick(points: Vec3, which: np.ndarray, axis: int) -> Vec3:
        return points.each(lambda c: jnp.expand_dims(c[which], axis))

    gap = segment_distance(
        *(pick(points, one, 2) for points in (starts, stops)),
        *(pick(points, other, 1) for points in (starts, stops)),
    )  # (pairs, parts, parts)
    radius = jnp.asarray(world.robots.radius)
    gap = gap - radius[one][:, :, None] - radius[other][:, None, :]
    ends = chains[one, 3] - chains[other, 3]
    apart = jnp.sqrt((ends**2).sum(axis=-1))
    return jnp.minimum(gap.min(), apart.min()) - world.limits.separation


def _slack(world: World, robots: Robots, position: Vec3, ends, chains) -> Float[Array, "cables"]:
    """Least clearance of every arm beyond what is required; -1 where it meets an obstacle."""
    bodies, count = world.bodies, len(chains)
    starts, stops = _parts(chains)
    axis = Vec3(0 * position.x, 0 * position.y, 0 * position.z + bodies.half_height)
    load = segment_distance(
        _spread(starts, 1), _spread(stops, 1),
        _lead(position - axis, 2), _lead(position + axis, 2),
    )  # (arms, parts, samples)  # fmt: skip
    load = load.min(axis=-1) - bodies.radius

    hooks = Vec3(
        *(
            jnp.stack([component + at[k % len(at)] for k in range(count)])
            for component, at in zip(position, bodies.attachments, strict=True)
        )
    )
    cables = segment_distance(
        _spread(starts, 2), _spread(stops, 2),
        _lead(hooks, 2), _lead(_spread(Vec3.from_array(ends), 1), 2),
    )  # (arms, parts, cables, samples)  # fmt: skip
    own = np.zeros((count, PARTS, count), bool)
    own[range(count), PARTS - 1, range(count)] = True  # the cable begins at the end of the link
    cables = jnp.where(own, jnp.inf, cables.min(axis=-1)).min(axis=-1) - bodies.cable_radius

    top = Vec3.from_array(ends).each(lambda c: c[:, None])
    begun = top + (hooks - top) * NEAR_END
    link = starts.each(lambda c: c[:, -1:]), stops.each(lambda c: c[:, -1:])
    own_link = segment_distance(*link, hooks, begun).min(axis=-1)
    own_link = own_link - bodies.cable_radius - robots.radius[:, -1]

    least = (jnp.minimum(load, cables) - robots.radius).min(axis=-1) - bodies.clearance
    least = jnp.minimum(least, own_link)
    wide = robots.radius + bodies.clearance
    clear = segments_clear(starts, stops, wide, world.obstacles)
    return jnp.where(clear.all(axis=-1), least, -1)


def _parts(chains) -> tuple[Vec3, Vec3]:
    """Where the parts of every arm begin and end, components (arms, parts)."""
    return Vec3.from_array(chains[:, :-1]), Vec3.from_array(chains[:, 1:])


def _spread(vector: Vec3, axes: int) -> Vec3:
    """With so many axes of length one added behind."""
    return vector.each(lambda c: c.reshape(*c.shape, *(1,) * axes))


def _lead(vector: Vec3, axes: int) -> Vec3:
    """With so many axes of length one added in front."""
    return vector.each(lambda c: c.reshape(*(1,) * axes, *c.shape))
