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
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.geometry.segments import (
    Corners,
    Faces,
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_faces,
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


class Hulls(NamedTuple):
    """Convex bodies turned about the vertical axis (m), by all their faces and corners.

    Faces are those of the body, and those that it gets where it grows by an upright box
    (`Polytope.grown`).
    """

    center: Vec3
    cos_yaw: Float[Array, "*stack hulls"]
    sin_yaw: Float[Array, "*stack hulls"]
    normal: Vec3  # components (*stack, hulls, faces)
    offset: Float[Array, "*stack hulls faces"]
    face: Bool[Array, "*stack hulls faces"]  # which are there, the first ones
    corner: Vec3  # components (*stack, hulls, corners)
    cornered: Bool[Array, "*stack hulls corners"]
    active: Bool[Array, "*stack hulls"]

    to_own_frame, turn = Boxes.to_own_frame, Boxes.turn

    @property
    def faces(self) -> Faces:
        """The planes of one body."""
        return Faces(self.normal, self.offset, self.face.sum(dtype=jnp.int32))

    @property
    def corners(self) -> Corners:
        """The corners of one body."""
        return Corners(self.corner, self.cornered.sum(dtype=jnp.int32))

    def met_by(self, a: Vec3, b: Vec3, margin: Array) -> Bool[Array, "..."]:
        """Which segments a-b come within a margin (m) of one body."""
        a, b = self.to_own_frame(a), self.to_own_frame(b)
        return self.active & segment_meets_faces(a, b, self.faces, lambda normal: margin)


class Obstacles(NamedTuple):
    """All obstacles of a scenario."""

    boxes: Boxes
    cylinders: Cylinders
    spheres: Spheres
    hulls: Hulls | None = None  # None: programs without any know nothing of them

    @property
    def counts(self) -> tuple[int, ...]:
        """Padded number of every kind (per scenario where stacked), as `pack` takes them."""
        hulls = self.hulls
        many = () if hulls is None else (*hulls.face.shape[-2:], hulls.cornered.shape[-1])
        return (*(kind.active.shape[-1] for kind in self[:3]), *many)


KINDS = Obstacles._fields
"""Kinds of packed obstacles, in the order of everything that is counted or given per kind."""


_Carry = TypeVar("_Carry")


def over_bodies(visit: Callable[[_Carry, Any], _Carry], kind: Any, carry: _Carry) -> _Carry:
    """What `visit(carry, body)` leaves after every body of a kind that is there, in order.

    The number of trips is an argument of the compiled program: neither its size nor its time
    depends on the padding.
    """
    if kind is None or kind.active.size == 0:
        return carry
    packed = jax.tree.map(jnp.asarray, kind)

    def trip(i, carry: _Carry) -> _Carry:
        return visit(carry, jax.tree.map(lambda leaf: leaf[i], packed))

    return jax.lax.fori_loop(0, packed.active.sum(dtype=jnp.int32), trip, carry)


class Placed(NamedTuple):
    """A convex body where it stands: centre (m), yaw (rad), and its shape about the centre."""

    center: Sequence[float]
    yaw: float
    body: Polytope


def hull_counts(hulls: Sequence[Placed]) -> tuple[int, ...]:
    """Numbers of hulls, of faces and of corners that hold them; empty without any."""
    if not hulls:
        return ()
    faces = max(len(each.body.grown) for each in hulls)
    return len(hulls), faces, max(len(each.body.corners) for each in hulls)


def pack(
    boxes: np.ndarray,
    cylinders: np.ndarray,
    spheres: np.ndarray,
    counts: Sequence[int],
    hulls: Sequence[Placed] = (),
) -> Obstacles:
    """Pack obstacles given one per row into float64 host arrays, padded to `counts`.

    Args:
        boxes: rows (x, y, z, half x, half y, half z, yaw), m and rad.
        cylinders: rows (x, y, z, radius, half-height), m.
        spheres: rows (x, y, z, radius), m.
        counts: padded number of each of the first three of `KINDS`, at least the number of rows;
            behind them, where there may be hulls, those of `hull_counts`.
        hulls: convex bodies.
    """
    box, box_active = _padded(boxes, 7, counts[0])
    cylinder, cylinder_active = _padded(cylinders, 5, counts[1])
    sphere, sphere_active = _padded(spheres, 4, counts[2])
    return Obstacles(
        Boxes(Vec3(*box[:3]), Vec3(*box[3:6]), np.cos(box[6]), np.sin(box[6]), box_active),
        Cylinders(Vec3(*cylinder[:3]), cylinder[3], cylinder[4], cylinder_active),
        Spheres(Vec3(*sphere[:3]), sphere[3], sphere_active),
        pack_hulls(hulls, tuple(counts[3:6]) or hull_counts(hulls)),
    )


def pack_hulls(hulls: Sequence[Placed], counts: Sequence[int]) -> Hulls | None:
    """Convex bodies packed and padded to `hull_counts`; None where there is no place for any."""
    if not counts or not counts[0]:
        return None
    count, faces, corners = counts
    rows = np.array([[*each.center, each.yaw] for each in hulls])
    place, active = _padded(rows, 4, count)
    normal, offset = np.zeros((count, faces, 3)), np.ones((count, faces))
    face, corner = np.zeros((count, faces), bool), np.zeros((count, corners, 3))
    cornered = np.zeros((count, corners), bool)
    for i, each in enumerate(hulls):
        body = each.body
        n, m = len(body.grown), len(body.corners)
        normal[i, :n], offset[i, :n], face[i, :n] = body.grown, body.support(body.grown), True
        corner[i], cornered[i, :m] = body.corners[0], True
        corner[i, :m] = body.corners
    return Hulls(
        Vec3(*place[:3]), np.cos(place[3]), np.sin(place[3]),
        _of_rows(normal), offset, face, _of_rows(corner), cornered, active,
    )  # fmt: skip


def _of_rows(rows: np.ndarray) -> Vec3:
    return Vec3(*np.moveaxis(rows, -1, 0).copy())


def _padded(rows: np.ndarray, columns: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    rows = np.asarray(rows, np.float64).reshape(-1, columns)
    if len(rows) > count:
        raise ValueError(f"{len(rows)} obstacles do not fit into {count} places")
    padded = np.zeros((count, columns))
    padded[: len(rows)] = rows
    return padded.T.copy(), np.arange(count) < len(rows)
