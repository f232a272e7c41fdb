"""Fans of candidate ends: where each cable's end could go at every step, and which go together.

Each cable is rotated by small angles about its attachment (Sect. 3.3). Tensions couple the
cables, so what is judged are *joint* candidates, one end per cable: 9 per cable are 729 for three
cables. They are filtered by reach, separation, cable lengths, tensions and clearance.
"""

from itertools import product
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.errors import InputError
from jaxsusp.geometry.cables import attachment
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.mechanics.statics import force_tensions, weight
from jaxsusp.scenario.world import World
from jaxsusp.suspension.reach import in_reach
from jaxsusp.vec3 import Vec3, norm, pack

MOST = 20_000
"""Joint candidates per step that memory and patience bear."""


class Candidates(NamedTuple):
    """Joint candidates (m, N), steps on the first axis; of a sequence there is one per step."""

    ends: Float[Array, "*joint cables xyz"]
    lengths: Float[Array, "*joint cables"]
    tensions: Float[Array, "*joint cables"]
    feasible: Bool[Array, "*joint"]


def combinations(fan: int, cables: int) -> np.ndarray:
    """All choices of one candidate per cable, (fan^K, K).

    Raises:
        InputError: more than `MOST`.
    """
    if fan**cables > MOST:
        side = int(MOST ** (0.5 / cables) + 1e-9)
        most = (side - 1 + side % 2) ** 2  # an odd square, which makes a grid in every mode
        raise InputError(
            f"fan = {fan}: {fan}^{cables} joint candidates per step are too many; give at most "
            f"{most} candidates per cable for {cables} cables"
        )
    return np.array(list(product(range(fan), repeat=cables)))


def offsets(drive: str, fan: int, angle: float) -> np.ndarray:
    """The fan's rotations (fan, 2): heading and elevation (rad), within ±angle each.

    A square grid where the end may move anywhere, so `fan` is a square number; headings alone in
    mode "base", whose ends keep their height and whose cables keep their length. The number is
    odd: what the fan opens around is among its candidates.

    Raises:
        InputError: a number of candidates that makes no such grid.
    """
    if drive == "base":
        if fan % 2 == 0:
            raise InputError(f"fan = {fan}: give an odd number, such as 9")
        return np.stack([_steps(fan, angle), np.zeros(fan)], axis=1)
    side = round(fan**0.5)
    if side * side != fan or fan % 2 == 0:
        raise InputError(f"fan = {fan}: give an odd square number, such as 9 or 25")
    grid = np.meshgrid(_steps(side, angle), _steps(side, angle), indexing="ij")
    return np.stack([each.ravel() for each in grid], axis=1)


def _steps(count: int, angle: float) -> np.ndarray:
    """Evenly spaced from -angle to angle, the middle exactly 0."""
    half = count // 2
    return np.arange(-half, half + 1) * (angle / max(half, 1))


def rotated(cable: Vec3, heading: Array, elevation: Array) -> Vec3:
    """A cable vector turned about the vertical and then up or down, its length kept.

    The elevation stops at straight up and straight down.
    """
    level = jnp.sqrt(cable.x**2 + cable.y**2)
    length = norm(cable)
    azimuth = jnp.arctan2(cable.y, cable.x) + heading
    rise = jnp.clip(jnp.arctan2(cable.z, level) + elevation, -jnp.pi / 2, jnp.pi / 2)
    out = length * jnp.cos(rise)
    return Vec3(out * jnp.cos(azimuth), out * jnp.sin(azimuth), length * jnp.sin(rise))


def fan_ends(
    world: World, position: Vec3, ends: Vec3, turns: Float[Array, "cables samples fan 2"]
) -> Vec3:
    """Ends turned about their attachments, packed (K, samples, fan).

    Args:
        world: attachments.
        position: the load's centre (samples,) (m).
        ends: what is turned, (K, samples) (m).
        turns: heading and elevation (rad); an axis of length 1 serves all.
    """
    rows = []
    for k in range(world.cables):
        lower = position + attachment(world.bodies.attachments, k)
        cable = ends.each(lambda c, k=k: c[k]) - lower
        heading, elevation = turns[k, ..., 0], turns[k, ..., 1]
        turned = rotated(cable.each(lambda c: c[:, None]), heading, elevation)
        rows.append(turned + lower.each(lambda c: c[:, None]))
    return pack(rows)


def joint_candidates(
    world: World, position: Vec3, fans: Vec3, choices: Array, margin: Array, arms: bool
) -> Candidates:
    """All joint candidates of all steps and whether each may be.

    Args:
        world: robots, obstacles and limits.
        position: the load's centre at every step (samples,) (m).
        fans: candidate ends packed (K, samples, fan) (m).
        choices: joint candidates (joint, K), see `combinations`.
        margin: by which cables keep off obstacles: radius, clearance and what a motion asks (m).
        arms: whether the ends must be in reach of the robots as they stand.
    """
    limits = world.limits
    vectors, lengths, columns = [], [], []
    feasible = jnp.ones((position.x.shape[0], len(choices)), bool)
    for k in range(world.cables):
        fan = fans.each(lambda c, k=k: c[k])
        lower = (position + attachment(world.bodies.attachments, k)).each(lambda c: c[:, None])
        length = norm(fan - lower)
        fine = segments_clear(lower, fan, margin, world.obstacles)
        fine &= (length >= limits.length_low) & (length <= limits.length_high)
        fine &= fan.z > lower.z
        if arms:
            fine &= in_reach(world.robots, k, fan)
        chosen = choices[:, k]
        feasible &= fine[:, chosen]
        end = fan.each(lambda c, chosen=chosen: c[:, chosen])
        for other in columns:
            feasible &= norm(end - other) >= limits.separation
        columns.append(end)
        vectors.append(end - lower)
        lengths.append(length[:, chosen])
    bounds = limits.tension_low, limits.tension_high
    tensions = jnp.stack(force_tensions(vectors, lengths, weight(world.mass), bounds), axis=-1)
    inside = (tensions >= limits.tension_low - 1e-9) & (tensions <= limits.tension_high + 1e-9)
    ends = jnp.stack([end.to_array() for end in columns], axis=-2)
    found = jnp.stack(lengths, axis=-1)
    return Candidates(ends, found, tensions, feasible & inside.all(axis=-1))
