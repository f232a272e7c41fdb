"""The suspended load as statics sees it, at any pose (Sect. 2.2).

A pose is the position of the payload frame's origin and a rotation R from that frame to the
world. Nothing here assumes that the load hangs level, that gravity points along -z, or that the
centre of mass is the origin. Functions are written for one pose; callers `vmap`.
"""

from typing import NamedTuple

import jax.numpy as jnp

from jaxsusp._types import Array, Float


class Load(NamedTuple):
    """A rigid load, its attachments and the field it hangs in (SI units)."""

    mass: Float[Array, "*batch"]
    gravity: Float[Array, "*batch xyz"]  # world frame, m/s², (0, 0, -9.81) at home
    center_of_mass: Float[Array, "*batch xyz"]  # payload frame, m
    attachments: Float[Array, "*batch cables xyz"]  # B'_k in the payload frame, m; K rows

    @property
    def weight(self) -> Array:
        """M ‖g‖, the natural unit of force (N)."""
        return self.mass * jnp.linalg.norm(self.gravity)

    @property
    def radius(self) -> Array:
        """Largest distance of an attachment from the centre of mass, the unit of length (m)."""
        return jnp.linalg.norm(self.attachments - self.center_of_mass[None], axis=-1).max()


class Pose(NamedTuple):
    """Where the load is: position of its origin (m) and rotation R."""

    position: Float[Array, "*batch xyz"]
    posture: Float[Array, "*batch xyz 3"]

    def moved(self, shift: Float[Array, "xyz"], turn: Float[Array, "xyz"]) -> "Pose":
        """The pose after a shift (m) and a rotation about the origin by the vector `turn` (rad).

        Cayley's form of the rotation is exact to second order in `turn`, a rotation for any of
        them, and differentiable at zero, which a square root of turn·turn is not.
        """
        wedge = skew(turn)
        small = jnp.eye(3, dtype=turn.dtype) + (wedge + wedge @ wedge / 2) * (4 / (4 + turn @ turn))
        return Pose(self.position + shift, small @ self.posture)


def skew(v: Float[Array, "xyz"]) -> Float[Array, "xyz 3"]:
    """The matrix [v]× with [v]× w = v × w."""
    zero = jnp.zeros_like(v[0])
    return jnp.stack(
        [
            jnp.stack([zero, -v[2], v[1]]),
            jnp.stack([v[2], zero, -v[0]]),
            jnp.stack([-v[1], v[0], zero]),
        ]
    )


def lower_ends(pose: Pose, load: Load) -> Float[Array, "cables xyz"]:
    """Attachments B_k in the world (m)."""
    return pose.position[None] + load.attachments @ pose.posture.T


def arms_of(pose: Pose, load: Load) -> Float[Array, "cables xyz"]:
    """Attachments from the centre of mass, in world directions (m)."""
    return (load.attachments - load.center_of_mass[None]) @ pose.posture.T


def cables_at(
    pose: Pose, load: Load, ends: Float[Array, "cables xyz"]
) -> tuple[Float[Array, "cables xyz"], Float[Array, "cables"]]:
    """Unit vectors u_k from attachment to end, and lengths l_k (m) (Eq. 2, 3)."""
    vectors = ends - lower_ends(pose, load)
    lengths = jnp.linalg.norm(vectors, axis=-1)
    return vectors / lengths[:, None], lengths


def rotation(angles: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """R = Rz(α3) Ry(α2) Rx(α1), payload frame to world frame (Sect. 2.2), angles in rad."""
    (c1, c2, c3), (s1, s2, s3) = jnp.cos(angles), jnp.sin(angles)
    return jnp.stack(
        [
            jnp.stack([c2 * c3, s1 * s2 * c3 - s3 * c1, s2 * c1 * c3 + s1 * s3]),
            jnp.stack([s3 * c2, s1 * s2 * s3 + c1 * c3, s2 * s3 * c1 - s1 * c3]),
            jnp.stack([-s2, s1 * c2, c1 * c2]),
        ]
    )


def angles(posture: Float[Array, "xyz 3"]) -> Float[Array, "3"]:
    """(α1, α2, α3) of R = Rz(α3) Ry(α2) Rx(α1), rad; α1 and α3 are not unique at |α2| = 90°."""
    return jnp.stack(
        [
            jnp.arctan2(posture[2, 1], posture[2, 2]),
            jnp.arcsin(jnp.clip(-posture[2, 0], -1, 1)),
            jnp.arctan2(posture[1, 0], posture[0, 0]),
        ]
    )


def tilt(posture: Float[Array, "xyz 3"]) -> Float[Array, ""]:
    """Angle between the load's axis and the vertical (rad)."""
    return jnp.arctan2(jnp.hypot(posture[0, 2], posture[1, 2]), posture[2, 2])
