"""What the cables carry along a motion: lengths, tensions at rest and with inertia, postures."""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.mechanics.statics import force_tensions, weight
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import World, build_world, cast_world, rounded_counts
from jaxsusp.suspension.hanging import Hanging, equilibrium, in_blocks
from jaxsusp.suspension.levelload import ends_at, stability_of, tight_tension_limits
from jaxsusp.vec3 import Vec3, pack_rows, rows_of


class Loads(NamedTuple):
    """Load and cables at many instants; host arrays."""

    lengths: Float[np.ndarray, "times cables"]  # m
    static: Float[np.ndarray, "times cables"]  # tensions of a load at rest there, N
    tensions: Float[np.ndarray, "times cables"]  # with inertia, N; NaN without equilibrium
    stability: Float[np.ndarray, "times"]  # S_c, without inertia
    posture: Float[np.ndarray, "times xyz 3"]  # R; level at a hook
    turn: Float[np.ndarray, "times"]  # angle of R, rad
    balanced: Bool[np.ndarray, "times"]  # whether the load is in equilibrium
    missing: Float[np.ndarray, "times"]  # moment that equilibrium lacks, N m
    stiffness: Float[np.ndarray, "times"]  # of the softest mode, N/m; inf at a hook

    def stated(self, units: Frame) -> "Loads":
        """The same, of a system in own units, with numbers as a scenario's units make them."""
        changed = {
            name: units.number(getattr(self, name), unit)
            for name, unit in (
                ("lengths", "m"), ("static", "N"), ("tensions", "N"), ("missing", "N m"),
                ("stiffness", "N/m"),
            )
        }  # fmt: skip
        return self._replace(**changed)


def cable_loads(
    scenario: Scenario,
    position: Float[Array, "times xyz"],
    acceleration: Float[Array, "times xyz"] | None = None,
    ends: Float[Array, "*#times cables xyz"] | None = None,
) -> Loads:
    """Lengths, tensions, stability factor and postures, float64 (Eq. 3, 4, 6, 18).

    At a hook the load is level and its tensions balance the forces; separate attachments turn it
    to its equilibrium.

    Args:
        scenario: load, attachments and limits.
        position: of the load's centre (m).
        acceleration: of it (m/s²); default none.
        ends: upper cable ends, (K, 3) or (times, K, 3) (m); default the scenario's, moved by the
            plain rule of its drive mode.
    """
    position = np.asarray(position, np.float64)
    count, cables = len(position), len(scenario.robots)
    if acceleration is None:
        acceleration = np.zeros_like(position)
    world = build_world(scenario, rounded_counts(scenario))
    with jax.enable_x64(True):
        world, where = cast_world(world, np.float64), jnp.asarray(position)
        if ends is None:
            packed = ends_at(world, Vec3.from_array(where), scenario.drive)
            ends = np.asarray(rows_of(packed))
        held = np.broadcast_to(np.asarray(ends, np.float64), (count, cables, 3))
        if scenario.payload.attachments != "hook":
            return _turned(scenario, world, where, acceleration, held)
        find = functools.partial(_at_hook, world)
        rows = position, np.asarray(acceleration, np.float64), held
        lengths, static, tensions, factor = in_blocks(find, rows)
    nothing = np.zeros(count)
    return Loads(
        lengths,
        static,
        tensions,
        factor,
        np.tile(np.eye(3), (count, 1, 1)),
        turn=nothing,
        balanced=np.ones(count, bool),
        missing=nothing,
        stiffness=np.full(count, np.inf),
    )


@jax.jit
def _at_hook(world: World, position, acceleration, ends) -> tuple[Array, ...]:
    where, packed = Vec3.from_array(position), pack_rows(ends)
    vectors = cable_vectors(where, world.bodies.attachments, packed)
    lengths, still = cable_lengths(vectors), weight(world.mass)
    limits = tight_tension_limits(world.limits, position.dtype)
    force = Vec3.from_array(acceleration) * world.mass + still
    both = force.each(lambda c: jnp.zeros_like(c)) + still, force
    # At rest and in motion in one go: more than three cables share their tensions by a loop, and
    # the compiler then meets it once.
    held = [vector.each(lambda c: jnp.stack([c, c])) for vector in vectors]
    pull = Vec3(*(jnp.stack(each) for each in zip(*both, strict=True)))
    tensions = force_tensions(held, [jnp.stack([each, each]) for each in lengths], pull, limits)
    static = [each[0] for each in tensions]
    columns = lengths, static, [each[1] for each in tensions]
    factor = stability_of(world, where, static, packed)
    return *(jnp.stack(each, axis=-1) for each in columns), factor


def _turned(scenario: Scenario, world: World, position, acceleration, ends) -> Loads:
    """Of a load that turns until its moments balance."""
    static = equilibrium(scenario, position, ends=ends)
    moving = equilibrium(scenario, position, acceleration, ends=ends)

    def balanced(found: Hanging) -> np.ndarray:
        return np.where(np.asarray(found.balanced)[:, None], np.asarray(found.tensions), np.nan)

    packed = pack_rows(jnp.asarray(ends))
    columns = list(jnp.asarray(balanced(static)).T)
    factor = stability_of(world, Vec3.from_array(position), columns, packed)
    return Loads(
        np.asarray(moving.lengths),
        balanced(static),
        balanced(moving),
        np.asarray(factor),
        np.asarray(moving.posture),
        np.asarray(moving.turn),
        np.asarray(moving.balanced),
        np.asarray(moving.moment),
        np.asarray(moving.stiffness),
    )
