"""Where the load can be for given ends: admissible tensions and, with obstacles, clear cables."""

import functools
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.errors import InputError
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.ownunits import TOUCH
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.scenario.world import World, build_world, cast_world
from jaxsusp.suspension.hanging import Hanging, equilibrium
from jaxsusp.suspension.levelload import ends_at, tensions_at
from jaxsusp.suspension.reach import count_misplaced
from jaxsusp.vec3 import Vec3

HOOK_SPACING, SEPARATE_SPACING = 0.1, 0.25
"""Default spacing in the task's own units; with separate attachments every cell costs an
equilibrium."""

HOOK_CELLS, SEPARATE_CELLS = 1_000_000, 50_000
"""Cells at most that a default spacing gives: it is larger in a workspace that would have more."""

_MOST = 5_000_000
_FEWEST = 3  # cells along an axis: one alone would stand for everything beside it
_BATCH = 1024  # equilibria at a time


@dataclass(frozen=True, eq=False)
class Workspace:
    """A grid of cells over the workspace box, judged at their centres. Host arrays.

    Attributes:
        scenario: what it belongs to.
        axes: centres of the cells along x, y and z (m).
        tensions: T_k at the centres (N), (x, y, z, K); NaN where there is no equilibrium.
        admissible: tensions and lengths are within their limits, moving ends in reach and apart;
            with separate attachments the equilibrium is stable and within the posture limit.
        clear: load and cables at rest there keep out of every warning area.
    """

    scenario: Scenario
    axes: tuple[np.ndarray, np.ndarray, np.ndarray]
    tensions: Float[np.ndarray, "x y z cables"]
    admissible: Bool[np.ndarray, "x y z"]
    clear: Bool[np.ndarray, "x y z"]

    @property
    def usable(self) -> Bool[np.ndarray, "x y z"]:
        """Admissible and clear."""
        return self.admissible & self.clear

    def stated(self, scenario: Scenario) -> "Workspace":
        """That of a task in own units as one of the scenario that states it."""
        if self.scenario is scenario:
            return self
        units = scenario.units
        x, y, z = (
            units.length * axis + start for axis, start in zip(self.axes, units.origin, strict=True)
        )
        tensions = units.number(self.tensions, "N")
        return replace(self, scenario=scenario, axes=(x, y, z), tensions=tensions)

    @property
    def cell(self) -> float:
        """Volume of a cell (m³)."""
        box = self.scenario.workspace
        return float(np.prod(np.subtract(box.upper, box.lower)) / self.clear.size)

    def volume(self, which: Bool[np.ndarray, "x y z"]) -> float:
        """Volume (m³) of the cells that are chosen."""
        return float(which.sum() * self.cell)

    @property
    def margin(self) -> Float[np.ndarray, "x y z"]:
        """Distance of the worst tension from its limits over half their range: at most 1."""
        low, high = self.scenario.limits.tension
        room = np.minimum(self.tensions - low, high - self.tensions).min(axis=-1)
        return room / ((high - low) / 2)


def workspace(scenario: Scenario | Named, spacing: float | None = None) -> Workspace:
    """The set of load positions that a suspension can hold, as a grid of cells.

    Args:
        scenario: the ends are as given; in a drive mode that moves them, where its plain rule puts
            them when the load comes from the start. Its start and goal may be inadmissible.
        spacing: of the grid (m), rounded so that cells fill the workspace; default a ninetieth of
            the robots' mean total link length, with separate attachments a 36th, and more in a
            large workspace.

    Raises:
        InputError: a spacing that is not positive or gives too many or too few cells; separate
            attachments whose ends move.
    """
    asked = load_scenario(scenario, task_checked=False)
    scenario = asked.own
    require_rule(scenario)
    hook = scenario.payload.attachments == "hook"
    chosen = _default_spacing(scenario) if spacing is None else _asked(asked, spacing)
    axes = _axes(scenario, chosen)
    shape = tuple(map(len, axes))
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    with jax.enable_x64(True):
        world = cast_world(build_world(scenario), jnp.float64)
        found = _judge(world, jnp.asarray(points), scenario.drive)
        tensions, admissible, clear = (np.asarray(leaf) for leaf in found)
    if not hook:
        tensions, hangs = _hang(scenario, points)
        low, high = scenario.limits.tension
        admissible = hangs & ((tensions >= low) & (tensions <= high)).all(axis=-1)
    return Workspace(
        scenario,
        axes,
        tensions.reshape(*shape, -1),
        admissible.reshape(shape),
        clear.reshape(shape),
    ).stated(asked)


