"""Fitness with a price on hard turns: what the search for a plan minimises.

Eq. 21 sums curvature over the path, so one sharp corner costs little; but taken at speed it makes
the load swing and the tensions depart from the plan. The price is on the centripetal acceleration
that the minimum-jerk law would give at the samples.
"""

from dataclasses import dataclass, field
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.problem.fitness import curvature, trajectory
from jaxsusp.problem.problem import Problem
from jaxsusp.problem.suspension import Suspension
from jaxsusp.scenario.world import cast_world
from jaxsusp.suspension.levelload import ends_at, tensions_at
from jaxsusp.vec3 import Vec3, norm

TURN = 0.1
"""m/s² that cost nothing. A load that turns with so much hangs 0.6 degrees off the vertical."""

SLACK_SHARE = 0.25
"""Where a cable has little tension T, only so much of T/m costs nothing: at 4 N and 10 kg as much
as `TURN`."""

PRICE = 5.0
"""Fitness per sample that turns with twice as much; grows with the square."""


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class Gentle:
    """The suspension's fitness plus the price of hard turns."""

    suspension: Suspension
    turn: float = field(default=TURN, metadata={"static": True})
    slack_share: float = field(default=SLACK_SHARE, metadata={"static": True})
    price: Any = PRICE  # a leaf: another price needs no other program

    def population(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        """Total of many decision vectors."""
        return self.suspension.population(x) + self._cost(x)

    def twin(self, x: Float[Array, "pop dim"], band) -> Float[Array, "pop"]:
        """As `population`, with depths in place of counts."""
        return self.suspension.twin(x, band) + self._cost(x)

    def _cost(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        world = cast_world(self.suspension.world, x.dtype)
        position = trajectory(world, x.T, self.suspension.samples)
        ends = ends_at(world, position, self.suspension.drive)
        tensions = jnp.stack(tensions_at(world, position, ends)[1]).min(axis=0)[1:-1]
        free = jnp.clip(self.slack_share * tensions / world.mass, 0.1 * self.turn, self.turn)
        excess = turning(position, world.duration) / free - 1
        return jnp.asarray(self.price, x.dtype) * (jnp.maximum(excess, 0) ** 2).sum(axis=0)

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """Total of one decision vector."""
        return self.population(x[None])[0]


def turning(position: Vec3, duration: Array) -> Float[Array, "interior *batch"]:
    """Centripetal acceleration (m/s²) at the interior samples of a path driven from rest to rest.

    Curvature times the square of the minimum-jerk law's speed, which is 15/8 · (4f(1-f))^⅔ of the
    mean speed where the share f of the length is covered (exact in the middle, up to a quarter too
    low near the ends, where it is small).
    """
    step = position.each(lambda c: c[1:] - c[:-1])
    covered = jnp.cumsum(norm(step), axis=0)
    whole = covered[-1:]
    share = covered[:-1] / jnp.where(whole > 0, whole, 1)
    speed = 1.875 * whole / duration * jnp.cbrt(4 * share * (1 - share)) ** 2
    return curvature(step) * speed**2


def gently(problem: Problem, price: float = PRICE) -> Problem:
    """The same problem with a price on hard turns; other problems as they are."""
    if not isinstance(problem.fitness, Suspension):
        return problem
    return problem.with_fitness(Gentle(problem.fitness, price=np.float32(price)))
