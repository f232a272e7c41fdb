"""Is an equilibrium stable?  Second-order test on the poses that the taut cables allow.

At an equilibrium the potential energy U = -m g·(centre of mass) is stationary on the set of poses
with unchanged cable lengths, and the tensions are its multipliers: ∇(U + Σ T_k l_k) = 0. It is
stable iff the Hessian of U + Σ T_k l_k is positive definite on the null space of the lengths'
Jacobian. At a stationary point that Hessian does not depend on how rotations are parametrised.
"""

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Float
from jaxsusp.mechanics.posture.load import Load, Pose, cables_at


def energy(pose: Pose, load: Load) -> Float[Array, ""]:
    """Potential energy -m g·(p + R c) (J), zero with the centre of mass at the world's origin."""
    return -load.mass * (load.gravity @ (pose.position + pose.posture @ load.center_of_mass))


def stiffness(
    pose: Pose,
    tensions: Float[Array, "cables"],
    load: Load,
    ends: Float[Array, "cables xyz"],
    hook: bool = False,
) -> Float[Array, "modes"]:
    """Eigenvalues (N/m, ascending) of the reduced Hessian at an equilibrium.

    Rotations are measured by the way of an attachment, radius times angle, so that all
    eigenvalues have one unit; their signs do not depend on that.

    Args:
        pose: an equilibrium.
        tensions: T_k (N) there.
        load: the load; all its attachments are one point if `hook`.
        ends: P_k (m).
        hook: the cables meet in one point: their lengths fix that point, and turning about the
            vertical through it is a mode without stiffness, which is removed first.

    Returns:
        3 modes for three separate attachments, 6 - K for up to five, none for six or more
        (taut cables then fix the pose), 2 for a hook.
    """
    length = jnp.where(load.radius > 0, load.radius, 1)

    def moved(step: Array) -> Pose:
        return pose.moved(step[:3], step[3:] / length)

    def lagrangian(step: Array) -> Array:
        there = moved(step)
        return energy(there, load) + tensions @ cables_at(there, load, ends)[1]

    still = jnp.zeros(6, tensions.dtype)
    slopes = jax.jacfwd(lambda step: cables_at(moved(step), load, ends)[1])(still)
    fixed = 3 if hook else min(len(ends), 6)
    free = jnp.linalg.svd(slopes)[2][fixed:].T  # (6, modes)
    if hook:
        free = free @ _without(free.T @ _yaw(pose, load, length))
    return jnp.linalg.eigvalsh(free.T @ jax.hessian(lagrangian)(still) @ free)


def is_stable(eigenvalues: Float[Array, "*batch modes"]) -> Bool[Array, "*batch"]:
    """Whether all modes are stiff; true without any mode."""
    return jnp.all(eigenvalues > 0, axis=-1)


def _yaw(pose: Pose, load: Load, length: Array) -> Float[Array, "6"]:
    """Turning about the direction of gravity through the hook, as a step."""
    axis = load.gravity / jnp.linalg.norm(load.gravity)
    hook = pose.posture @ load.attachments[0]
    return jnp.concatenate([-jnp.cross(axis, hook), axis * length])


def _without(direction: Float[Array, "modes"]) -> Float[Array, "modes others"]:
    """Orthonormal basis of what is perpendicular to a direction."""
    return jnp.linalg.qr(direction[:, None], mode="complete")[0][:, 1:]
