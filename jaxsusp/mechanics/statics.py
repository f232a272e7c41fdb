"""Force balance of the suspended payload: J T = F with T >= 0 (Eq. 4-6)."""

import jax.numpy as jnp

from jaxsusp._types import Array
from jaxsusp.mechanics.tensiondistribution import distribute
from jaxsusp.vec3 import Vec3, cross, dot

GRAVITY = 9.81
"""m/s², downwards."""


def weight(mass: Array) -> Vec3:
    """Net force (0, 0, m g) that holds a payload at rest (N)."""
    nothing = jnp.zeros_like(mass)
    return Vec3(nothing, nothing, mass * GRAVITY)


def force_tensions(
    vectors: list[Vec3], lengths: list[Array], force: Vec3, limits: tuple[Array, Array]
) -> list[Array]:
    """Tensions of K >= 3 cables that balance a force, whatever moments they make.

    At a hook there are no others. At separate attachments these are the tensions of a level load
    whose moments are left to a small turn: within 3 % of the equilibrium's where that is within
    10° of level, where the least squares of forces and moments together are off by up to 30 %.

    Args:
        vectors: L_k from attachment to end (m), any shape.
        lengths: l_k = ‖L_k‖ (m).
        force: net force the cables supply (N).
        limits: T_lo, T_hi (N), which more than three cables are kept within where possible.

    Returns:
        T_k (N).
    """
    if len(vectors) == 3:
        return hook_tensions(vectors, lengths, force)
    units = [vector * (1 / length) for vector, length in zip(vectors, lengths, strict=True)]
    shape = jnp.broadcast_shapes(*(unit.x.shape for unit in units))
    pull = force.each(lambda c: jnp.broadcast_to(c, shape))
    return distribute(units, pull, *limits)


def hook_tensions(vectors: list[Vec3], lengths: list[Array], force: Vec3) -> list[Array]:
    """Tensions of three cables that meet at one hook, in closed form (Eq. 4).

    Cramer's rule on [u_1 u_2 u_3] T = F by cross products. Coplanar cables give a division by
    zero: the result is then infinite or NaN and every limit check refuses it.

    Args:
        vectors: L_k from hook to end (m), three of them, any shape.
        lengths: l_k = ‖L_k‖ (m).
        force: net force the cables supply (N), e.g. (0, 0, m g) at rest.

    Returns:
        T_k (N), negative where a cable would have to push.
    """
    a, b, c = vectors
    facets = cross(b, c), cross(c, a), cross(a, b)
    per_volume = 1 / dot(a, facets[0])
    return [
        length * dot(force, facet) * per_volume
        for length, facet in zip(lengths, facets, strict=True)
    ]
