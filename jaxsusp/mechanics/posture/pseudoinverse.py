"""Fixed ends, any number of cables, a given posture: least squares with its residual.

With J 6×K there is in general no T that balances a given pose. Moments are scaled by the largest
attachment radius before anything mixes them with forces. What is left over is reported.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.mechanics.posture.load import Load, Pose
from jaxsusp.mechanics.posture.structure import imbalance, needed_wrench, relative, structure_matrix

_RIDGE = 1e-9
"""Weight of the distance from the middle of the range beside the balance: it decides between
tensions that balance equally well."""


class Supplied(NamedTuple):
    """Tensions at a pose and the wrench they fail to supply."""

    tensions: Float[Array, "*batch cables"]  # N
    force: Float[Array, "*batch"]  # ‖ρ_force‖, N
    moment: Float[Array, "*batch"]  # ‖ρ_moment‖ about the centre of mass, N m


def least_squares_tensions(pose: Pose, load: Load, ends: Float[Array, "cables xyz"]) -> Supplied:
    """T = (JᵀJ)⁻¹ Jᵀ F without any limits, J and F with scaled moments.

    It stands in for Eq. 7: of the paper's J, 3×6, the printed Jᵀ(JJᵀ)⁻¹ cannot multiply F.
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

    The active-set method for bounded least squares: go towards the minimum over the tensions that
    no limit holds, stop at the first limit on the way and hold that tension; at such a minimum
    release the held tension that gains most. The cost never rises, and a fixed number of steps,
    several times K, is far more than it takes.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    scaled = matrix * half  # unknowns in [-1, 1]
    goal = needed - matrix.sum(axis=1) * middle
    count, dtype = matrix.shape[1], matrix.dtype
    ridge = _RIDGE * jnp.abs(scaled).max() ** 2
    hessian = scaled.T @ scaled + ridge * jnp.eye(count, dtype=dtype)
    slope = scaled.T @ goal
    index = jnp.arange(count)

    def step(state: tuple[Array, Array], _) -> tuple[tuple[Array, Array], None]:
        t, free = state
        block = jnp.where(free[:, None] & free[None, :], hessian, jnp.eye(count, dtype=dtype))
        way = -jnp.linalg.solve(block, jnp.where(free, hessian @ t - slope, 0))
        limit = jnp.where(way > 0, 1.0, -1.0).astype(dtype)
        room = jnp.where(way == 0, jnp.inf, (limit - t) / jnp.where(way == 0, 1, way))
        first = jnp.argmin(room)
        blocked = room[first] < 1
        t = t + jnp.where(blocked, room[first], 1) * way
        stop = blocked & (index == first)
        t = jnp.where(stop, limit, jnp.clip(t, -1, 1))
        gradient = hessian @ t - slope
        gain = jnp.where(free, 0, jnp.where(t > 0, gradient, -gradient))
        best = jnp.argmax(gain)
        release = ~blocked & (gain[best] > ridge * jnp.finfo(dtype).eps ** 0.5) & (index == best)
        return (t, (free & ~stop) | release), None

    start = jnp.zeros(count, dtype), jnp.ones(count, bool)
    (t, _), _ = jax.lax.scan(step, start, length=4 * count + 8)
    return middle + half * t


def _scaled(pose: Pose, load: Load, ends: Array) -> tuple[Array, Array]:
    """J and F with rows in units of the weight and of the weight times the radius."""
    columns = jax.vmap(lambda column: relative(column, load), in_axes=1, out_axes=1)
    return columns(structure_matrix(pose, load, ends)), relative(needed_wrench(pose, load), load)


def _describe(tensions: Array, pose: Pose, load: Load, ends: Array) -> Supplied:
    rest = imbalance(pose, tensions, load, ends)
    return Supplied(tensions, jnp.linalg.norm(rest[:3]), jnp.linalg.norm(rest[3:]))