def _sides(scenario: Scenario) -> Float[np.ndarray, "3"]:
    return np.subtract(scenario.workspace.upper, scenario.workspace.lower)


def _default_spacing(scenario: Scenario) -> float:
    hook = scenario.payload.attachments == "hook"
    usual, most = (HOOK_SPACING, HOOK_CELLS) if hook else (SEPARATE_SPACING, SEPARATE_CELLS)
    return max(usual, float((np.prod(_sides(scenario)) / most) ** (1 / 3)))


def _asked(scenario: Scenario, spacing: float) -> float:
    """A spacing that a person gave, in own units."""
    if not (np.isfinite(spacing) and spacing > 0):
        raise InputError(f"spacing = {spacing}: give a length above 0 m")
    sides = _sides(scenario)
    counts = np.maximum(1, np.round(sides / spacing))
    if counts.prod() > _MOST:
        least = float((np.prod(sides) / _MOST) ** (1 / 3))
        raise InputError(f"spacing = {spacing:g} m gives too many cells; give {least:.2g} or more")
    if counts.min() < _FEWEST:
        most = float(sides.min() / _FEWEST)
        raise InputError(
            f"spacing = {spacing:g} m gives fewer than {_FEWEST} cells along an axis; give "
            f"{most:.2g} or less"
        )
    return spacing / scenario.units.length


def _axes(scenario: Scenario, spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres of cells that fill the workspace box."""
    low, high = np.array(scenario.workspace.lower), np.array(scenario.workspace.upper)
    counts = np.maximum(1, np.round((high - low) / spacing))
    x, y, z = (
        lo + (np.arange(count) + 0.5) * (hi - lo) / count
        for lo, hi, count in zip(low, high, counts.astype(int), strict=True)
    )
    return x, y, z


@functools.partial(jax.jit, static_argnums=2)
def _judge(world: World, points: Array, drive: str) -> tuple[Array, Array, Array]:
    """Tensions of a level load, whether tensions, lengths and ends may be, and what is clear."""
    position, limits = Vec3.from_array(points), world.limits
    ends = ends_at(world, position, drive)
    lengths, tensions = tensions_at(world, position, ends)
    admissible = jnp.ones(position.x.shape, bool)
    for length, tension in zip(lengths, tensions, strict=True):
        admissible &= (tension >= limits.tension_low) & (tension <= limits.tension_high)
        admissible &= (length >= limits.length_low) & (length <= limits.length_high)
    still = position.each(lambda c: jnp.stack([c, c]))  # a motion that stays where it is
    bodies = world.bodies
    if moving(drive):
        alone = ends.each(lambda c: c[:, None])
        admissible &= count_misplaced(world, alone, drive) == 0
        bodies = bodies._replace(ends=ends.each(lambda c: jnp.stack([c, c], axis=1)))
    clear = count_collisions(still, bodies, world.obstacles) == 0
    clear &= position.z >= world.floor - TOUCH
    return jnp.stack(tensions, axis=-1), admissible, clear


def _hang(scenario: Scenario, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tensions of the equilibria, and whether they are stable, in posture and long enough."""
    limits, tensions, good = scenario.limits, [], []
    for start in range(0, len(points), _BATCH):
        part = points[start : start + _BATCH]
        filled = np.concatenate([part, np.repeat(part[-1:], _BATCH - len(part), axis=0)])
        whole = jax.tree.map(np.asarray, equilibrium(scenario, filled))  # one shape: one program
        found = Hanging(*(leaf[: len(part)] for leaf in whole))
        low, high = limits.cable_length
        held = found.balanced & found.stable
        held &= np.rad2deg(found.turn) <= limits.posture_deg
        held &= ((found.lengths >= low) & (found.lengths <= high)).all(axis=-1)
        tensions.append(np.where(found.balanced[:, None], found.tensions, np.nan))
        good.append(held)
    return np.concatenate(tensions), np.concatenate(good)
