"""Movable ends: cable forces with the internal forces that balance leaves open.

Where the ends may go anywhere, the unknowns are the cable *forces* f_k = T_k u_k, and the grasp
map G (6×3K) from them to the wrench is linear. Its rank is 6 for separate attachments that are
not on a line, so any pose balances with 3K - 6 internal forces; 5 on a line; 3 at a hook, where
3K - 3 remain. With K free lengths that makes 4K - 6 freedoms (the paper's 15 - 9 for K = 3).
The ends lie at P_k = B_k + l_k f_k/‖f_k‖. This is where Eq. 7's null space lives.
"""

import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.posture.load import Load, Pose, arms_of, lower_ends, skew
from jaxsusp.mechanics.posture.structure import needed_wrench


def grasp_map(pose: Pose, load: Load) -> Float[Array, "6 forces"]:
    """G with G (f_1, …, f_K) = wrench about the centre of mass (dimensionless; m)."""
    arms = arms_of(pose, load)
    blocks = [jnp.concatenate([jnp.eye(3, dtype=arms.dtype), skew(arm)]) for arm in arms]
    return jnp.concatenate(blocks, axis=1)


def rank(attachments: np.ndarray) -> int:
    """Rank of the grasp map: 6 for separate attachments, 5 if they are on a line, 3 at a hook."""
    spread = np.asarray(attachments, np.float64) - np.mean(attachments, axis=0)
    size = np.abs(attachments).max() or 1.0
    return (3, 5, 6)[min(2, np.linalg.matrix_rank(spread, tol=1e-9 * size))]


def nearest_forces(
    wished: Float[Array, "cables xyz"], pose: Pose, load: Load
) -> Float[Array, "cables xyz"]:
    """The cable forces nearest to the wished ones that balance the load: f = f₀ + G⁺(F - G f₀).

    The internal part of the wish, N Nᵀ f₀, is kept as it is. Moments that a hook or collinear
    attachments cannot supply stay unbalanced.
    """
    matrix = grasp_map(pose, load)
    flat = wished.reshape(-1)
    missing = needed_wrench(pose, load) - matrix @ flat
    # Moments in units of the radius, so that the rank is decided by geometry alone.
    length = jnp.where(load.radius > 0, load.radius, 1)
    unit = jnp.stack([jnp.ones_like(length)] * 3 + [length] * 3)
    step = jnp.linalg.lstsq(matrix / unit[:, None], missing / unit, rcond=1e-6)[0]
    return (flat + step).reshape(wished.shape)


def internal_forces(pose: Pose, load: Load, rank: int) -> Float[Array, "forces internal"]:
    """Orthonormal basis N of the cable forces that leave the load's balance as it is: G N = 0.

    Args:
        pose: of the load.
        load: attachments and centre of mass.
        rank: of the grasp map: 6, 5 with attachments on a line, 3 at a hook.

    Returns:
        3K - rank columns, each K forces in a row (dimensionless).
    """
    return jnp.linalg.svd(grasp_map(pose, load))[2][rank:].T


def ends_of_forces(
    forces: Float[Array, "cables xyz"],
    lengths: Float[Array, "cables"],
    pose: Pose,
    load: Load,
) -> tuple[Float[Array, "cables xyz"], Float[Array, "cables"]]:
    """Ends P_k = B_k + l_k f_k/‖f_k‖ (m) and tensions ‖f_k‖ (N)."""
    tensions = jnp.linalg.norm(forces, axis=-1)
    return lower_ends(pose, load) + forces * (lengths / tensions)[:, None], tensions
