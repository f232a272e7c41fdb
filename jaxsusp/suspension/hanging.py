"""How the load of a scenario hangs at given positions: posture, tensions, residuals, stability.

This is the statics behind the constraint report (Eq. 22): a finished plan asks all along its way
whether the load is in equilibrium, how far it turns, and whether it stays (`cableloads`).
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.errors import InputError
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.mechanics.posture.equilibrium import CONVERGED, Equilibrium, hang
from jaxsusp.mechanics.posture.load import Pose, angles
from jaxsusp.mechanics.posture.potential import is_stable, stiffness
from jaxsusp.mechanics.posture.redundant import hang_within
from jaxsusp.mechanics.statics import GRAVITY, force_tensions
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.scenario.world import World, build_world, cast_world, rounded_counts
from jaxsusp.suspension.levelload import ends_at, tight_tension_limits
from jaxsusp.vec3 import Vec3, cross, norm, pack_rows, rows_of

BLOCK = 256
"""Positions that are looked at together."""


class Hanging(NamedTuple):
    """A load at rest (or carried along with an acceleration), one entry per position."""

    tensions: Float[Array, "*batch cables"]  # N
    lengths: Float[Array, "*batch cables"]  # m
    posture: Float[Array, "*batch xyz 3"]  # R
    angles: Float[Array, "*batch 3"]  # α1, α2, α3, rad
    turn: Float[Array, "*batch"]  # angle of R: how far from level, heading included, rad
    force: Float[Array, "*batch"]  # what is missing of the balance of forces, N
    moment: Float[Array, "*batch"]  # and of moments about the centre of mass, N m
    stiffness: Float[Array, "*batch"]  # of the softest mode, N/m; inf if cables fix the pose
    balanced: Bool[Array, "*batch"]
    stable: Bool[Array, "*batch"]


def equilibrium(
    scenario: Scenario | Named,
    position: Float[Array, "*batch xyz"] | Sequence,
    acceleration: Float[Array, "*#batch xyz"] | Sequence | float = 0.0,
    posture: Float[Array, "xyz 3"] | Sequence | None = None,
    ends: Float[Array, "*#batch cables xyz"] | Sequence | None = None,
) -> Hanging:
    """How the load hangs at given positions of its centre.

    At a hook it hangs level. With separate attachments and fixed ends it turns until its moments
    balance: the posture is that of the equilibrium next to level, of three cables the six balance
    equations' solution, of more the one within the tension limits (or the least residual).

    Args:
        scenario: ends, attachments, mass, centre of mass and limits.
        position: payload centres, (…, 3), m.
        acceleration: of the payload, broadcastable to `position`, m/s²; it acts as a change of
            gravity.
        posture: rotation matrix to start from with separate attachments; default level.
        ends: upper cable ends, (K, 3) or (…, K, 3), m; default the scenario's, moved by the plain
            rule of its drive mode.

    Returns:
        A `Hanging` with the batch shape of `position`, float64 for host input, the dtype of
        `position` for a JAX array.

    Raises:
        InputError: a tilted posture at a hook; separate attachments whose ends no rule moves.
    """
    scenario = load_scenario(scenario, task_checked=False)
    hook = scenario.payload.attachments == "hook"
    level = np.eye(3)
    start = level if posture is None else np.asarray(posture, np.float64)
    if start.shape != (3, 3) or not np.allclose(start @ start.T, level, atol=1e-6):
        raise InputError(f"posture = {start.tolist()} is no rotation; give a 3×3 rotation matrix")
    if hook and not np.allclose(start, level, atol=1e-9):
        raise InputError(
            f"{scenario.name}: posture is tilted, but at a hook the load hangs straight down "
            "whatever its cables do; leave it out, or give separate payload.attachments"
        )
    if ends is None:
        require_rule(scenario)
    dtype = position.dtype if isinstance(position, jax.Array) else np.dtype(np.float64)
    with jax.enable_x64(dtype == np.float64):
        where = jnp.asarray(position, dtype)
        pull = jnp.broadcast_to(jnp.asarray(acceleration, dtype), where.shape)
        gravity = (-pull).at[..., 2].add(-GRAVITY)
        world = cast_world(build_world(scenario, rounded_counts(scenario)), dtype)
        if ends is None:
            held = rows_of(ends_at(world, Vec3.from_array(where), scenario.drive))
        else:
            held = jnp.asarray(ends, dtype)
        held = jnp.broadcast_to(held, (*where.shape[:-1], world.cables, 3))
        flat = where.reshape(-1, 3), gravity.reshape(-1, 3), held.reshape(-1, world.cables, 3)
        find = functools.partial(_at_hook if hook else _turned, world, jnp.asarray(start, dtype))
        found = in_blocks(find, flat)
        return jax.tree.map(lambda leaf: leaf.reshape(*where.shape[:-1], *leaf.shape[1:]), found)


def in_blocks(find: Callable[..., Any], rows: Sequence[Any]) -> Any:
    """What a compiled function of rows finds, in blocks of one size: it is compiled but once.

    Args:
        find: takes blocks of rows, and returns a pytree of as many.
        rows: arrays of JAX, or of NumPy (quicker: cutting them needs no compilation).
    """
    count = len(rows[0])
    blocks = max(1, -(-count // BLOCK))
    numpy = rows[0].__array_namespace__()
    rows = [
        numpy.pad(each, [(0, blocks * BLOCK - count)] + [(0, 0)] * (each.ndim - 1)) for each in rows
    ]
    found = [find(*(each[i * BLOCK : (i + 1) * BLOCK] for each in rows)) for i in range(blocks)]
    return jax.tree.map(lambda *leaves: numpy.concatenate(leaves)[:count], *found)


def hanging_trouble(scenario: Scenario, position: Float[Array, "xyz"] | Sequence) -> str:
    """Why a load does not hang near level and steadily at a position; empty if it does."""
    found = equilibrium(scenario, position)
    limit, turn = scenario.limits.posture_deg, float(np.rad2deg(found.turn))
    say = scenario.frame
    if not found.balanced:
        return (
            f"no posture is an equilibrium: with the cables' best tensions "
            f"{say.number(float(found.force), 'N'):.3g} N and "
            f"{say.number(float(found.moment), 'N m'):.3g} N m are missing"
        )
    if not turn <= limit:
        return (
            f"level is no equilibrium: the load turns by {turn:.3g}°, more than "
            f"limits.posture_deg = {limit:g}"
        )
    return "" if found.stable else "the equilibrium is not stable"


@jax.jit
def _turned(world: World, start: Array, position: Array, gravity: Array, ends: Array) -> Hanging:
    def one(where: Array, field: Array, ends: Array) -> Hanging:
        load = world.load(field)
        if world.cables == 3:
            found = hang(where, start, load, ends)
        else:
            limits = world.limits.tension_low, world.limits.tension_high
            found = hang_within(where, start, load, ends, *limits)
        return _describe(found, stiffness(found.pose, found.tensions, load, ends))

    return jax.vmap(one)(position, gravity, ends)


@jax.jit
def _at_hook(world: World, start: Array, position: Array, gravity: Array, ends: Array) -> Hanging:
    where, field = Vec3.from_array(position), Vec3.from_array(gravity)
    packed = pack_rows(ends)
    vectors = cable_vectors(where, world.bodies.attachments, packed)
    lengths = cable_lengths(vectors)
    force = field * -world.mass
    limits = tight_tension_limits(world.limits, position.dtype)
    tensions = force_tensions(vectors, lengths, force, limits)
    arm = world.bodies.attachments.each(lambda c: c[0]) - world.center_of_mass
    columns = jnp.stack(tensions, axis=-1)

    def softest(point: Array, field: Array, tension: Array, ends: Array) -> Array:
        return stiffness(Pose(point, start), tension, world.load(field), ends, hook=True)

    found = Equilibrium(
        Pose(position, jnp.broadcast_to(start, (*position.shape, 3))),
        columns,
        jnp.stack(lengths, axis=-1),
        jnp.zeros_like(where.x),  # a hook balances every force
        norm(cross(arm, force)),
        jnp.where(jnp.isfinite(columns).all(axis=-1), CONVERGED, 2),
    )
    modes = jax.vmap(softest)(position, gravity, columns, ends)
    return jax.vmap(_describe)(found, modes)


def _describe(found: Equilibrium, modes: Array) -> Hanging:
    posture = found.pose.posture
    sine = jnp.stack([posture[2, 1], posture[0, 2], posture[1, 0]]) - jnp.stack(
        [posture[1, 2], posture[2, 0], posture[0, 1]]
    )
    turn = jnp.arctan2(jnp.linalg.norm(sine), jnp.trace(posture) - 1)
    return Hanging(
        found.tensions,
        found.lengths,
        posture,
        angles(posture),
        turn,
        found.force,
        found.moment,
        modes.min(initial=jnp.inf),
        found.code == CONVERGED,
        is_stable(modes),
    )
