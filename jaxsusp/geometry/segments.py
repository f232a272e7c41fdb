"""Does a straight segment meet a convex body?  Closed forms, elementwise over any shape (spec §5).

Each test is exact for a closed body: touching counts. A NaN coordinate never separates, so it is
reported as a hit by the box test; the fitness catches NaN by other means and never relies on this.
"""

import jax.numpy as jnp

from jaxsusp._types import Array, Bool
from jaxsusp.vec3 import Vec3, cross, dot

_TINY = 1e-30  # replaces an exact zero divisor: the quotient is then huge, never NaN


def segment_meets_box(a: Vec3, b: Vec3, half: Vec3) -> Bool[Array, "..."]:
    """Segment a-b against the axis-aligned box of half-extents `half` about the origin.

    Separating axes: the three box axes and their cross products with the segment; no division.
    """
    middle, reach = 0.5 * (a + b), 0.5 * (b - a)
    size = reach.abs()
    moment = cross(middle, reach).abs()
    return (
        (jnp.abs(middle.x) <= half.x + size.x)
        & (jnp.abs(middle.y) <= half.y + size.y)
        & (jnp.abs(middle.z) <= half.z + size.z)
        & (moment.x <= half.y * size.z + half.z * size.y)
        & (moment.y <= half.z * size.x + half.x * size.z)
        & (moment.z <= half.x * size.y + half.y * size.x)
    )


def segment_meets_cylinder(a: Vec3, b: Vec3, radius, half_height) -> Bool[Array, "..."]:
    """Segment a-b against the vertical cylinder about the origin.

    The part of the segment inside the slab |z| <= half_height, if any, must come within `radius`
    of the axis.
    """
    along = b - a
    level = along.z == 0
    per_z = 1 / jnp.where(level, _TINY, along.z)
    bottom, top = (-half_height - a.z) * per_z, (half_height - a.z) * per_z
    enter = jnp.maximum(jnp.minimum(bottom, top), 0)
    inside = jnp.logical_and(level, jnp.abs(a.z) <= half_height)  # all of it, caps included
    leave = jnp.where(inside, 1, jnp.minimum(jnp.maximum(bottom, top), 1))
    plane = along.x**2 + along.y**2
    nearest = -(a.x * along.x + a.y * along.y) / jnp.where(plane == 0, _TINY, plane)
    t = jnp.minimum(jnp.maximum(nearest, enter), leave)
    gap = (a.x + t * along.x) ** 2 + (a.y + t * along.y) ** 2
    return (enter <= leave) & (gap <= radius**2)


def segment_meets_sphere(a: Vec3, b: Vec3, radius) -> Bool[Array, "..."]:
    """Segment a-b against the sphere about the origin, by its closest point."""
    along = b - a
    square = dot(along, along)
    t = jnp.clip(-dot(a, along) / jnp.where(square == 0, _TINY, square), 0, 1)
    closest = a + t * along
    return dot(closest, closest) <= radius**2
