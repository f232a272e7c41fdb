"""Everything that goes with the load along its path: ends, arms, bases, and what cables carry.

The ends are rows beside the points of the load's path (one row where they stay) and run on a
quintic spline in the path's own parameter, so that whoever asks for the load at some instant can
ask for the whole system.
"""

from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Bool, Float
from jaxsusp.mechanics import arm
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.ownunits import UNCHANGED
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of, build_world, cast_world, rounded_counts
from jaxsusp.suspension.armclearance import choose_elbows
from jaxsusp.suspension.cableloads import Loads, cable_loads
from jaxsusp.suspension.hanging import in_blocks
from jaxsusp.suspension.levelload import ends_at
from jaxsusp.trajectory.smoothpath import SmoothPath, Spline
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.vec3 import Vec3, rows_of

INSTANTS = 160
"""Positions along the path at which arms are checked for the choice of their elbows."""


@dataclass(frozen=True, eq=False)
class Rigging:
    """The whole system along a path; host arrays, SI units, K cables.

    Methods take parameters u of the path (see `SmoothPath`); `law.parameter(times)` has them.
    """

    scenario: Scenario
    law: TimeLaw
    end_path: Float[np.ndarray, "rows cables xyz"]  # beside the path's points; one if they stay
    elbow_up: Bool[np.ndarray, "cables"]

    @classmethod
    def of(
        cls,
        scenario: Scenario,
        law: TimeLaw,
        end_path: Float[np.ndarray, "rows cables xyz"],
        elbow_up: Any = None,
    ) -> "Rigging":
        """A system with elbows as asked for, or chosen so that arms are out of the way."""
        chosen = np.ones(end_path.shape[1], bool) if elbow_up is None else elbow_up
        found = cls(scenario, law, end_path, np.asarray(chosen, bool))
        return found if elbow_up is not None else cls(scenario, law, end_path, found._best_elbows())

    def _best_elbows(self) -> np.ndarray:
        u = np.linspace(*self.law.path.span, INSTANTS)
        ends = self.ends_at(u)
        with jax.enable_x64(True):
            world = cast_world(
                build_world(self.scenario, rounded_counts(self.scenario)), jnp.float64
            )
            arrays = self.law.path.curve(u), ends, self.bases_at(ends)
            return np.asarray(_choose_elbows(world, *map(jnp.asarray, arrays)))

    @cached_property
    def own(self) -> "Rigging":
        """The same system in the task's own units and frame."""
        units = self.scenario.units
        if units == UNCHANGED:
            return self
        path = SmoothPath(units.inside(self.law.path.points))
        law = self.law.restated(path, 1 / units.factor("m"), 1 / units.factor("s"))
        return Rigging(self.scenario.own, law, units.inside(self.end_path), self.elbow_up)

    @property
    def moves(self) -> bool:
        """Whether the ends move."""
        return len(self.end_path) > 1

    @property
    def cables(self) -> int:
        """Number K of cables."""
        return self.end_path.shape[1]

    @cached_property
    def tracks(self) -> tuple[Spline, ...]:
        """The way of every end that moves; none where they stay."""
        if not self.moves:
            return ()
        return tuple(self.law.path.beside(self.end_path[:, k]) for k in range(self.cables))

    def ends_at(self, u: Float[np.ndarray, "times"]) -> Float[np.ndarray, "times cables xyz"]:
        """Upper cable ends P_k (m)."""
        if not self.moves:
            return np.broadcast_to(self.end_path, (len(u), self.cables, 3))
        return np.stack([track.curve(u) for track in self.tracks], axis=1)

    @cached_property
    def bases(self) -> Float[np.ndarray, "cables xyz"]:
        """O_k where they are given (m)."""
        return np.array([robot.base for robot in self.scenario.robots], np.float64)

    @cached_property
    def links(self) -> Float[np.ndarray, "cables joints"]:
        """(a1, a2, a3) of every robot (m)."""
        return np.array([robot.links for robot in self.scenario.robots], np.float64)

    @property
    def rolls(self) -> bool:
        """Whether the bases carry the ends along: P_k = O_k + const."""
        return self.moves and self.scenario.drive == "base"

    def bases_at(
        self, ends: Float[np.ndarray, "times cables xyz"]
    ) -> Float[np.ndarray, "times cables xyz"]:
        """Bases O_k that go with ends (m)."""
        if not self.rolls:
            return np.broadcast_to(self.bases, ends.shape)
        given = np.array([robot.end for robot in self.scenario.robots], np.float64)
        return ends - (given - self.bases)

    def shoulders_at(
        self, ends: Float[np.ndarray, "times cables xyz"]
    ) -> Float[np.ndarray, "times cables xyz"]:
        """Tops of the columns that go with ends (m)."""
        return self.bases_at(ends) + self.links[:, :1] * np.array([0.0, 0.0, 1.0])

    def joints_at(
        self, ends: Float[np.ndarray, "times cables xyz"]
    ) -> Float[np.ndarray, "times cables joints"]:
        """Joint angles that hold ends (rad); continuous in time, φ1 beyond ±π if it must be."""
        with jax.enable_x64(True):
            held = partial(_held, self.links, self.elbow_up)
            joints = in_blocks(held, (self.bases_at(ends), ends))
        return np.concatenate([np.unwrap(joints[..., :1], axis=0), joints[..., 1:]], axis=-1)

    def chains_at(
        self, ends: Float[np.ndarray, "times cables xyz"]
    ) -> Float[np.ndarray, "times cables points=4 xyz"]:
        """Foot, shoulder, elbow and end of every robot (m)."""
        with jax.enable_x64(True):
            chains = partial(_chains, self.links)
            return in_blocks(chains, (self.bases_at(ends), self.joints_at(ends)))

    def loads(self, times: Float[np.ndarray, "times"]) -> Loads:
        """Lengths, tensions and postures at times (s)."""
        if self.own is not self:  # far from the world's origin equilibria would be lost in rounding
            units = self.scenario.units
            return self.own.loads(times / units.factor("s")).stated(units)
        motion, ends = self.law.at(times), self.ends_at(self.law.parameter(times))
        return cable_loads(self.scenario, motion.position, motion.acceleration, ends)


@jax.jit
def _held(links, up, bases, ends):
    found = arm.inverse(bases, links[None], ends)
    return jnp.where(up[None, :, None], found.elbow_up, found.elbow_down)


@jax.jit
def _chains(links, bases, joints):
    return arm.chain(bases, links[None], joints)


_choose_elbows = jax.jit(choose_elbows)


def ends_beside(
    scenario: Scenario, points: Float[np.ndarray, "points xyz"]
) -> Float[np.ndarray, "rows cables xyz"]:
    """Ends beside a load's path by the plain rule of the drive mode: one row where they stay.

    Where a base-driven cable is too short to reach its end's height, the end is straight above
    the load: the report then finds the length changed.
    """
    given = np.array([[robot.end for robot in scenario.robots]], np.float64)
    if not moving(scenario.drive):
        return given
    with jax.enable_x64(True):
        world = cast_world(build_world(scenario, rounded_counts(scenario)), jnp.float64)
        packed = ends_at(world, Vec3.from_array(jnp.asarray(points)), scenario.drive)
        ends = np.asarray(rows_of(packed))
    above = points[:, None] + attachments_of(scenario)
    above[..., 2] = given[..., 2]
    return np.where(np.isfinite(ends), ends, above)
