"""Towing robots: a vertical column a1 and two links a2, a3 (Eq. 1).

Angles are radians and lengths metres; the base frame is parallel to the world frame.
"""

from typing import NamedTuple

import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Float
from jaxsusp.vec3 import Vec3, safe_sqrt


class InverseSolution(NamedTuple):
    """Both elbow branches of one end position."""

    elbow_up: Float[Array, "*batch joints"]
    elbow_down: Float[Array, "*batch joints"]
    reachable: Bool[Array, "*batch"]


def forward(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    joints: Float[Array, "*#batch joints"],
) -> Float[Array, "*batch xyz"]:
    """End position P_k of a robot by the D-H chain (Eq. 1), placed at its base.

    Args:
        base: O_k in the world frame (m).
        links: (a1, a2, a3) (m).
        joints: (φ1, φ2, φ3) (rad); φ2 is measured from the vertical, φ3 from the first link.

    Returns:
        P_k in the world frame (m).
    """
    base, links, joints = jnp.broadcast_arrays(base, links, joints)
    a1, a2, a3 = _split(links)
    phi1, phi2, phi3 = _split(joints)
    radial = a2 * jnp.sin(phi2) + a3 * jnp.sin(phi2 + phi3)
    vertical = a1 + a2 * jnp.cos(phi2) + a3 * jnp.cos(phi2 + phi3)
    return base + jnp.stack([radial * jnp.cos(phi1), radial * jnp.sin(phi1), vertical], axis=-1)


def elbow(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    joints: Float[Array, "*#batch joints"],
) -> Float[Array, "*batch xyz"]:
    """Position of the joint between the two links (m), for drawing and clearance checks."""
    a1, a2, _ = _split(links)
    return forward(base, jnp.stack([a1, a2, 0 * a2], axis=-1), joints)


def chain(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    joints: Float[Array, "*#batch joints"],
) -> Float[Array, "*batch points=4 xyz"]:
    """Foot, shoulder, elbow and end of a robot (m): the axes of column and links in between."""
    base, links, joints = jnp.broadcast_arrays(base, links, joints)
    shoulder = base.at[..., 2].add(links[..., 0])
    points = base, shoulder, elbow(base, links, joints), forward(base, links, joints)
    return jnp.stack(points, axis=-2)


def inverse(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    end: Float[Array, "*#batch xyz"],
) -> InverseSolution:
    """Joint angles of an end position, closed form, both elbow branches.

    φ1 from atan2; (φ2, φ3) from the two-link triangle with its shoulder at height a1. The
    horizontal reach is taken non-negative: the mirror poses φ1 + π are not enumerated. Above the
    base axis φ1 is 0 by convention. An unreachable end gives the stretched (or folded) arm that
    points at it, flagged by `reachable`.

    Args:
        base: O_k in the world frame (m).
        links: (a1, a2, a3) (m), a2, a3 > 0.
        end: P_k in the world frame (m).

    Returns:
        `InverseSolution`: (φ1, φ2, φ3) per branch (rad) and whether the end is in reach.
    """
    base, links, end = jnp.broadcast_arrays(base, links, end)
    a1, a2, a3 = _split(links)
    x, y, z = _split(end - base)
    radial, vertical = jnp.hypot(x, y), z - a1
    phi1 = jnp.arctan2(y, x)
    square = radial**2 + vertical**2
    bend = jnp.arccos(jnp.clip((square - a2**2 - a3**2) / (2 * a2 * a3), -1, 1))
    direction = jnp.arctan2(radial, vertical)  # of the end seen from the shoulder, from vertical

    def branch(phi3):
        offset = jnp.arctan2(a3 * jnp.sin(phi3), a2 + a3 * jnp.cos(phi3))
        return jnp.stack([phi1, direction - offset, phi3], axis=-1)

    return InverseSolution(branch(bend), branch(-bend), reachable(base, links, end))


class Bent(NamedTuple):
    """An arm that holds its end, with its elbow on one side; of any shape (m)."""

    elbow: Vec3
    end: Vec3  # where it was asked for, if that is in reach


def bent(shoulder: Vec3, upper: Array, lower: Array, end: Vec3) -> tuple[Bent, Bent]:
    """Where the arms of `inverse` are, elbow up, then down, component by component.

    Without the angles themselves: in the upright plane through the shoulder and the end, directions
    turn by products of sines and cosines, which cost a tenth of what angles do.

    Args:
        shoulder: top of the column (m).
        upper: a2 (m), broadcastable to the components.
        lower: a3 (m).
        end: P_k (m).
    """
    away = end - shoulder
    radial = safe_sqrt(away.x**2 + away.y**2)
    square = radial**2 + away.z**2
    cos1, sin1 = _unit(away.x, away.y, radial)
    cos_end, sin_end = _unit(away.z, radial, safe_sqrt(square))  # φ from the vertical
    cos3 = jnp.clip((square - upper**2 - lower**2) / (2 * upper * lower), -1, 1)
    sin3 = safe_sqrt(1 - cos3**2)
    straight, across = upper + lower * cos3, lower * sin3
    cos_off, sin_off = _unit(straight, across, safe_sqrt(straight**2 + across**2))

    def branch(side: int) -> Bent:  # 1: elbow up
        sin2 = sin_end * cos_off - side * cos_end * sin_off
        cos2 = cos_end * cos_off + side * sin_end * sin_off
        sin23 = sin2 * cos3 + side * cos2 * sin3
        cos23 = cos2 * cos3 - side * sin2 * sin3
        elbow = shoulder + Vec3(sin2 * cos1, sin2 * sin1, cos2) * upper
        return Bent(elbow, elbow + Vec3(sin23 * cos1, sin23 * sin1, cos23) * lower)

    return branch(1), branch(-1)


def _unit(x: Array, y: Array, length: Array) -> tuple[Array, Array]:
    """(x, y) over its length; (1, 0) where that is nothing, as atan2 has it."""
    nothing = length == 0
    length = jnp.where(nothing, 1, length)
    return jnp.where(nothing, 1, x / length), y / length


def reachable(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    end: Float[Array, "*#batch xyz"],
) -> Bool[Array, "*batch"]:
    """Whether the end lies between |a2 - a3| and a2 + a3 from the shoulder."""
    base, links, end = jnp.broadcast_arrays(base, links, end)
    distance = shoulder_distance(base, links, end)
    nearest, farthest = reach(links)
    return (distance >= nearest) & (distance <= farthest)


def shoulder_distance(
    base: Float[Array, "*#batch xyz"],
    links: Float[Array, "*#batch joints"],
    end: Float[Array, "*#batch xyz"],
) -> Float[Array, "*batch"]:
    """Distance (m) of the end from the shoulder, the top of the column."""
    base, links, end = jnp.broadcast_arrays(base, links, end)
    x, y, z = _split(end - base)
    return jnp.sqrt(x**2 + y**2 + (z - links[..., 0]) ** 2)


def reach(
    links: Float[Array, "*batch joints"],
) -> tuple[Float[Array, "*batch"], Float[Array, "*batch"]]:
    """Least and greatest distance (m) from the shoulder at which the arm can hold its end."""
    _, a2, a3 = _split(links)
    return jnp.abs(a2 - a3), a2 + a3


def _split(rows):
    return rows[..., 0], rows[..., 1], rows[..., 2]
