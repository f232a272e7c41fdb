"""The robots beside the load: where their columns and links are, and how close things come.

Ends and bases are packed (K, samples, …) like everything that a search evaluates many of, with one
sample where they stay; all is in the dtype of what is given.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.geometry.segments import segment_distance, segment_distance_squared
from jaxsusp.mechanics import arm
from jaxsusp.scenario.world import Robots, World
from jaxsusp.vec3 import Vec3, component, pack, pack_rows, safe_sqrt

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
    robots = world.robots
    still = [pack_rows(each).each(lambda c: c[:, None]) for each in (ends, robots.base)]
    slack = _slack(world, position, *still).min(axis=-1)
    solution = arm.inverse(robots.base, robots.links, ends)
    joints = jnp.stack([solution.elbow_up, solution.elbow_down])
    chains = jax.vmap(arm.chain, in_axes=(None, None, 0))(robots.base, robots.links, joints)
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
    slack = _slack(world, Vec3.from_array(position), pack_rows(ends), pack_rows(bases))
    return _prefer(slack.min(axis=-1))


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
    faulty = (arm_excess(world, position, ends, bases) > 0).sum(axis=2, dtype=jnp.int32)
    return faulty.min(axis=0).sum(axis=0)


def arm_excess(
    world: World, position: Vec3, ends: Vec3, bases: Vec3
) -> Float[Array, "elbows=2 cables samples *batch"]:
    """What moving arms lack of their clearance (m) at samples, with elbows up, then down.

    Args:
        world: robots, obstacles, load and distances required.
        position: the load's centre, samples on axis 0, any trailing batch axes (m).
        ends: P_k packed (K, samples, …) (m).
        bases: O_k packed (K, samples, …) (m).
    """
    return ARM_MARGIN - _slack(world, position, ends, bases)


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


_PART = (0, 1, 2, 1, 2)
"""What is packed: the column, upper and lower link with the elbow up, the same with it down."""

_LOWER = slice(2, None, 2)
"""Those at whose stop the own cable begins."""


def _slack(
    world: World, position: Vec3, ends: Vec3, bases: Vec3
) -> Float[Array, "elbows=2 cables samples *batch"]:
    """Least clearance of every arm beyond what is required, elbows up, then down.

    It is -1 where an arm meets an obstacle or a joint limit forbids the way it is bent.
    """
    bodies, count = world.bodies, ends.x.shape[0]
    starts, stops = _packed_parts(world, ends, bases)
    radii = jnp.asarray(world.robots.radius)
    radius = _beside(jnp.stack([radii[:, part] for part in _PART]), ends)
    shared = bodies.attachments.x.shape[0] == 1
    hooks = [position + component(bodies.attachments, 0 if shared else k) for k in range(count)]

    middle = _before(position, 2)
    low, high = (middle._replace(z=middle.z + up * bodies.half_height) for up in (-1, 1))
    load = segment_distance(starts, stops, low, high) - bodies.radius
    square = jnp.full_like(load, jnp.inf)
    for k, hook in enumerate(hooks):
        cable = _before(hook, 2), _before(component(ends, k), 2)
        away = segment_distance_squared(starts, stops, *cable)
        own = np.zeros((len(_PART), count), bool)
        own[_LOWER, k] = True
        square = jnp.minimum(square, jnp.where(_beside(own, ends), jnp.inf, away))
    cables = safe_sqrt(square) - bodies.cable_radius
    least = jnp.minimum(load, cables) - radius - bodies.clearance

    hooked = pack(hooks)
    begun = ends + (hooked - ends) * NEAR_END
    begins, ends_at = (each.each(lambda c: c[_LOWER]) for each in (starts, stops))
    own_link = segment_distance(begins, ends_at, _before(hooked, 1), _before(begun, 1))
    own_link = own_link - bodies.cable_radius - radius[_LOWER]

    clear = segments_clear(starts, stops, radius + bodies.clearance, world.obstacles)
    clear, least = (_either(clear, jnp.logical_and), _either(least, jnp.minimum))
    free = jnp.logical_and(clear, _allowed(world.robots, ends, bases))
    return jnp.where(free, jnp.minimum(least, own_link), -1)


def _either(packed: Array, join: Callable[[Array, Array], Array]) -> Array:
    """What column and links have in common, with the elbow up and with it down."""
    column, links = packed[0], (packed[1:3], packed[3:5])
    return jnp.stack([join(column, join(*pair)) for pair in links])


def _before(vector: Vec3, axes: int) -> Vec3:
    """With so many axes of length one added in front."""
    return vector.each(lambda c: c.reshape(*(1,) * axes, *c.shape))


def _beside(rows, packed: Vec3):
    """Numbers per robot (…, K), to be broadcast against packed places (…, K, samples, …)."""
    return rows.reshape(*rows.shape, *(1,) * (packed.x.ndim - 1))


def _packed_parts(world: World, ends: Vec3, bases: Vec3) -> tuple[Vec3, Vec3]:
    """Where parts begin and end, (5, K, samples, …): column, links elbow up, links elbow down."""
    column, upper, lower = (_beside(jnp.asarray(world.robots.links[:, i]), ends) for i in range(3))
    shoulder = bases._replace(z=bases.z + column)
    up, down = arm.bent(shoulder, upper, lower, ends)
    return (
        pack([bases, shoulder, up.elbow, shoulder, down.elbow]),
        pack([shoulder, up.elbow, up.end, down.elbow, down.end]),
    )


def _allowed(robots: Robots, ends: Vec3, bases: Vec3) -> Bool[Array, "elbows=2 cables ..."]:
    """Whether joint limits allow elbows up, down; without limits no angle is computed."""

    def look() -> Array:
        links = [_beside(jnp.asarray(robots.links[:, i]), ends) for i in range(3)]
        solution = arm.inverse(
            bases.to_array(), jnp.stack(jnp.broadcast_arrays(*links), axis=-1), ends.to_array()
        )
        low, high = (
            jnp.moveaxis(_beside(jnp.asarray(each).T, ends), 0, -1)
            for each in (robots.joint_low, robots.joint_high)
        )
        joints = (solution.elbow_up, solution.elbow_down)
        return jnp.stack([((each >= low) & (each <= high)).all(axis=-1) for each in joints])

    limited = jnp.isfinite(robots.joint_low).any() | jnp.isfinite(robots.joint_high).any()
    return jax.lax.cond(limited, look, lambda: jnp.ones((2, *ends.x.shape), bool))


def _parts(chains) -> tuple[Vec3, Vec3]:
    """Where the parts of every arm begin and end, components (arms, parts)."""
    return Vec3.from_array(chains[:, :-1]), Vec3.from_array(chains[:, 1:])
