"""Obstacles as arrays, packed per kind so that scenarios of different contents stack.

Every kind is padded to a fixed count; `active` is False for the padding, which never counts and
follows what is there. What looks at bodies in turn (`over_bodies`) spends no time on it, so that
programs for many obstacles serve few as well. Each kind tells which segments meet its bodies,
inflated by a margin, exactly but for an inflated corner; segments and bodies broadcast.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.geometry.segments import (
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_sphere,
)
from jaxsusp.vec3 import Vec3


class Boxes(NamedTuple):
    """Upright boxes turned about the vertical axis (m)."""

    center: Vec3
    half: Vec3
    cos_yaw: Float[Array, "*stack boxes"]
    sin_yaw: Float[Array, "*stack boxes"]
    active: Bool[Array, "*stack boxes"]

    def to_own_frame(self, point: Vec3) -> Vec3:
        """World position → this box's frame, origin at its centre."""
        return self.turn(point - self.center)

    def turn(self, vector: Vec3) -> Vec3:
        """World direction → this box's frame."""
        return vector.rotate_z(self.cos_yaw, -self.sin_yaw)

    def met_by(self, a: Vec3, b: Vec3, margin: Array) -> Bool[Array, "..."]:
        """Which segments a-b come within a margin (m)."""
        half = self.half + Vec3(margin, margin, margin)
        return self.active & segment_meets_box(self.to_own_frame(a), self.to_own_frame(b), half)


class Cylinders(NamedTuple):
    """Vertical cylinders (m)."""

    center: Vec3
    radius: Float[Array, "*stack cylinders"]
    half_height: Float[Array, "*stack cylinders"]
    active: Bool[Array, "*stack cylinders"]

    def met_by(self, a: Vec3, b: Vec3, margin: Array) -> Bool[Array, "..."]:
        """Which segments a-b come within a margin (m)."""
        size = self.radius + margin, self.half_height + margin
        return self.active & segment_meets_cylinder(a - self.center, b - self.center, *size)


class Spheres(NamedTuple):
    """Spheres (m)."""

    center: Vec3
    radius: Float[Array, "*stack spheres"]
    active: Bool[Array, "*stack spheres"]

    def met_by(self, a: Vec3, b: Vec3, margin: Array) -> Bool[Array, "..."]:
        """Which segments a-b come within a margin (m)."""
        radius = self.radius + margin
        return self.active & segment_meets_sphere(a - self.center, b - self.center, radius)


class Obstacles(NamedTuple):
    """All obstacles of a scenario."""

    boxes: Boxes
    cylinders: Cylinders
    spheres: Spheres

    @property
    def counts(self) -> tuple[int, ...]:
        """Padded number of every kind (per scenario where stacked)."""
        return tuple(kind.active.shape[-1] for kind in self)


KINDS = Obstacles._fields
"""Kinds of packed obstacles, in the order of everything that is counted or given per kind."""


_Carry = TypeVar("_Carry")


def over_bodies(visit: Callable[[_Carry, Any], _Carry], kind: Any, carry: _Carry) -> _Carry:
    """What `visit(carry, body)` leaves after every body of a kind that is there, in order.

    The number of trips is an argument of the compiled program: neither its size nor its time
    depends on the padding.
    """
    packed = jax.tree.map(jnp.asarray, kind)
    if packed.active.size == 0:
        return carry

    def trip(i, carry: _Carry) -> _Carry:
        return visit(carry, jax.tree.map(lambda leaf: leaf[i], packed))

    return jax.lax.fori_loop(0, packed.active.sum(dtype=jnp.int32), trip, carry)


def pack(
    boxes: np.ndarray, cylinders: np.ndarray, spheres: np.ndarray, counts: Sequence[int]
) -> Obstacles:
    """Pack obstacles given one per row into float64 host arrays, padded to `counts`.

    Args:
        boxes: rows (x, y, z, half x, half y, half z, yaw), m and rad.
        cylinders: rows (x, y, z, radius, half-height), m.
        spheres: rows (x, y, z, radius), m.
        counts: padded number of each of `KINDS`, at least the number of rows.
    """
    box, box_active = _padded(boxes, 7, counts[0])
    cylinder, cylinder_active = _padded(cylinders, 5, counts[1])
    sphere, sphere_active = _padded(spheres, 4, counts[2])
    return Obstacles(
        Boxes(Vec3(*box[:3]), Vec3(*box[3:6]), np.cos(box[6]), np.sin(box[6]), box_active),
        Cylinders(Vec3(*cylinder[:3]), cylinder[3], cylinder[4], cylinder_active),
        Spheres(Vec3(*sphere[:3]), sphere[3], sphere_active),
    )


def _padded(rows: np.ndarray, columns: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    rows = np.asarray(rows, np.float64).reshape(-1, columns)
    if len(rows) > count:
        raise ValueError(f"{len(rows)} obstacles do not fit into {count} places")
    padded = np.zeros((count, columns))
    padded[: len(rows)] = rows
    return padded.T.copy(), np.arange(count) < len(rows)
