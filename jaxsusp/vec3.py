"""Three-dimensional vectors as three separate arrays.

XLA's CPU code for arrays of shape (..., 3) is several times slower than the same arithmetic on
separate x, y and z arrays, and the formulas read better without index juggling. All operations
are elementwise, so x, y and z may have any mutually broadcastable shapes.

Several vectors, such as the ends of K cables, are *packed* along the first axis (K, …), where the
last axes are free for samples and candidates. People and files have them as *rows* (…, K, 3).
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from jaxsusp._types import Array, Float


class Vec3(NamedTuple):
    """A vector field: x, y and z of equal (or broadcastable) shape."""

    x: Array
    y: Array
    z: Array

    @classmethod
    def from_array(cls, array: Float[Array, "*batch xyz"]) -> "Vec3":
        """Split the last axis of length 3."""
        return cls(array[..., 0], array[..., 1], array[..., 2])

    def to_array(self) -> Float[Array, "*batch xyz"]:
        """Join x, y and z along a new last axis."""
        return jnp.stack(jnp.broadcast_arrays(*self), axis=-1)

    def __add__(self, other: "Vec3") -> "Vec3":  # type: ignore[override]
        return Vec3(self.x + other.x, self.y + other.y, self.z + other.z)

    def __sub__(self, other: "Vec3") -> "Vec3":
        return Vec3(self.x - other.x, self.y - other.y, self.z - other.z)

    def __mul__(self, scale) -> "Vec3":  # type: ignore[override]
        return Vec3(self.x * scale, self.y * scale, self.z * scale)

    def __rmul__(self, scale) -> "Vec3":  # type: ignore[override]
        return self * scale

    def __neg__(self) -> "Vec3":
        return Vec3(-self.x, -self.y, -self.z)

    def each(self, function) -> "Vec3":
        """Apply one function to every component."""
        return Vec3(function(self.x), function(self.y), function(self.z))

    def abs(self) -> "Vec3":
        """Componentwise magnitude."""
        return self.each(jnp.abs)

    def rotate_z(self, cos, sin) -> "Vec3":
        """Rotate about the vertical axis by the angle with the given cosine and sine."""
        return Vec3(cos * self.x - sin * self.y, sin * self.x + cos * self.y, self.z)


def dot(a: Vec3, b: Vec3) -> Array:
    """Scalar product."""
    return a.x * b.x + a.y * b.y + a.z * b.z


def cross(a: Vec3, b: Vec3) -> Vec3:
    """Vector product."""
    return Vec3(
        a.y * b.z - a.z * b.y,
        a.z * b.x - a.x * b.z,
        a.x * b.y - a.y * b.x,
    )


def safe_sqrt(square: Array) -> Array:
    """Square root with value and gradient zero at zero (NaN stays NaN)."""
    zero = square == 0
    return jnp.where(zero, 0, jnp.sqrt(jnp.where(zero, 1, square)))


def norm(a: Vec3) -> Array:
    """Euclidean length; its gradient at the zero vector is zero, not NaN."""
    return safe_sqrt(dot(a, a))


def angle(a: Vec3, b: Vec3) -> Array:
    """Angle (rad) between unit vectors, 2 atan2(‖b - a‖, ‖b + a‖).

    Accurate for the smallest angles, where an arccos of a float32 dot product is not, and smooth
    where the two are opposed.
    """
    return 2 * _arctan_of_ratio(norm(b - a), norm(b + a))


def _arctan_of_ratio(y: Array, x: Array) -> Array:
    """`arctan2` of what is not negative, in [0, π/2].

    XLA has a CPU call the C library for every `arctan2`, which took a seventh of the time of a
    search; single precision is within reach of a polynomial, which is vectorised.
    """
    if y.dtype != jnp.float32:
        return jnp.arctan2(y, x)
    greater = jnp.maximum(x, y)
    ratio = jnp.minimum(x, y) / jnp.where(greater == 0, 1, greater)
    found = ratio * jnp.polyval(jnp.asarray(_ARCTAN, y.dtype), ratio * ratio)
    return jnp.where(y > x, jnp.asarray(np.pi / 2, y.dtype) - found, found)


_ARCTAN = (
    Chebyshev.interpolate(lambda t: np.arctan(np.sqrt(t)) / np.sqrt(t), 9, domain=[0, 1])
    .convert(kind=Polynomial)
    .coef[::-1]
)
"""arctan(r) / r as a polynomial of r² on [0, 1], highest power first, within 1e-8."""


def component(packed: Vec3, k: int | Array) -> Vec3:
    """The k-th of several packed vectors."""
    return packed.each(lambda c: c[k])


def pack(vectors: Sequence[Vec3]) -> Vec3:
    """Several vectors of one shape, packed."""
    x, y, z = (jnp.stack(columns) for columns in zip(*vectors, strict=True))
    return Vec3(x, y, z)


def pack_rows(rows: Float[Array, "*batch count xyz"]) -> Vec3:
    """Vectors given as rows, packed: components (count, *batch)."""
    return Vec3.from_array(jnp.moveaxis(rows, -2, 0))


def rows_of(packed: Vec3) -> Float[Array, "*batch count xyz"]:
    """Packed vectors as rows."""
    return jnp.moveaxis(packed.to_array(), 0, -2)
