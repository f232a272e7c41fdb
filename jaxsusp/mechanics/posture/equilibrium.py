"""Equilibria of a load on cables with separate attachments and fixed ends.

With three cables J is 6×3 and a given pose balances only by accident: the load turns until it
does. `hang` finds the posture (and tensions) at a given position, `settle` the whole pose at
given cable lengths. Both are Newton's method with a fixed number of steps, each shortened until
it helps, for one load; callers `vmap`. Bad numerics end in a result code, never in an exception.

Equilibria are not unique (a load can hang upside down): the one near the starting guess is found.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float, Int
from jaxsusp.mechanics.posture.load import Load, Pose, cables_at
from jaxsusp.mechanics.posture.structure import imbalance, needed_wrench, relative

CONVERGED, NOT_CONVERGED, NOT_FINITE = 0, 1, 2
"""Result codes: balanced, best found but not balanced, no numbers at all."""

STEPS = 30
TOLERANCE = 1e-10
"""Of the relative residual in float64; in float32 its square root."""
_LARGEST_TURN = 0.3  # rad per step: Newton's model of a rotation is good for no more
_SHORTENINGS = 8


class Equilibrium(NamedTuple):
    """A pose, the tensions that hold it, and how well they do."""

    pose: Pose
    tensions: Float[Array, "*batch cables"]  # N
    lengths: Float[Array, "*batch cables"]  # m
    force: Float[Array, "*batch"]  # ‖ρ_force‖, N
    moment: Float[Array, "*batch"]  # ‖ρ_moment‖, N m
    code: Int[Array, "*batch"]


class _Point(NamedTuple):
    """What Newton's method moves."""

    pose: Pose
    tensions: Array


def hang(
    position: Float[Array, "xyz"],
    posture: Float[Array, "xyz 3"],
    load: Load,
    ends: Float[Array, "cables xyz"],
) -> Equilibrium:
    """Position → (posture, tensions) of three cables: six balance equations, six unknowns.

    Args:
        position: of the payload frame's origin (m).
        posture: R to start from, for example level.
        load: with three attachments.
        ends: P_k (m).

    Returns:
        The equilibrium; tensions may be negative, the caller checks limits.
    """
    weight = load.weight

    def move(point: _Point, step: Array) -> _Point:
        pose = point.pose.moved(jnp.zeros_like(step[:3]), step[:3])
        return _Point(pose, point.tensions + weight * step[3:])

    def residual(point: _Point) -> Array:
        return relative(imbalance(point.pose, point.tensions, load, ends), load)

    start = Pose(position, posture)
    point = _Point(start, level_guess(start, load, ends))
    found, error = _newton(residual, move, point, 3 + len(ends), slice(0, 3))
    return _describe(found, load, ends, error)


def settle(
    lengths: Float[Array, "cables"],
    guess: Pose,
    load: Load,
    ends: Float[Array, "cables xyz"],
) -> Equilibrium:
    """Lengths → (pose, tensions): K length equations and six of balance, for 6 + K unknowns.

    Args:
        lengths: l_k (m), of three to six taut cables.
        guess: pose to start from.
        load: the load.
        ends: P_k (m).

    Returns:
        The equilibrium; a negative tension means that a cable would hang slack.
    """
    weight = load.weight

    def move(point: _Point, step: Array) -> _Point:
        return _Point(point.pose.moved(step[:3], step[3:6]), point.tensions + weight * step[6:])

    def residual(point: _Point) -> Array:
        balance = relative(imbalance(point.pose, point.tensions, load, ends), load)
        too_long = cables_at(point.pose, load, ends)[1] - lengths
        return jnp.concatenate([balance, too_long])

    point = _Point(guess, level_guess(guess, load, ends))
    found, error = _newton(residual, move, point, 6 + len(ends), slice(3, 6))
    return _describe(found, load, ends, error)


def level_guess(pose: Pose, load: Load, ends: Float[Array, "cables xyz"]) -> Array:
    """Tensions to start from: least squares of the forces alone (N)."""
    units, _ = cables_at(pose, load, ends)
    return jnp.linalg.lstsq(units.T, needed_wrench(pose, load)[:3])[0]


def _newton(
    residual: Callable[[_Point], Array],
    move: Callable[[_Point, Array], _Point],
    start: _Point,
    freedoms: int,
    turns: slice,
) -> tuple[_Point, Array]:
    """A fixed number of Newton steps; returns the last point and its largest residual."""
    dtype = start.tensions.dtype
    nothing = jnp.zeros(freedoms, dtype)
    shares = jnp.asarray(0.5, dtype) ** jnp.arange(_SHORTENINGS, dtype=dtype)

    def step(point: _Point, _) -> tuple[_Point, None]:
        missing = residual(point)
        slope = jax.jacfwd(lambda d: residual(move(point, d)))(nothing)
        newton = -jnp.linalg.solve(slope, missing)
        turn = jnp.linalg.norm(newton[turns])
        newton = newton * jnp.minimum(1, _LARGEST_TURN / jnp.where(turn > 0, turn, 1))
        newton = jnp.where(jnp.isfinite(newton).all(), newton, nothing)
        size = jax.vmap(lambda share: _size(residual(move(point, share * newton))))(shares)
        best = jnp.argmin(size)
        better = size[best] < _size(missing)
        return move(point, jnp.where(better, shares[best], 0) * newton), None

    point, _ = jax.lax.scan(step, start, length=STEPS)
    return point, jnp.abs(residual(point)).max()


def _size(residual: Array) -> Array:
    """Squared norm; what is not finite is infinitely large."""
    square = residual @ residual
    return jnp.where(jnp.isfinite(square), square, jnp.inf)


def _describe(point: _Point, load: Load, ends: Array, error: Array) -> Equilibrium:
    tolerance = TOLERANCE if error.dtype == jnp.float64 else TOLERANCE**0.5
    rest = imbalance(point.pose, point.tensions, load, ends)
    finite = jnp.isfinite(error)
    return Equilibrium(
        point.pose,
        point.tensions,
        cables_at(point.pose, load, ends)[1],
        jnp.linalg.norm(rest[:3]),
        jnp.linalg.norm(rest[3:]),
        jnp.where(finite, jnp.where(error <= tolerance, CONVERGED, NOT_CONVERGED), NOT_FINITE),
    )
