"""Placement of the cables' upper ends: Tables 2 and 3 of the paper (Sect. 3.3).

The ends share one height; with their horizontal positions that makes 2K + 1 variables. They are
placed to minimise f3 + f4 of a given load trajectory (and jointly with it: D = 3m + 2K + 1),
subject to tensions, cable lengths, clearance of cables and arms, and separation of the robots. Any
population algorithm of the package solves it, batched over runs like the load problem.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.errors import InputError, require_counts, require_seed
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.mechanics.drives import moving
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.refine import refine
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.problem.constraints import count_turned, count_violations
from jaxsusp.problem.fitness import fitness_terms, tension_length_rate, trajectory
from jaxsusp.problem.problem import Problem, stack_problems
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.scenario.world import Robots, World, build_world, cast_world, rounded_counts
from jaxsusp.suspension.armclearance import ARM_MARGIN, choose_postures, separation_slack
from jaxsusp.suspension.levelload import tensions_at, turn_at
from jaxsusp.vec3 import Vec3

HEIGHTS = (4.2, 8.8)
"""Heights, in the task's own units, in which ends are placed, as far as every robot reaches; the
paper gives none."""

INSIDE_REACH = 1e-3
"""m by which placed ends stay inside the reach, so that rounding cannot put them outside."""


class EndValue(NamedTuple):
    """What a placement is judged by."""

    cable: Float[Array, ""]  # f3, m
    tension_rate: Float[Array, ""]  # f4, N m/s²
    faults: Array  # collisions, violated limits, arms and robots too close
    total: Float[Array, ""]


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class EndFitness:
    """f3 + f4 + κ · faults of (z, x1, y1, x2, …) for a given load trajectory."""

    world: World
    position: Any  # (samples, xyz), m; a leaf of a pytree: may be stacked, or a placeholder

    def terms(self, x: Float[Array, "dim"]) -> EndValue:
        """All that a placement is judged by, in the dtype of x."""
        world = cast_world(self.world, x.dtype)
        ends = decode(world.robots, x)
        world = world._replace(bodies=world.bodies._replace(ends=Vec3.from_array(ends)))
        position = Vec3.from_array(jnp.asarray(self.position, x.dtype))
        lengths, tensions = tensions_at(world, position)
        interval = world.duration / (len(self.position) - 1)
        counts = [
            count_collisions(position, world.bodies, world.obstacles),
            count_violations(world, position, lengths, tensions, with_stability=True),
            arm_faults(world, position, ends),
        ]
        if len(world.bodies.attachments.x) > 1:
            counts.append(count_turned(world, turn_at(world, position, tensions)))
        faults = jnp.stack([count.astype(jnp.int32) for count in counts]).sum()
        cable = jnp.stack([length.max() for length in lengths]).sum()
        rate = tension_length_rate(lengths, tensions, interval)
        total = world.weights[2] * cable + world.weights[3] * rate
        return EndValue(cable, rate, faults, total + world.kappa * faults.astype(x.dtype))

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """What is minimised."""
        return self.terms(x).total


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class JointFitness:
    """Eq. 21 of waypoints and ends at once: x holds 3m coordinates, then 2K + 1."""

    world: World
    samples: int = field(metadata={"static": True})

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """All terms of Eq. 21 for these ends, and κ per arm that is in the way."""
        world = cast_world(self.world, x.dtype)
        waypoints, placed = self.split(x)
        ends = decode(world.robots, placed)
        world = world._replace(bodies=world.bodies._replace(ends=Vec3.from_array(ends)))
        terms = fitness_terms(world, waypoints, self.samples, with_stability=True)
        position = trajectory(world, waypoints, self.samples)
        faults = arm_faults(world, position, ends)
        return terms.total + world.kappa * faults.astype(x.dtype)

    def split(self, x: Float[Array, "*batch dim"]) -> tuple[Array, Array]:
        """Waypoint variables and end variables."""
        ends = 2 * self.world.cables + 1
        return x[..., :-ends], x[..., -ends:]


def arm_faults(world: World, position: Vec3, ends: Array) -> Array:
    """Arms that come too close to something, and robots that come too close to each other."""
    posture = choose_postures(world, position, ends)
    apart = separation_slack(world, posture.chains)
    arms = (posture.slack < ARM_MARGIN).sum(dtype=jnp.int32)
    return arms + (apart < ARM_MARGIN).astype(jnp.int32)


def decode(robots: Robots, x: Float[Array, "dim"]) -> Float[Array, "cables xyz"]:
    """Variables → ends, each moved horizontally into its robot's reach at the common height."""
    height, level = x[0], x[1:].reshape(-1, 2)
    offset = level - robots.base[:, :2]
    radius = jnp.sqrt((offset**2).sum(axis=-1))
    rise = height - robots.links[:, 0]
    near, far = _annulus(robots.links, rise)
    wanted = jnp.clip(radius, near, far)
    outward = jnp.where(radius[:, None] > 0, offset, jnp.ones_like(offset) / 2**0.5)
    outward = outward * (wanted / jnp.where(radius > 0, radius, 1))[:, None]
    heights = jnp.broadcast_to(height, wanted.shape)
    return jnp.concatenate([robots.base[:, :2] + outward, heights[:, None]], axis=-1)


