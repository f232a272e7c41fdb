"""The last smoothing of a sequence of ends, in the fan's own coordinates.

Dynamic programming chooses among candidates on a grid, and the least change from step to step is
a string pulled tight around obstacles: it has kinks. A running mean over heading and elevation
rounds them. The drive mode's constraints hold for any angles; every other limit is checked.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float
from jaxsusp.coordination.fans import Candidates, fan_ends, joint_candidates
from jaxsusp.geometry.collisions import count_between
from jaxsusp.scenario.world import World
from jaxsusp.vec3 import Vec3

WIDTHS = (4.0, 3.0, 2.0, 1.0, 0.0)
"""Standard deviations (samples) of the running means, tried in turn; 0 changes nothing."""


def running_means(samples: int) -> Float[np.ndarray, "widths samples samples"]:
    """Matrices of Gaussian running means, one per width.

    Weights are positive and sum to 1, also near the ends: no angle leaves its fan.
    """
    apart = np.subtract.outer(np.arange(samples), np.arange(samples))
    rows = [np.exp(-0.5 * (apart / width) ** 2) if width else np.eye(samples) for width in WIDTHS]
    return np.stack([row / row.sum(axis=1, keepdims=True) for row in rows])


class Smoothed(NamedTuple):
    """The sequence under every running mean, widest first."""

    angles: Float[Array, "widths cables samples 2"]
    sequence: Candidates  # (widths, samples, cables, …)
    contacts: Array  # between steps, (widths,)
    fine: Bool[Array, "widths"]  # no contacts, and every limit kept at every step


def smoothed(
    world: World,
    position: Vec3,
    ends: Vec3,
    angles: Float[Array, "cables samples 2"],
    means: Float[Array, "widths samples samples"],
    margin: Array,
    arms: bool,
) -> Smoothed:
    """A sequence under every running mean, with all checks of candidates and of what is between.

    Args:
        world: robots, obstacles and limits.
        position: the load's centre (samples,) (m).
        ends: of the drive mode's plain rule, (K, samples) (m).
        angles: heading and elevation of every cable relative to that (rad), of a sequence that
            keeps the limits.
        means: see `running_means`.
        margin: m that cables keep beyond what is required.
        arms: whether the ends must be in reach of the robots as they stand.
    """
    alone = jnp.zeros((1, world.cables), jnp.int32)
    bodies = world.bodies
    bodies = bodies._replace(cable_radius=bodies.cable_radius + margin)

    def each(mean: Array) -> Smoothed:
        turned = jnp.einsum("st,ktj->ksj", mean, angles)
        fans = fan_ends(world, position, ends, turned[:, :, None])
        keep = bodies.cable_radius + bodies.clearance
        found = joint_candidates(world, position, fans, alone, keep, arms)
        found = jax.tree.map(lambda leaf: leaf[:, 0], found)
        moved = bodies._replace(ends=fans.each(lambda c: c[..., 0]))
        contacts = count_between(position, moved, world.obstacles)
        return Smoothed(turned, found, contacts, found.feasible.all())

    all_of_them = jax.lax.map(each, means)
    kept = all_of_them.fine.at[-1].set(True)  # as it was: rounding alone can say otherwise
    return all_of_them._replace(fine=kept & (all_of_them.contacts == 0))
