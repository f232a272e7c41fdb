"""A level load at any positions in a world: its ends, bases, cable lengths and tensions (Sect. 2).

Everything here takes arrays of positions of any shape in the dtype of the world: the search asks
for all samples of all candidates at once, a plan for the instants of its motion.
"""

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.geometry.cables import attachment, cable_lengths, cable_vectors
from jaxsusp.mechanics.drives import Anchors, bases_along, ends_along, moving
from jaxsusp.mechanics.posture.levelling import level_ends
from jaxsusp.mechanics.posture.rolling import rolled_level_ends, upward_shares
from jaxsusp.mechanics.posture.tilting import estimated_turn
from jaxsusp.mechanics.stability import stability, stability_factors
from jaxsusp.mechanics.statics import GRAVITY, force_tensions, weight
from jaxsusp.scenario.world import Limits, World
from jaxsusp.vec3 import Vec3, component, norm, pack

# In float32 the tension limits are drawn in by a little more than the rounding error, so that what
# a search finds admissible stays so when it is re-evaluated in float64.
SINGLE_PRECISION_TENSION = 1e-3  # N
DOUBLE_PRECISION_TENSION = 1e-9  # N, for tensions that are put exactly at their limit


def ends_at(world: World, position: Vec3, drive: str) -> Vec3:
    """Ends P_k (m) at load positions of any shape, by the plain rule of the drive mode.

    Where ends move, those of separate attachments are moved on until they hold the load level,
    see `mechanics.posture.levelling`; bases that roll do so as `mechanics.posture.rolling` says.
    """
    bodies = world.bodies
    anchors = Anchors(world.start, bodies.attachments, bodies.ends)
    if drive == "base" and bodies.attachments.x.shape[0] > 1:
        rows, center = bodies.attachments.to_array(), world.center_of_mass
        shares = upward_shares(rows, center.to_array())
        return rolled_level_ends(position, anchors, shares, center)
    ends = ends_along(drive, position, anchors)
    if not moving(drive) or bodies.attachments.x.shape[0] == 1:
        return ends
    lower = [position + attachment(bodies.attachments, k) for k in range(world.cables)]
    vectors = [component(ends, k) - at for k, at in enumerate(lower)]
    tensions = tensions_at(world, position, ends)[1]
    down = jnp.asarray([0.0, 0.0, -GRAVITY], position.x.dtype)
    found = level_ends(lower, vectors, tensions, world.load(down))
    return pack(found)


def bases_at(world: World, ends: Vec3, drive: str) -> Vec3:
    """Bases O_k (m) that carry ends (K, …), of the same shape."""
    given = Vec3.from_array(jnp.asarray(world.robots.base))
    anchors = Anchors(world.start, world.bodies.attachments, world.bodies.ends)
    return bases_along(drive, ends, anchors, given)


def tensions_at(
    world: World, position: Vec3, ends: Vec3 | None = None
) -> tuple[list[Array], list[Array]]:
    """Cable lengths l_k (m) and static tensions T_k (N) of the level load at any positions.

    Args:
        world: attachments, mass and limits.
        position: the load's centre (m).
        ends: P_k packed along the first axis (m), where they are not the world's own.
    """
    ends = world.bodies.ends if ends is None else ends
    vectors = cable_vectors(position, world.bodies.attachments, ends)
    lengths = cable_lengths(vectors)
    limits = tight_tension_limits(world.limits, position.x.dtype)
    return lengths, force_tensions(vectors, lengths, weight(world.mass), limits)


def turn_at(world: World, position: Vec3, tensions: list[Array]) -> Float[Array, "..."]:
    """How far (rad) a load with separate attachments and fixed ends turns, to first order."""
    bodies = world.bodies
    vectors = cable_vectors(position, bodies.attachments, bodies.ends)
    units = [vector * (1 / norm(vector)) for vector in vectors]
    arms = [component(bodies.attachments, k) - world.center_of_mass for k in range(len(units))]
    return estimated_turn(arms, units, tensions)


def stability_of(
    world: World, position: Vec3, tensions: list[Array], ends: Vec3 | None = None
) -> Array:
    """S_c at load positions with known tensions (Eq. 18)."""
    bodies, limits = world.bodies, world.limits
    hook = position + bodies.attachments.each(lambda c: c.mean(axis=0))
    factors = stability_factors(
        hook,
        bodies.ends if ends is None else ends,
        tensions,
        position.z,
        world.lower.z,
        (limits.tension_low, limits.tension_high),
    )
    return stability(factors)


def tight_tension_limits(limits: Limits, dtype) -> tuple[Array, Array]:
    """T_lo, T_hi (N) for distributing tensions: rounding then carries none beyond what is counted.

    In float32 twice as far inside as the limits that are counted there.
    """
    single = dtype == jnp.float32
    return drawn_in(limits, 2 * SINGLE_PRECISION_TENSION if single else DOUBLE_PRECISION_TENSION)


def drawn_in(limits: Limits, margin: float) -> tuple[Array, Array]:
    """T_lo and T_hi (N), each moved inside by a margin."""
    return jnp.asarray(limits.tension_low) + margin, jnp.asarray(limits.tension_high) - margin
