"""Does a straight segment, or a plane, meet a convex body?  Closed forms, elementwise.

Each test is exact for a closed body: touching counts. A NaN coordinate never separates, so it is
reported as a hit by the box test; the fitness catches NaN by other means and never relies on this.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.vec3 import Vec3, component, cross, dot, safe_sqrt

_TINY = 1e-30  # replaces an exact zero divisor: the quotient is then huge, never NaN


class Faces(NamedTuple):
    """Planes around a convex body, {p : normal · p <= offset} (m).

    Padded with normals of zero and offsets above it, which cut nothing.
    """

    normal: Vec3
    offset: Float[Array, "faces"]
    number: Int[Array, ""]  # those that are there


class Corners(NamedTuple):
    """Corners of a convex body, padded with one of them (m)."""

    place: Vec3
    number: Int[Array, ""]


Grown = Callable[[Vec3], Array]
"""How far a body grows in the direction of a unit normal (m)."""


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


def plane_meets_box(normal: Vec3, point: Vec3, half: Vec3) -> Bool[Array, "..."]:
    """The plane through a point against the box about the origin; a zero normal meets anything."""
    return jnp.abs(dot(normal, point)) <= dot(normal.abs(), half)


def plane_meets_cylinder(normal: Vec3, point: Vec3, radius, half_height) -> Bool[Array, "..."]:
    """The plane through a point against the vertical cylinder about the origin."""
    beyond_caps = jnp.abs(dot(normal, point)) - jnp.abs(normal.z) * half_height
    beside = beyond_caps**2 <= (normal.x**2 + normal.y**2) * radius**2
    return (beyond_caps <= 0) | beside


def plane_meets_sphere(normal: Vec3, point: Vec3, radius) -> Bool[Array, "..."]:
    """The plane through a point against the sphere about the origin."""
    return dot(normal, point) ** 2 <= dot(normal, normal) * radius**2


def segment_meets_faces(a: Vec3, b: Vec3, faces: Faces, grown: Grown) -> Bool[Array, "..."]:
    """Segment a-b against the convex body within some planes (Cyrus and Beck, 1978).

    Every plane cuts off what of the segment is in front of it; they meet where something is left.

    Args:
        a: one end, in the frame of the planes.
        b: the other end.
        faces: the planes.
        grown: by how much each is to be moved out, by its normal.
    """
    shape = jnp.broadcast_shapes(a.x.shape, b.x.shape, jnp.shape(grown(component(faces.normal, 0))))
    none, all_ = (jnp.full(shape, value, faces.offset.dtype) for value in (0.0, 1.0))

    def cut(i, span: tuple[Array, Array]) -> tuple[Array, Array]:
        enter, leave = span
        normal = component(faces.normal, i)
        limit = faces.offset[i] + grown(normal)
        before, after = dot(normal, a) - limit, dot(normal, b) - limit
        falls = before - after
        t = before / jnp.where(falls == 0, _TINY, falls)
        inwards = falls >= 0
        return (
            jnp.where(inwards, jnp.maximum(enter, t), enter),
            jnp.where(inwards, leave, jnp.minimum(leave, t)),
        )

    enter, leave = jax.lax.fori_loop(0, faces.number, cut, (none, all_))
    return ~(enter > leave)


def plane_meets_corners(normal: Vec3, point: Vec3, corners: Corners, thin) -> Bool[Array, "..."]:
    """The plane through a point against the convex hull of corners, larger by `thin` per axis."""
    low, high = span_of_corners(normal, point, corners)
    around = thin * (jnp.abs(normal.x) + jnp.abs(normal.y) + jnp.abs(normal.z))
    return (low <= around) & (high >= -around)


def span_of_corners(normal: Vec3, point: Vec3, corners: Corners) -> tuple[Array, Array]:
    """Least and greatest normal · (corner - point)."""
    first = dot(normal, component(corners.place, 0) - point)

    def wider(i, span: tuple[Array, Array]) -> tuple[Array, Array]:
        at = dot(normal, component(corners.place, i) - point)
        return jnp.minimum(span[0], at), jnp.maximum(span[1], at)

    return jax.lax.fori_loop(1, corners.number, wider, (first, first))


class SweptTests(NamedTuple):
    """How segments and planes are held against bodies: whether they meet, or how deep."""

    box: Callable[..., Array]
    cylinder: Callable[..., Array]
    sphere: Callable[..., Array]
    faces: Callable[..., Array]
    plane_box: Callable[..., Array]
    plane_cylinder: Callable[..., Array]
    plane_sphere: Callable[..., Array]
    plane_corners: Callable[..., Array]
    both: Callable[[Array, Array], Array]


MEETS = SweptTests(
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_sphere,
    segment_meets_faces,
    plane_meets_box,
    plane_meets_cylinder,
    plane_meets_sphere,
    plane_meets_corners,
    jnp.logical_and,
)


def segment_distance(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> Float[Array, "..."]:
    """Distance (m) between the segments a-b and c-d."""
    return safe_sqrt(segment_distance_squared(a, b, c, d))


def segment_distance_squared(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> Float[Array, "..."]:
    """Square of the distance (m²) between the segments a-b and c-d.

    The closest points of the two lines, brought back into the segments one after the other
    (Ericson, Real-Time Collision Detection, 5.1.9). Parallel segments start from the point a.
    """
    one, two, gap = b - a, d - c, a - c
    aa, bb, ab = dot(one, one), dot(two, two), dot(one, two)
    ag, bg = dot(one, gap), dot(two, gap)
    aa, bb = jnp.maximum(aa, _TINY), jnp.maximum(bb, _TINY)
    square = aa * bb - ab * ab
    skew = square > 1e-9 * aa * bb
    s = jnp.clip(jnp.where(skew, (ab * bg - ag * bb) / jnp.where(skew, square, 1), 0), 0, 1)
    t = jnp.clip((ab * s + bg) / bb, 0, 1)
    s = jnp.clip((ab * t - ag) / aa, 0, 1)
    t = jnp.clip((ab * s + bg) / bb, 0, 1)
    closest = gap + s * one - t * two
    return dot(closest, closest)
