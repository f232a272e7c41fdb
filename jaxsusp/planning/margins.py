"""What a search keeps beyond what is asked for, so that the real curve keeps what is asked for."""

from typing import Any

import jax
import numpy as np

from jaxsusp._types import Float
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.planning.feasibility import static_tensions
from jaxsusp.scenario.ownunits import TOUCH
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import World, build_world, lowest, rounded_counts
from jaxsusp.suspension.levelload import ends_at
from jaxsusp.vec3 import Vec3

MARGIN = 0.015
"""m; a search keeps so much more than the clearance asked for, as far as start and goal allow: the
smooth curve departs from the polyline that the search checks by as much at most."""

TENSION_MARGIN = (5.0, 3.0)
"""N by which a search draws the lower and the upper tension limit in, as far as start and goal
allow: inertia takes and adds on the real curve, and a cable with little tension is easily upset."""

SNUG = 1 / 8
"""Share of the margins that is tried first where ends stay: margins cost fitness, most curves need
hardly any, and every plan is checked."""


def with_ends_at(scenario: Scenario, ends: Float[np.ndarray, "cables xyz"]) -> Scenario:
    """The same task with other ends; not validated: the checks of the plan decide."""
    robots = tuple(
        robot.model_copy(update={"end": tuple(map(float, end))})
        for robot, end in zip(scenario.robots, ends, strict=True)
    )
    return scenario.model_copy(update={"robots": robots})


def with_margins(scenario: Scenario, moving_ends: bool = False, share: float = 1.0) -> Scenario:
    """The task with stricter limits, by a share of the margins, as start and goal allow."""
    limits = scenario.limits
    low, high = limits.tension
    task = np.array([scenario.task.start, scenario.task.goal], np.float64)
    below, above = (share * each for each in TENSION_MARGIN)
    if not moving_ends:
        held = static_tensions(scenario, task)
        below = min(below, 0.8 * float(held.min() - low))
        above = min(above, 0.8 * float(high - held.max()))
    below, above = (min(max(room, 0.0), (high - low) / 10) for room in (below, above))
    tension = (low + below, high - above)
    margin = share * MARGIN
    scenario = _off_ground(scenario, margin)
    while margin > 1e-3:
        wider = _with_limits(scenario, clearance=limits.clearance + margin, tension=tension)
        if moving_ends or not _in_contact(wider):
            return wider
        margin /= 2
    return _with_limits(scenario, tension=tension)


def _off_ground(scenario: Scenario, margin: float) -> Scenario:
    """The ground as the bottom of the workspace, with a margin where it is above that.

    Start and goal may be as low as the ground allows.
    """
    (x, y, bottom), (_, _, floor) = scenario.workspace.lower, lowest(scenario)
    if floor > bottom + TOUCH:
        floor = min(floor + margin, scenario.task.start[2], scenario.task.goal[2])
    workspace = scenario.workspace.model_copy(update={"lower": (x, y, max(floor, bottom))})
    return scenario.model_copy(update={"workspace": workspace, "ground": "none"})


def _with_limits(scenario: Scenario, **changed: Any) -> Scenario:
    return scenario.model_copy(update={"limits": scenario.limits.model_copy(update=changed)})


def _in_contact(scenario: Scenario) -> bool:
    """Whether the load or a cable is in a warning area at start or goal, in single precision."""
    world = build_world(scenario, rounded_counts(scenario))
    world = jax.tree.map(lambda leaf: leaf if leaf.dtype == bool else np.float32(leaf), world)
    places = zip(world.start, world.goal, strict=True)
    still = [Vec3(*(np.array([c, c]) for c in place)) for place in zip(*places, strict=True)]
    return any(int(_count(world, place, scenario.drive)) > 0 for place in still)


@jax.jit(static_argnames="drive")
def _count(world: World, position: Vec3, drive: str):
    bodies = world.bodies._replace(ends=ends_at(world, position, drive))
    return count_collisions(position, bodies, world.obstacles)