def _annulus(links: Array, rise: Array) -> tuple[Array, Array]:
    """Horizontal distances from the column between which an end can be held."""
    near = jnp.abs(links[:, 1] - links[:, 2]) + INSIDE_REACH
    far = links[:, 1] + links[:, 2] - INSIDE_REACH
    inner, outer = (jnp.sqrt(jnp.maximum(reach**2 - rise**2, 0)) for reach in (near, far))
    return inner, outer


def encode(ends: Float[Array, "cables xyz"]) -> Float[np.ndarray, "dim"]:
    """Ends → variables, at their mean height."""
    ends = np.asarray(ends, np.float64)
    return np.append(ends[:, 2].mean(), ends[:, :2].ravel())


def end_bounds(scenario: Scenario) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of the variables: heights every robot reaches, and the square around every reach.

    Raises:
        InputError: no height is in reach of all robots.
    """
    reaches = [(robot.base, robot.links) for robot in scenario.robots]
    lows = [base[2] + links[0] - links[1] - links[2] for base, links in reaches]
    highs = [base[2] + links[0] + links[1] + links[2] for base, links in reaches]
    low, high = max(HEIGHTS[0], *lows), min(HEIGHTS[1], *highs) - 2 * INSIDE_REACH
    if low >= high:
        bottom, top = (scenario.frame.place([0, 0, height])[2] for height in HEIGHTS)
        raise InputError(
            f"{scenario.name}: ends are placed between {bottom:g} and {top:g} m, and no "
            "height there is in reach of every robot; change robots' links or bases"
        )
    center = np.array([base[:2] for base, _ in reaches])
    far = np.array([[links[1] + links[2]] * 2 for _, links in reaches])
    return np.append(low, center - far), np.append(high, center + far)


def require_placeable(scenario: Scenario) -> None:
    """Refuse systems whose ends do not stay where they are placed."""
    require_rule(scenario)
    if moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" moves the ends along with the load; '
            'give drive = "cable" to place them once, or let `moving_ends` choose their way'
        )


def load_way(position: Any) -> Float[np.ndarray, "samples xyz"]:
    """The load's positions that a person gave.

    Raises:
        InputError: not two or more rows of three finite numbers.
    """
    try:
        where = np.asarray(position, np.float64)
    except (TypeError, ValueError):
        raise InputError("position: is no array of numbers; give (samples, 3) of them") from None
    if where.ndim != 2 or where.shape[1] != 3 or len(where) < 2 or not np.isfinite(where).all():
        raise InputError(
            f"position of shape {where.shape}: give the load's way as (samples, 3) finite numbers"
        )
    return where


class Placement(NamedTuple):
    """Where the ends went, and what it is worth (float64)."""

    ends: Float[np.ndarray, "cables xyz"]
    lengths: Float[np.ndarray, "cables"]  # greatest length of every cable, m
    cable: float  # f3, m
    tension_rate: float  # f4, N m/s²
    faults: int

    def stated(self, units: Frame) -> "Placement":
        """The same, of a task in own units, with numbers as a scenario's units make them."""
        return self._replace(
            ends=units.place(self.ends),
            lengths=units.number(self.lengths, "m"),
            cable=units.number(self.cable, "m"),
            tension_rate=units.number(self.tension_rate, "N m/s²"),
        )


