"""Balance of a load at any pose: the structure matrix and the wrench it supplies (Eq. 5, 6)."""

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.posture.load import Load, Pose, arms_of, cables_at
from jaxsusp.mechanics.statics import GRAVITY


def structure_matrix(
    pose: Pose, load: Load, ends: Float[Array, "cables xyz"]
) -> Float[Array, "6 cables"]:
    """Structure matrix J about the centre of mass, columns (u_k ; R(B'_k - c) × u_k) (Eq. 5)."""
    units, _ = cables_at(pose, load, ends)
    arms = arms_of(pose, load)
    return jnp.concatenate([units, jnp.cross(arms, units)], axis=-1).T


def needed_wrench(pose: Pose, load: Load) -> Float[Array, "6"]:
    """Force (N) and moment about the centre of mass (N m) the cables must supply at rest.

    With an acceleration a of the centre of mass the same holds for the apparent gravity g - a.
    """
    force = -load.mass * load.gravity
    return jnp.concatenate([force, jnp.zeros_like(force)])


def imbalance(
    pose: Pose, tensions: Float[Array, "cables"], load: Load, ends: Float[Array, "cables xyz"]
) -> Float[Array, "6"]:
    """ρ = J T - F: what the cables supply too much, force (N) and moment (N m)."""
    return structure_matrix(pose, load, ends) @ tensions - needed_wrench(pose, load)


def relative(wrench: Float[Array, "6"], load: Load) -> Float[Array, "6"]:
    """A wrench in units of the weight and of the weight times the largest attachment radius.

    Only so may forces and moments be mixed in one norm. A load hung by its centre of mass has no
    radius and no moments; its unit of length is 1 m.
    """
    length = jnp.where(load.radius > 0, load.radius, 1)
    unit = load.weight * jnp.stack([jnp.ones_like(length)] * 3 + [length] * 3)
    return wrench / unit


def wrench(
    mass: Float[Array, ""],
    inertia: Float[Array, "3"],
    acceleration: Float[Array, "3"],
    angular_acceleration: Float[Array, "3"],
    gravity: float | Float[Array, "3"] = GRAVITY,
) -> Float[Array, "6"]:
    """F = (m ẍ, m ÿ, m z̈ + m g ; I α̈) that the cables must supply (Eq. 6), N and N m.

    The inertia is per axis: the printed I_x α̈₂ equals I_y α̈₂ for an upright cylinder.
    Gravity is its magnitude if it points downwards, else the vector, such as (0, 0, -9.81).
    """
    vector = jnp.asarray(gravity, acceleration.dtype)
    weight = -vector if vector.ndim else jnp.zeros_like(acceleration).at[2].set(vector)
    return jnp.concatenate([mass * (acceleration + weight), inertia * angular_acceleration])
