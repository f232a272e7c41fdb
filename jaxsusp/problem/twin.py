"""A smooth twin of the fitness: what Eq. 21 counts, by how deep it goes.

f6 counts contacts and violations, and is level wherever their number stays the same. The twin puts
a price on depths instead: how far bodies are within each other in the same swept tests, and how far
quantities are beyond their limits. Where nothing is counted it equals the fitness, and everywhere
its gradient leads out of what is wrong.
"""

from typing import NamedTuple

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.geometry.penetration import charge, sum_depths
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem.choices import CONTACTS
from jaxsusp.problem.constraints import SINGLE_PRECISION_STABILITY, WORKSPACE_TOLERANCE
from jaxsusp.problem.fitness import SampledPath, sampled_path, trajectory, weighted
from jaxsusp.scenario.world import World
from jaxsusp.suspension.armclearance import arm_excess
from jaxsusp.suspension.levelload import (
    SINGLE_PRECISION_TENSION,
    bases_at,
    drawn_in,
    stability_of,
    turn_at,
)
from jaxsusp.suspension.reach import SINGLE_PRECISION_LENGTH, misplacement
from jaxsusp.vec3 import Vec3


class Unit(NamedTuple):
    """What costs as much as one contact or violation does in the fitness: κ."""

    length: Array  # m
    tension: Array  # N
    angle: float = 0.1  # rad
    stability: float = 0.1

    @classmethod
    def of(cls, world: World) -> "Unit":
        """The load's radius, and a tenth of the range of tensions."""
        limits = world.limits
        return cls(
            jnp.asarray(world.bodies.radius),
            jnp.asarray(0.1 * (limits.tension_high - limits.tension_low)),
        )


def twin_fitness(
    world: World,
    x: Float[Array, "dim *batch"],
    samples: int,
    with_stability: bool = False,
    drive: str = "cable",
    with_cables: bool = True,
    contacts: str = CONTACTS[0],
    band: Float[Array, ""] | float = 0.0,
) -> Float[Array, "*batch"]:
    """The fitness with depths in place of counts.

    Args:
        world: the scenario, in the dtype of x.
        x: decision vector, m; trailing axes are batch.
        samples: number of trajectory samples n.
        with_stability: whether S_cmin is a limit.
        drive: how the ends follow the load.
        with_cables: whether cables and arms count, or the load alone.
        contacts: one of `CONTACTS`.
        band: share of a `Unit` within which what is clear costs already, see `charge`.
    """
    path, unit = sampled_path(world, trajectory(world, x, samples), drive), Unit.of(world)

    def price(depth: Array) -> Array:
        return charge(depth / unit.length, band)

    bodies = path.avoiding(world, with_cables)
    at_samples = contacts == "sampled"
    amount = sum_depths(path.position, bodies, world.obstacles, unit.length, band, at_samples)
    for excess in _limits(world, path, unit, with_stability):
        amount += charge(excess, band).sum(axis=0)
    if moving(drive):
        if with_cables:
            bases = bases_at(world, path.ends, drive)
            for excess in misplacement(world, path.ends, drive):
                amount += price(excess).sum(axis=0)
            amount += _arms(world, path, bases, price)
    elif world.bodies.attachments.x.shape[0] > 1:
        excess = turn_at(world, path.position, path.tensions) - world.limits.posture
        amount += charge(excess / unit.angle, band).sum(axis=0)
    return weighted(world, (*path.smooth_terms(world), world.kappa * amount))


def _limits(world: World, path: SampledPath, unit: Unit, with_stability: bool) -> list[Array]:
    """Excess over the limits of Eq. 22 at the samples, in shares of a unit."""
    limits, position = world.limits, path.position
    single = position.x.dtype == jnp.float32
    margin = SINGLE_PRECISION_LENGTH if single else 0.0
    low, high = drawn_in(limits, SINGLE_PRECISION_TENSION if single else 0.0)
    found = []
    for length, tension in zip(path.lengths, path.tensions, strict=True):
        found.append(jnp.maximum(low - tension, tension - high) / unit.tension)
        short, long = limits.length_low + margin, limits.length_high - margin
        found.append(jnp.maximum(short - length, length - long) / unit.length)
    reach = WORKSPACE_TOLERANCE - margin
    for at, lower, upper in zip(
        position, world.lower._replace(z=world.floor), world.upper, strict=True
    ):
        found.append((jnp.maximum(lower - at, at - upper) - reach) / unit.length)
    if with_stability:
        extra = SINGLE_PRECISION_STABILITY if single else 0.0
        found_stability = stability_of(world, position, path.tensions, path.ends)
        lacking = limits.stability + extra - found_stability
        found.append(jnp.where(limits.stability > 0, lacking / unit.stability, -jnp.inf))
    return found


def _arms(world: World, path: SampledPath, bases: Vec3, price) -> Array:
    """Arms that are too close to something, each with the elbow that is less in the way."""
    excess = arm_excess(world, path.position, path.ends, bases)  # (elbows, robots, samples, batch)
    return price(excess).sum(axis=2).min(axis=0).sum(axis=0)