def place_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"] | Sequence,
    algorithm: str | AnyOptimizer = "sdbo",
    seed: int = 0,
    runs: int = 4,
    iterations: int = 200,
    population: int = 30,
    *,
    refined: bool = True,
) -> Placement:
    """Place the ends for a given load trajectory; the best of several runs.

    Args:
        scenario: robots, limits, obstacles.
        position: the load's centre at samples that are uniform in time (m).
        algorithm: name or optimiser.
        seed: root of all randomness.
        runs: independent runs.
        iterations: iterations per run.
        population: candidates per iteration.
        refined: whether the winners are refined locally (`jaxsusp.optim.refine`).

    Returns:
        A `Placement`; `faults` is 0 where every constraint is kept.

    Raises:
        InputError: bad settings, a drive mode that moves the ends, or robots that share no height.
    """
    require_placeable(scenario)
    require_counts(runs=runs, iterations=iterations, population=population)
    require_seed(seed)
    optimizer = algorithm_of(algorithm)
    problem = end_problem(scenario.own, scenario.units.inside(load_way(position)))
    outcome = run_batch(
        stack_problems([problem]), optimizer, seed, range(runs), iterations, population
    )
    found = outcome.x[0]
    if refined:
        found, _ = refine(problem, found, seed, iterations=100, candidates=32)
    values = [evaluate_ends(problem, x) for x in found]
    best = min(values, key=lambda each: (each.faults, each.cable + each.tension_rate))
    return best.stated(scenario.units)


def end_problem(scenario: Scenario, position) -> Problem:
    """The placement as a problem of 2K + 1 variables, in float32."""
    lower, upper = end_bounds(scenario)
    world = build_world(scenario, rounded_counts(scenario))
    fitness = EndFitness(world, np.asarray(position, np.float64))
    return Problem(fitness, lower.astype(np.float32), upper.astype(np.float32))


def joint_problem(scenario: Scenario, waypoints: int = 5, samples: int = 40) -> Problem:
    """Waypoints and ends as one problem, D = 3m + 2K + 1, in float32 and the task's own units."""
    scenario = scenario.own
    require_placeable(scenario)
    load = Problem.from_scenario(scenario, waypoints, samples, "box", dtype=np.float32)
    lower, upper = (bound.astype(np.float32) for bound in end_bounds(scenario))
    world = build_world(scenario, rounded_counts(scenario))
    fitness = JointFitness(world, samples)
    return Problem(
        fitness, np.append(load.lower, lower), np.append(load.upper, upper),
        np.append(load.reference, (lower + upper) / 2),
    )  # fmt: skip


def evaluate_ends(problem: Problem, x: Float[Array, "dim"]) -> Placement:
    """A placement's worth in float64."""
    fitness = problem.fitness
    assert isinstance(fitness, EndFitness)
    with jax.enable_x64(True):
        ends, lengths, value = jax.tree.map(np.asarray, _evaluate(fitness, jnp.asarray(x, float)))
    return Placement(
        ends, lengths, float(value.cable), float(value.tension_rate), int(value.faults)
    )


@jax.jit
def _evaluate(fitness: EndFitness, x):
    world = cast_world(fitness.world, x.dtype)
    ends = decode(world.robots, x)
    world = world._replace(bodies=world.bodies._replace(ends=Vec3.from_array(ends)))
    position = Vec3.from_array(jnp.asarray(fitness.position, x.dtype))
    lengths, _ = tensions_at(world, position)
    return ends, jnp.stack([length.max() for length in lengths]), fitness.terms(x)
