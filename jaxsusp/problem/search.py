"""Search rules: the point that is evaluated and kept in place of a stray waypoint.

`box` leaves the workspace. `free-space` keeps every waypoint in the union of the free space's
polytopes, `ellipsoid` in that of their ellipsoids (the paper's rule): the region of least gauge g
is found, and a point with g > 1 is drawn towards that region's centre d, to d + (x - d) / g.
"""

import functools
import operator
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.vec3 import Vec3

_FAR = 1e15
"""Gauge of a region that only fills up; its square is a float32."""


class Polytopes(NamedTuple):
    """Polytopes {x : rows · x - offsets <= 1 in every row}; the gauge is the greatest row's."""

    table: Float[Array, "*stack regions rows 4"]  # rows (1/m), then offsets
    center: Vec3  # each (regions,), m

    @staticmethod
    def gauge(table: Float[Array, "rows 4"], point: Vec3) -> Array:
        """Gauge of points in one region: below 1 inside, 1 on the border."""
        return jnp.maximum(functools.reduce(jnp.maximum, _entries(table, point)), 0)


class Ellipsoids(NamedTuple):
    """Ellipsoids {x : ‖rows · x - offsets‖ <= 1}."""

    table: Float[Array, "*stack regions rows 4"]
    center: Vec3

    @staticmethod
    def gauge(table: Float[Array, "rows 4"], point: Vec3) -> Array:
        """Gauge of points in one region: below 1 inside, 1 on the border."""
        squares = [entry**2 for entry in _entries(table, point)]
        return jnp.sqrt(functools.reduce(operator.add, squares))


Regions = Polytopes | Ellipsoids


def _entries(table: Array, point: Vec3) -> list[Array]:
    return [
        table[i, 0] * point.x + table[i, 1] * point.y + table[i, 2] * point.z - table[i, 3]
        for i in range(table.shape[0])
    ]


def regions_of(space: FreeSpace, search: str) -> Regions | None:
    """What a search rule keeps waypoints in, as float64 host arrays; None for `box`."""
    if search == "box":
        return None
    if search == "ellipsoid":
        kind, rows = Ellipsoids, np.linalg.inv(space.C)
    else:
        room = space.b - np.einsum("rhi,ri->rh", space.A, space.d)
        kind, rows = Polytopes, space.A / room[..., None]
    offsets = np.einsum("rhi,ri->rh", rows, space.d)
    return kind(np.concatenate([rows, offsets[..., None]], axis=-1), Vec3(*space.d.T))


def pad_regions(regions: Regions, count: int, rows: int) -> Regions:
    """The same regions with further ones that no point is near to, so that scenarios stack.

    They come last, and `keep_inside` spends no time on them.
    """
    there, faces, _ = regions.table.shape
    table = np.pad(regions.table, [(0, count - there), (0, rows - faces), (0, 0)])
    table[there:, 0, 3] = -_FAR
    return type(regions)(table, regions.center.each(lambda c: np.pad(c, (0, count - there))))


def keep_inside(regions: Regions, point: Vec3) -> Vec3:
    """Points of any shape, each drawn into the region of least gauge if it lies in none (m).

    The loop over the regions carries one array, so that XLA computes every gauge once: gauges
    are not negative and therefore order like the integers of the same bits, whose lowest few make
    way for the region's number. What a gauge loses by that, at most one part in 2¹⁵ in float32
    with up to 256 regions, a
    point is drawn in further (a third of a millimetre in a region of several metres).
    """
    dtype, count = point.x.dtype, regions.table.shape[0]
    whole = jnp.int64 if dtype == jnp.float64 else jnp.int32
    low = (1 << max(8, (count - 1).bit_length())) - 1  # the bits that hold a number

    tables = jnp.asarray(regions.table)
    there = (tables[:, 0, 3] > -_FAR / 2).sum(dtype=jnp.int32)

    def visit(number, least: Array) -> Array:
        bits = jax.lax.bitcast_convert_type(regions.gauge(tables[number], point), whole)
        return jnp.minimum(least, (bits & ~low) | number.astype(whole))

    start = jnp.full(point.x.shape, jnp.iinfo(whole).max, whole)
    least = jax.lax.fori_loop(0, there, visit, start)
    gauge = jax.lax.bitcast_convert_type(least & ~low, dtype)
    center = regions.center.each(lambda c: c[least & low])
    lost = (low + 1) * jnp.finfo(dtype).eps  # of the gauge, relative
    outside = gauge > 1 - lost
    scale = (1 - 3 * lost) / jnp.where(outside, gauge, 1)  # so that a drawn point then stays
    drawn = center + (point - center) * scale
    return Vec3(*(jnp.where(outside, d, own) for d, own in zip(drawn, point, strict=True)))
