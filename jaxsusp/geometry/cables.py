"""Cables: straight, massless segments from payload to robot ends (Eq. 2, 3)."""

from jaxsusp._types import Array, Float
from jaxsusp.vec3 import Vec3, component, norm


def attachment(attachments: Vec3, k: int) -> Vec3:
    """B'_k: a single packed attachment is a hook and serves every cable."""
    return component(attachments, 0 if attachments.x.shape[0] == 1 else k)


def cable_vectors(position: Vec3, attachments: Vec3, ends: Vec3) -> list[Vec3]:
    """L_k = P_k - B_k of a level payload, one vector per cable (Eq. 2).

    Args:
        position: payload centre H, any shape (m).
        attachments: B'_k packed along the first axis, one entry for a hook or K (m).
        ends: P_k packed along the first axis (m).

    Returns:
        K vectors of the shape of `position`, from attachment to end (m).
    """
    return [
        component(ends, k) - (position + attachment(attachments, k)) for k in range(ends.x.shape[0])
    ]


def cable_lengths(vectors: list[Vec3]) -> list[Float[Array, "..."]]:
    """l_k = ‖L_k‖ (Eq. 3), m."""
    return [norm(vector) for vector in vectors]
