"""More than three separate attachments with fixed ends: the equilibrium nearest to a posture.

Position and K > 3 cables leave more unknowns (three angles, K tensions) than the six balance
equations. We look for tensions within their limits, and turn the load only as far as the balance
asks for: at every posture the tensions are the bounded least squares, and a Gauss-Newton step of
least norm turns the load against the residual that they cannot remove (variable projection).
Where no posture balances within the limits, the least residual found is reported.
"""

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.posture.equilibrium import (
    CONVERGED,
    NOT_CONVERGED,
    NOT_FINITE,
    TOLERANCE,
    Equilibrium,
)
from jaxsusp.mechanics.posture.load import Load, Pose, cables_at
from jaxsusp.mechanics.posture.pseudoinverse import bounded_least_squares
from jaxsusp.mechanics.posture.structure import imbalance, relative, structure_matrix

_STEPS = 15
_SHORTENINGS = 5
_POLISHING = 3
_LARGEST_TURN = 0.3  # rad per step
_RANK = 1e-6  # what is smaller than this share of the largest singular value is no direction


def hang_within(
    position: Float[Array, "xyz"],
    posture: Float[Array, "xyz 3"],
    load: Load,
    ends: Float[Array, "cables xyz"],
    low: Array,
    high: Array,
) -> Equilibrium:
    """Position → (posture, tensions) of K > 3 cables within T_lo <= T <= T_hi (N).

    Args:
        position: of the payload frame's origin (m).
        posture: R to start from and to stay close to, for example level.
        load: with K attachments.
        ends: P_k (m).
        low: T_lo (N).
        high: T_hi (N).
    """
    dtype = position.dtype
    still = jnp.zeros(3, dtype)
    shares = jnp.asarray(0.5, dtype) ** jnp.arange(_SHORTENINGS, dtype=dtype)

    def tensions_of(pose: Pose) -> Array:
        return bounded_least_squares(pose, load, ends, low, high).tensions

    def residual(pose: Pose, tensions: Array) -> Array:
        return relative(imbalance(pose, tensions, load, ends), load)

    def size(pose: Pose) -> Array:
        rest = residual(pose, tensions_of(pose))
        return rest @ rest

    def step(pose: Pose, _) -> tuple[Pose, None]:
        tensions = tensions_of(pose)
        rest = residual(pose, tensions)
        slope = jax.jacfwd(lambda turn: residual(pose.moved(still, turn), tensions))(still)
        inside = (tensions > low) & (tensions < high)
        free = jnp.where(inside[None], _scaled_structure(pose, load, ends), 0)
        beyond = jnp.eye(6, dtype=dtype) - free @ jnp.linalg.pinv(free, rtol=_RANK)
        turn = -jnp.linalg.pinv(beyond @ slope, rtol=_RANK) @ (beyond @ rest)
        length = jnp.linalg.norm(turn)
        turn = turn * jnp.minimum(1, _LARGEST_TURN / jnp.where(length > 0, length, 1))
        turn = jnp.where(jnp.isfinite(turn).all() & (rest @ rest > TOLERANCE**2), turn, still)
        sizes = jax.vmap(lambda share: size(pose.moved(still, share * turn)))(shares)
        best = jnp.argmin(sizes)
        better = sizes[best] < rest @ rest
        return pose.moved(still, jnp.where(better, shares[best], 0) * turn), None

    pose, _ = jax.lax.scan(step, Pose(position, posture), length=_STEPS)
    pose, tensions = _polish(pose, tensions_of(pose), residual, low, high)
    rest = imbalance(pose, tensions, load, ends)
    error = jnp.abs(relative(rest, load)).max()
    tolerance = TOLERANCE if dtype == jnp.float64 else TOLERANCE**0.5
    good = jnp.where(error <= tolerance, CONVERGED, NOT_CONVERGED)
    return Equilibrium(
        pose,
        tensions,
        cables_at(pose, load, ends)[1],
        jnp.linalg.norm(rest[:3]),
        jnp.linalg.norm(rest[3:]),
        jnp.where(jnp.isfinite(error), good, NOT_FINITE),
    )


def _polish(pose: Pose, tensions: Array, residual, low: Array, high: Array) -> tuple[Pose, Array]:
    """Least-norm Newton steps of posture and free tensions: balance to rounding if it is near."""
    still = jnp.zeros(3, tensions.dtype)
    free = ((tensions > low) & (tensions < high)).astype(tensions.dtype)
    unit = (high - low) / 2

    def step(point: tuple[Pose, Array], _) -> tuple[tuple[Pose, Array], None]:
        pose, tensions = point

        def moved(change: Array) -> Array:
            return residual(pose.moved(still, change[:3]), tensions + unit * free * change[3:])

        slope = jax.jacfwd(moved)(jnp.zeros(3 + len(tensions), tensions.dtype))
        rest = residual(pose, tensions)
        change = -jnp.linalg.pinv(slope, rtol=_RANK) @ rest
        after = moved(change)
        moves = tensions + unit * free * change[3:]
        allowed = ((moves >= low) & (moves <= high)).all()
        better = (after @ after < rest @ rest) & allowed
        change = jnp.where(better, change, 0)
        return (pose.moved(still, change[:3]), tensions + unit * free * change[3:]), None

    return jax.lax.scan(step, (pose, tensions), length=_POLISHING)[0]


def _scaled_structure(pose: Pose, load: Load, ends: Array) -> Array:
    columns = jax.vmap(lambda column: relative(column, load), in_axes=1, out_axes=1)
    return columns(structure_matrix(pose, load, ends))
