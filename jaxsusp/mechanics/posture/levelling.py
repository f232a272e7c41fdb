"""Ends that keep a load with separate attachments level, wherever the load is.

Where the ends may move, the cable *forces* are free, and the grasp map has rank 6: of all forces
that balance a level load at rest we take those nearest to the ones along the cables of the drive
mode's plain rule, f = f₀ + G⁺ (F - G f₀), so that the internal part of the plain rule is kept. The
ends go to P_k = B_k + l_k f_k/‖f_k‖ with the lengths the rule gave them.
"""

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.posture.graspmap import grasp_map
from jaxsusp.mechanics.posture.load import Load, Pose
from jaxsusp.vec3 import Vec3, cross, dot, norm


def level_ends(
    lower: list[Vec3], vectors: list[Vec3], tensions: list[Array], load: Load
) -> list[Vec3]:
    """Ends P_k (m) of three cables that balance a level load, forces and moments.

    Elementwise over load positions; closed form, since for a level load G⁺ does not depend on
    where it is.

    Args:
        lower: attachments B_k in the world, any shape (m).
        vectors: from there to the ends of the plain rule (m).
        tensions: T_k (N) that balance the forces along these.
        load: mass, centre of mass and attachments.
    """
    share = _shares(load)
    lengths = [norm(vector) for vector in vectors]
    pulls = [
        vector * (tension / length)
        for vector, tension, length in zip(vectors, tensions, lengths, strict=True)
    ]
    arms = load.attachments - load.center_of_mass[None]
    missing = Vec3(*(jnp.zeros_like(pulls[0].x),) * 3)
    for arm, pull in zip(arms, pulls, strict=True):
        missing = missing - cross(Vec3.from_array(arm), pull)
    found = []
    for k, (at, pull, length) in enumerate(zip(lower, pulls, lengths, strict=True)):
        rows = (Vec3.from_array(share[k, i]) for i in range(3))
        force = pull + Vec3(*(dot(row, missing) for row in rows))
        found.append(at + force * (length / norm(force)))
    return found


def _shares(load: Load) -> Float[Array, "cables xyz 3"]:
    """Force on each attachment per moment, the columns of G⁺ that belong to moments (1/m)."""
    dtype = load.attachments.dtype
    level = Pose(jnp.zeros(3, dtype), jnp.eye(3, dtype=dtype))
    matrix = grasp_map(level, load)
    inverse = jnp.linalg.solve(matrix @ matrix.T, matrix).T  # (3K, 6)
    return inverse[:, 3:].reshape(-1, 3, 3)
