"""Fitness of a load trajectory: the six terms of Eq. 21.

Written for one trajectory with time on axis 0; any trailing axes are candidates of a batch. The
dtype of the decision vector decides the arithmetic.
"""

import functools
import operator
from collections.abc import Sequence
from typing import NamedTuple

import jax.numpy as jnp

from jaxsusp._types import Array, Float, Int
from jaxsusp.geometry.collisions import (
    Bodies,
    count_at_samples,
    count_between,
    count_collisions,
)
from jaxsusp.geometry.nearby import Nearby, count_nearby
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem.choices import CONTACTS
from jaxsusp.problem.constraints import count_turned, count_violations
from jaxsusp.scenario.world import World
from jaxsusp.suspension.armclearance import count_arm_contacts
from jaxsusp.suspension.levelload import bases_at, ends_at, stability_of, tensions_at, turn_at
from jaxsusp.suspension.reach import count_misplaced
from jaxsusp.trajectory.makima import makima
from jaxsusp.vec3 import Vec3, angle, norm

UNITS = {"length": "m", "height": "m", "cable": "m", "tension_rate": "N m/s²", "curvature": "1/m"}
"""Units of the terms of Eq. 21; the others have none."""


class FitnessTerms(NamedTuple):
    """All terms of Eq. 21, unweighted but for the penalty, and what they sum to.

    They are formed in a task's own units (see `jaxsusp.scenario.ownunits`), so that weights and κ
    have no unit and mean the same balance at every size: those named here are m, kg and s there.
    """

    length: Float[Array, "*batch"]  # f1, m
    height: Float[Array, "*batch"]  # f2, m, summed over samples
    cable: Float[Array, "*batch"]  # f3, m, sum over cables of the greatest length
    tension_rate: Float[Array, "*batch"]  # f4, N m/s², summed over cables and intervals
    curvature: Float[Array, "*batch"]  # f5, 1/m, summed over interior samples
    penalty: Float[Array, "*batch"]  # f6 = κ (n_p + n_g)
    collisions: Int[Array, "*batch"]  # n_p
    violations: Int[Array, "*batch"]  # n_g
    total: Float[Array, "*batch"]  # Σ w_i f_i

    @staticmethod
    def unit(term: str) -> str:
        """The unit of a term; f2 to f5 are sums over samples."""
        return UNITS.get(term, "1")


def trajectory(world: World, x: Float[Array, "dim *batch"], samples: int) -> Vec3:
    """Sampled load positions of a decision vector: Makima through start, waypoints and goal.

    Args:
        world: gives start and goal.
        x: m waypoints (x1, y1, z1, x2, …) on axis 0, m; trailing axes are batch.
        samples: number of samples n, uniform in the parameter, both ends included.

    Returns:
        Positions (m), samples on axis 0.
    """
    waypoints = x.reshape(-1, 3, *x.shape[1:])

    def coordinate(start, inner, goal):
        shape = (1, *inner.shape[1:])
        ends = [jnp.broadcast_to(end, shape).astype(x.dtype) for end in (start, goal)]
        return makima(jnp.concatenate([ends[0], inner, ends[1]]), samples)

    return Vec3(*(coordinate(world.start[i], waypoints[:, i], world.goal[i]) for i in range(3)))


def waypoint_stability(
    world: World, x: Float[Array, "dim *batch"], drive: str = "cable"
) -> Float[Array, "waypoints *batch"]:
    """S_c of every waypoint of a decision vector (Eq. 18)."""
    waypoints = x.reshape(-1, 3, *x.shape[1:])
    position = Vec3(*(waypoints[:, i] for i in range(3)))
    ends = ends_at(world, position, drive)
    return stability_of(world, position, tensions_at(world, position, ends)[1], ends)


def fitness_terms(
    world: World,
    x: Float[Array, "dim *batch"],
    samples: int,
    with_stability: bool = False,
    drive: str = "cable",
    with_cables: bool = True,
    contacts: str = CONTACTS[0],
    ends: Vec3 | None = None,
    nearby: Nearby | None = None,
) -> FitnessTerms:
    """All terms of Eq. 21 for the trajectory through the waypoints of x.

    Args:
        world: the scenario, in the dtype of x.
        x: decision vector, m; trailing axes are batch.
        samples: number of trajectory samples n.
        with_stability: whether S_cmin is checked among the violations.
        drive: how the ends follow the load, see `mechanics.drives`.
        with_cables: whether contacts of cables and arms and the places of moving ends count, or
            the load's contacts alone.
        contacts: where they are looked for, one of `CONTACTS`.
        ends: P_k (K, n) along the trajectory (m), where they do not follow the mode's plain rule;
            contacts are then counted by `count_between`.
        nearby: which obstacles can be touched from where, so that only those are tested; default
            that all of them are.
    """
    position = trajectory(world, x, samples)
    structure = with_stability, drive, with_cables, contacts
    return position_terms(world, position, *structure, ends, nearby)


