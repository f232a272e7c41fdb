"""A load that is allowed to tilt: how much room it takes, and how far it turns.

With separate attachments and fixed ends a level load is in general no equilibrium: it turns until
its moments balance. Planning plans positions of a level load, so everything is drawn a little
larger, by as much as a turn up to the posture limit can move it.
"""

import math

import jax.numpy as jnp

from jaxsusp._types import Array
from jaxsusp.vec3 import Vec3, cross, dot, norm


def warning_half_extents(radius: float, height: float, tilt: float) -> tuple[float, float]:
    """Radius and half-height (m) of the upright cylinder that holds a tilted one.

    The largest of r cos a + (h/2) sin a and of (h/2) cos a + r sin a over 0 <= a <= tilt (rad).
    """
    half = height / 2

    def largest(along: float, across: float) -> float:
        turn = min(tilt, math.atan2(across, along))
        return along * math.cos(turn) + across * math.sin(turn)

    return largest(radius, half), largest(half, radius)


def attachment_motion(distance: float, turn: float) -> float:
    """How far (m) a turn by an angle (rad) about any axis moves a point at a distance (m)."""
    return 2 * distance * math.sin(min(turn, math.pi) / 2)


def estimated_turn(arms: list[Vec3], units: list[Vec3], tensions: list[Array]) -> Array:
    """How far (rad) a level load turns until the moments of its cables balance, to first order.

    Around the level posture Σ T_k b_k × u_k changes with a turn ω by S ω,
    S = Σ T_k (b_k u_kᵀ - (b_k·u_k) I), tensions and directions taken as they are (a turn moves an
    attachment by little beside the cable's length). Closed form, for searches; at finished plans
    the equilibrium itself is solved for. For the benchmark cylinder hung by its rim the estimate
    is high by at most 0.33° where the load turns by 10° or less, never low.

    Args:
        arms: attachments from the centre of mass, level, b_k (m).
        units: u_k from attachment to end, any shape.
        tensions: T_k (N) that balance the forces.
    """
    moment = Vec3(*(jnp.zeros_like(units[0].x),) * 3)
    columns = [moment, moment, moment]
    for arm, unit, tension in zip(arms, units, tensions, strict=True):
        moment = moment + cross(arm, unit) * tension
        along = dot(arm, unit) * tension
        pull = unit * tension
        for axis in range(3):  # column j of S: T (b u_j - (b·u) e_j)
            each = arm * pull[axis]
            diagonal = each._replace(**{"xyz"[axis]: each[axis] - along})
            columns[axis] = columns[axis] + diagonal
    a, b, c = columns
    per_volume = 1 / dot(a, cross(b, c))
    turn = Vec3(
        dot(moment, cross(b, c)) * per_volume,
        dot(moment, cross(c, a)) * per_volume,
        dot(moment, cross(a, b)) * per_volume,
    )
    return norm(turn)
