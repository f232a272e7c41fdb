"""The four drive modes: where the ends, lengths and bases are while the load moves.

    cable   the ends stay, the lengths vary
    end     the lengths stay, the arms' joints move the ends
    base    lengths and joints stay, the bases roll on the ground: P_k = O_k(t) + const
    hybrid  ends and lengths both vary

A mode leaves freedom that the paper does not fill. Ours is the plainest rule in each: *end* keeps
every cable's direction, so that the ends move as the load does and the tensions do not change;
*base* keeps every cable's heading seen from above, and the bases roll in or out as the load rises
or sinks; *hybrid* lets the ends follow half of the load's way at their heights. Least variance
(`coordination.leastvariance`) chooses better ends around these.
"""

from typing import Literal, NamedTuple

import jax.numpy as jnp

from jaxsusp.geometry.cables import attachment
from jaxsusp.vec3 import Vec3, component, norm, pack, safe_sqrt

Drive = Literal["cable", "end", "base", "hybrid"]
HYBRID_SHARE = 0.5
"""Share of the load's horizontal way that the ends follow in mode "hybrid"."""


class Anchors(NamedTuple):
    """What a drive mode starts from: the load at `position` with its ends where they are given."""

    position: Vec3  # the load's centre at the start (m)
    attachments: Vec3  # B'_k, one packed entry for a hook (m)
    ends: Vec3  # P_k there, packed along the first axis (m)


def moving(drive: str) -> bool:
    """Whether a drive mode moves the ends."""
    return drive != "cable"


def ends_along(drive: str, position: Vec3, anchors: Anchors) -> Vec3:
    """Ends P_k for load positions: packed along the first axis, the positions' shape behind.

    Args:
        drive: a `Drive`.
        position: the load's centre, any shape (m).
        anchors: load and ends at the start of the motion.

    Returns:
        In mode "cable" the ends as given, (K,); else (K, …). NaN where a base-driven cable is too
        short to reach up to its end's height; every limit check refuses that.
    """
    if not moving(drive):
        return anchors.ends
    step = position - anchors.position
    count = anchors.ends.x.shape[0]
    each = [component(anchors.ends, k) for k in range(count)]
    if drive == "end":
        found = [end + step for end in each]
    elif drive == "hybrid":
        level = Vec3(step.x, step.y, jnp.zeros_like(step.z)) * HYBRID_SHARE
        found = [end + level for end in each]
    else:
        found = [_rolled(position, anchors, k) for k in range(count)]
    return pack(found)


def _rolled(position: Vec3, anchors: Anchors, k: int) -> Vec3:
    """The end of a cable of fixed length and heading, at its fixed height."""
    end, lower = component(anchors.ends, k), attachment(anchors.attachments, k)
    cable = end - (anchors.position + lower)
    reach = norm(Vec3(cable.x, cable.y, jnp.zeros_like(cable.z)))
    per_reach = 1 / jnp.where(reach > 0, reach, 1)  # a cable straight up has no heading
    rise = end.z - (position.z + lower.z)
    square = norm(cable) ** 2 - rise**2
    out = jnp.where(square >= 0, safe_sqrt(jnp.where(square >= 0, square, 0)), jnp.nan)
    return Vec3(
        position.x + lower.x + out * (cable.x * per_reach),
        position.y + lower.y + out * (cable.y * per_reach),
        jnp.broadcast_to(end.z, out.shape),
    )


def bases_along(drive: str, ends: Vec3, anchors: Anchors, bases: Vec3) -> Vec3:
    """Bases O_k (m) that go with ends (K, …), of the ends' shape.

    They roll with the ends in mode "base" and stay otherwise.
    """
    shape = (-1,) + (1,) * (ends.x.ndim - 1)
    if drive != "base":
        return bases.each(lambda c: jnp.broadcast_to(c.reshape(shape), ends.x.shape))
    offset = (bases - anchors.ends).each(lambda c: c.reshape(shape))
    return Vec3(
        ends.x + offset.x,
        ends.y + offset.y,
        jnp.broadcast_to(bases.z.reshape(shape), ends.x.shape),
    )