def position_terms(
    world: World,
    position: Vec3,
    with_stability: bool = False,
    drive: str = "cable",
    with_cables: bool = True,
    contacts: str = CONTACTS[0],
    ends: Vec3 | None = None,
    nearby: Nearby | None = None,
) -> FitnessTerms:
    """All terms of Eq. 21 for sampled positions (m), whatever curve they are on.

    Args:
        world: the scenario, in the dtype of the positions.
        position: the load's centre, samples on axis 0; trailing axes are batch.
        with_stability: see `fitness_terms`, as the others.
        drive: how the ends follow the load.
        with_cables: whether cables and arms count.
        contacts: where they are looked for.
        ends: where they do not follow the mode's plain rule.
        nearby: which obstacles can be touched from where.
    """
    path = sampled_path(world, position, drive, ends)
    lengths, tensions = path.lengths, path.tensions
    count = count_collisions if ends is None else count_between
    if nearby is not None and ends is None:
        count = functools.partial(count_nearby, nearby=nearby)
    count = count_at_samples if contacts == "sampled" else count
    collisions = count(position, path.avoiding(world, with_cables), world.obstacles)
    violations = count_violations(world, position, lengths, tensions, with_stability, path.ends)
    if moving(drive):
        if with_cables:
            bases = bases_at(world, path.ends, drive)
            violations += count_misplaced(world, path.ends, drive)
            violations += count_arm_contacts(world, position, path.ends, bases)
    elif world.bodies.attachments.x.shape[0] > 1:
        violations += count_turned(world, turn_at(world, position, tensions))
    penalty = world.kappa * (collisions + violations).astype(position.x.dtype)
    terms = (*path.smooth_terms(world), penalty)
    return FitnessTerms._make((*terms, collisions, violations, weighted(world, terms)))


class SampledPath(NamedTuple):
    """A trajectory at its samples (axis 0; trailing axes are batch), and what holds the load."""

    position: Vec3  # of the load's centre, m
    ends: Vec3  # P_k, (K,) or (K, samples, …), m
    lengths: list[Array]  # l_k, m
    tensions: list[Array]  # T_k, N

    def avoiding(self, world: World, with_cables: bool = True) -> Bodies:
        """What must stay clear: the load with its cables, or alone."""
        ends = self.ends if with_cables else self.ends.each(lambda c: c[:0])
        return world.bodies._replace(ends=ends)

    def smooth_terms(self, world: World) -> tuple[Array, ...]:
        """f1 … f5 of Eq. 21, unweighted."""
        step = self.position.each(_difference)
        interval = world.duration / (self.position.x.shape[0] - 1)
        return (
            norm(step).sum(axis=0),
            jnp.abs(self.position.z - world.start.z).sum(axis=0),
            _add([length.max(axis=0) for length in self.lengths]),
            tension_length_rate(self.lengths, self.tensions, interval),
            _total_curvature(step),
        )


def sampled_path(world: World, position: Vec3, drive: str, ends: Vec3 | None = None) -> SampledPath:
    """Sampled positions, with ends, lengths and tensions along them."""
    ends = ends_at(world, position, drive) if ends is None else ends
    return SampledPath(position, ends, *tensions_at(world, position, ends))


def weighted(world: World, terms: Sequence[Array]) -> Array:
    """Σ w_i f_i."""
    return _add([world.weights[i] * term for i, term in enumerate(terms)])


def tension_length_rate(lengths: list[Array], tensions: list[Array], interval) -> Array:
    """f4 = Σ_k Σ_d |ΔT_k/dt · Δl_k/dt|, samples on axis 0.

    Our reading of Eq. 21, which prints ‖L_k‖‖L_k‖ in place of l_k and leaves the sign free.
    """
    rates = [
        jnp.abs(_difference(tension) * _difference(length))
        for tension, length in zip(tensions, lengths, strict=True)
    ]
    return _add(rates).sum(axis=0) / interval**2


def curvature(step: Vec3) -> Float[Array, "interior *batch"]:
    """Discrete curvature Δχ_d / L_{d+1} (1/m) at the interior samples of a polyline.

    Δχ is the angle between consecutive unit tangents. A segment of zero length contributes 0, with
    a finite gradient.

    Args:
        step: the polyline's segments p_{d+1} - p_d (m), along axis 0.
    """
    length = norm(step)
    moving = length > 0
    per_length = jnp.where(moving, 1 / jnp.where(moving, length, 1), 0)
    tangent = step * per_length
    before, after = tangent.each(lambda c: c[:-1]), tangent.each(lambda c: c[1:])
    turn = angle(before, after) * per_length[1:]
    return jnp.where(moving[:-1] & moving[1:], turn, 0)


def _total_curvature(step: Vec3) -> Array:
    """f5 = Σ_d Δχ_d / L_{d+1} over the interior samples."""
    return curvature(step).sum(axis=0)


def _add(arrays: Sequence[Array]) -> Array:
    return functools.reduce(operator.add, arrays)


def _difference(values: Array) -> Array:
    return values[1:] - values[:-1]
