"""Fixed ends, any number of cables, a given posture: least squares with its residual (spec §3).

With J 6×K there is in general no T that balances a given pose. Moments are scaled by the largest
attachment radius before anything mixes them with forces. What is left over is reported.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.load import Load, Pose, imbalance, needed_wrench, relative, structure

_STEPS = 40
_SHORTENINGS = 12
_RIDGE = 1e-9
"""Weight of the distance from the middle of the range beside the balance: it decides between
tensions that balance equally well."""


class Supplied(NamedTuple):
    """Tensions at a pose and the wrench they fail to supply."""

    tensions: Float[Array, "*batch cables"]  # N
    force: Float[Array, "*batch"]  # ‖ρ_force‖, N
    moment: Float[Array, "*batch"]  # ‖ρ_moment‖ about the centre of mass, N m


def least_squares(pose: Pose, load: Load, ends: Float[Array, "cables xyz"]) -> Supplied:
    """T = (JᵀJ)⁻¹ Jᵀ F without any limits, J and F with scaled moments (spec §3, §12 on Eq. 7).

    For cables that are not independent the shortest such T.
    """
    matrix, needed = _scaled(pose, load, ends)
    return _describe(jnp.linalg.lstsq(matrix, needed)[0], pose, load, ends)


def bounded_least_squares(
    pose: Pose, load: Load, ends: Float[Array, "cables xyz"], low: Array, high: Array
) -> Supplied:
    """The tensions within [T_lo, T_hi] of least residual; of several, the nearest to mid-range."""
    matrix, needed = _scaled(pose, load, ends)
    return _describe(nearest_in_range(matrix, needed, low, high), pose, load, ends)


def nearest_in_range(
    matrix: Float[Array, "rows cables"], needed: Float[Array, "rows"], low: Array, high: Array
) -> Float[Array, "cables"]:
    """Minimise ‖A T - b‖² + ε ‖(T - T_mid)/half‖² over T_lo <= T <= T_hi.

    Projected Newton (Bertsekas): tensions that a limit stops are held, the others take a Newton
    step that is clipped and shortened until it helps.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    scaled = matrix * half  # unknowns in [-1, 1]
    goal = needed - matrix.sum(axis=1) * middle
    # Normal equations would square the condition; the ridge keeps them far from singular.
    size = jnp.abs(scaled).max() ** 2
    count = matrix.shape[1]
    hessian = scaled.T @ scaled + _RIDGE * size * jnp.eye(count, dtype=matrix.dtype)
    slope = scaled.T @ goal
    shares = jnp.asarray(0.5, matrix.dtype) ** jnp.arange(_SHORTENINGS, dtype=matrix.dtype)

    def cost(t: Array) -> Array:
        return 0.5 * t @ hessian @ t - slope @ t

    def step(t: Array, _) -> tuple[Array, None]:
        gradient = hessian @ t - slope
        held = ((t <= -1) & (gradient > 0)) | ((t >= 1) & (gradient < 0))
        both_free = ~held[:, None] & ~held[None, :]
        block = jnp.where(both_free, hessian, jnp.eye(count, dtype=matrix.dtype))
        newton = -jnp.linalg.solve(block, jnp.where(held, 0, gradient))
        tried = jnp.clip(t + shares[:, None] * newton, -1, 1)
        costs = jax.vmap(cost)(tried)
        best = jnp.argmin(costs)
        return jnp.where(costs[best] < cost(t), tried[best], t), None

    start = jnp.clip(jnp.linalg.solve(hessian, slope), -1, 1)
    return middle + half * jax.lax.scan(step, start, length=_STEPS)[0]


def _scaled(pose: Pose, load: Load, ends: Array) -> tuple[Array, Array]:
    """J and F with rows in units of the weight and of the weight times the radius."""
    columns = jax.vmap(lambda column: relative(column, load), in_axes=1, out_axes=1)
    return columns(structure(pose, load, ends)), relative(needed_wrench(pose, load), load)


def _describe(tensions: Array, pose: Pose, load: Load, ends: Array) -> Supplied:
    rest = imbalance(pose, tensions, load, ends)
    return Supplied(tensions, jnp.linalg.norm(rest[:3]), jnp.linalg.norm(rest[3:]))
