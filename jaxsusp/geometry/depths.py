"""How deep a straight segment, or a plane, is in a convex body: the tests of `segments` in metres.

A depth is positive where the test of the same name says that the two meet, and negative where they
are apart: the least of what every separating axis of the test tells, so that its gradient is the
direction of a way out, of the shortest where the body is no cylinder. Apart, it is no distance.
"""

import functools

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.geometry.segments import Corners, Faces, Grown, SweptTests
from jaxsusp.vec3 import Vec3, cross, dot, norm, safe_sqrt

_TINY = 1e-18  # m²; a shorter axis tells nothing, and its gradients are beyond float32
_HALVINGS = 24
_FAR = 1e6  # m; the depth along an axis that tells nothing


def segment_in_box(a: Vec3, b: Vec3, half: Vec3) -> Float[Array, "..."]:
    """Depth (m) of segment a-b in the axis-aligned box of half-extents `half` about the origin."""
    middle, reach = 0.5 * (a + b), 0.5 * (b - a)
    size = reach.abs()
    moment = cross(middle, reach).abs()
    return functools.reduce(
        jnp.minimum,
        [
            half.x + size.x - jnp.abs(middle.x),
            half.y + size.y - jnp.abs(middle.y),
            half.z + size.z - jnp.abs(middle.z),
            _per_length(half.y * size.z + half.z * size.y - moment.x, size.y**2 + size.z**2),
            _per_length(half.z * size.x + half.x * size.z - moment.y, size.z**2 + size.x**2),
            _per_length(half.x * size.y + half.y * size.x - moment.z, size.x**2 + size.y**2),
        ],
    )


def segment_in_cylinder(a: Vec3, b: Vec3, radius, half_height) -> Float[Array, "..."]:
    """Depth (m) of segment a-b in the vertical cylinder about the origin.

    The less of what the segment and the slab |z| <= half_height have in common in height, and of
    what the part inside the slab lacks from the radius: by that far a level move gets it out.
    """
    along = b - a
    vertical = half_height + 0.5 * jnp.abs(along.z) - jnp.abs(a.z + 0.5 * along.z)
    level = along.z**2 <= _TINY
    per_z = 1 / jnp.where(level, 1, along.z)
    bottom, top = (-half_height - a.z) * per_z, (half_height - a.z) * per_z
    enter = jnp.where(level, 0, jnp.clip(jnp.minimum(bottom, top), 0, 1))
    leave = jnp.where(level, 1, jnp.clip(jnp.maximum(bottom, top), 0, 1))
    plane = along.x**2 + along.y**2
    still = plane <= _TINY
    nearest = -(a.x * along.x + a.y * along.y) / jnp.where(still, 1, plane)
    t = jnp.minimum(jnp.maximum(jnp.where(still, 0, nearest), enter), leave)
    gap = safe_sqrt((a.x + t * along.x) ** 2 + (a.y + t * along.y) ** 2)
    return jnp.minimum(vertical, radius - gap)


def segment_in_sphere(a: Vec3, b: Vec3, radius) -> Float[Array, "..."]:
    """Depth (m) of segment a-b in the sphere about the origin."""
    along = b - a
    square = dot(along, along)
    still = square <= _TINY
    t = jnp.clip(jnp.where(still, 0, -dot(a, along) / jnp.where(still, 1, square)), 0, 1)
    return radius - norm(a + t * along)


def plane_in_box(normal: Vec3, point: Vec3, half: Vec3) -> Float[Array, "..."]:
    """Depth (m) of the plane through a point in the box about the origin."""
    common = dot(normal.abs(), half) - jnp.abs(dot(normal, point))
    return _per_length(common, dot(normal, normal))


def plane_in_cylinder(normal: Vec3, point: Vec3, radius, half_height) -> Float[Array, "..."]:
    """Depth (m) of the plane through a point in the vertical cylinder about the origin."""
    support = jnp.abs(normal.z) * half_height + radius * safe_sqrt(normal.x**2 + normal.y**2)
    return _per_length(support - jnp.abs(dot(normal, point)), dot(normal, normal))


def plane_in_sphere(normal: Vec3, point: Vec3, radius) -> Float[Array, "..."]:
    """Depth (m) of the plane through a point in the sphere about the origin."""
    square = dot(normal, normal)
    return radius + _per_length(-jnp.abs(dot(normal, point)), square)


def segment_in_faces(a: Vec3, b: Vec3, faces: Faces, grown: Grown) -> Float[Array, "..."]:
    """Depth (m) of segment a-b in the convex body within some planes.

    The depth of a point is its distance from the nearest plane; along the segment that is concave,
    and greatest at an end or where two planes change places, which halvings find. The planes that
    matter there give the depth itself, so that its gradient needs none of the others.
    """

    def rooms(normal: Vec3, offset: Array) -> tuple[Array, Array]:
        """Depths of both ends below a plane."""
        limit = offset + grown(normal)
        return limit - dot(normal, a), limit - dot(normal, b)

    every = jax.vmap(rooms)(faces.normal, faces.offset)
    one, other = jnp.broadcast_arrays(*map(jax.lax.stop_gradient, every))
    rising = other >= one

    def middle(_, span: tuple[Array, Array]) -> tuple[Array, Array]:
        low, high = span
        t = 0.5 * (low + high)
        nearest = (one + t[None] * (other - one)).argmin(axis=0)
        up = jnp.take_along_axis(rising, nearest[None], axis=0)[0]
        return jnp.where(up, t, low), jnp.where(up, high, t)

    none = jnp.zeros(one.shape[1:], one.dtype)
    low, high = jax.lax.fori_loop(0, _HALVINGS, middle, (none, none + 1))
    first = (one + low[None] * (other - one)).argmin(axis=0)
    last = (one + high[None] * (other - one)).argmin(axis=0)

    (p, q), (r, s) = (
        rooms(faces.normal.each(lambda c, at=at: c[at]), faces.offset[at]) for at in (first, last)
    )
    # Two lines over t: p + t (q - p) rises, r + t (s - r) falls; at an end one alone is there.
    steep = (q - p) - (s - r)
    crossing = steep > _TINY
    inside = crossing & (q >= p) & (s <= r)
    height = (p * (r - s) + r * (q - p)) / jnp.where(crossing, steep, 1)
    return jnp.where(inside, height, jnp.where(q >= p, jnp.minimum(q, s), jnp.minimum(p, r)))


def plane_in_corners(normal: Vec3, point: Vec3, corners: Corners, thin) -> Float[Array, "..."]:
    """Depth (m) of the plane through a point in the hull of corners, larger by `thin` per axis."""
    at = jax.vmap(lambda place: dot(normal, place - point))(corners.place)
    around = thin * (jnp.abs(normal.x) + jnp.abs(normal.y) + jnp.abs(normal.z))
    common = jnp.minimum(at.max(axis=0), -at.min(axis=0)) + around
    return _per_length(common, dot(normal, normal))


def _per_length(value: Array, square: Array) -> Array:
    """A value that is in proportion to the length of an axis, per that length."""
    short = square <= _TINY
    return jnp.where(short, _FAR, value / jnp.sqrt(jnp.where(short, 1, square)))


DEPTHS = SweptTests(
    segment_in_box,
    segment_in_cylinder,
    segment_in_sphere,
    segment_in_faces,
    plane_in_box,
    plane_in_cylinder,
    plane_in_sphere,
    plane_in_corners,
    jnp.minimum,
)
