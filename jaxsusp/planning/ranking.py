"""What a plan is worth: how the planner tells a better one from a worse one."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.planning.margins import with_ends_at
from jaxsusp.planning.plan import Plan
from jaxsusp.problem.fitness import position_terms
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import World, build_world, cast_world, rounded_counts
from jaxsusp.vec3 import Vec3, pack_rows
from jaxsusp.verify.simulation import simulate

GENTLE_TILT, GENTLE_TENSION = 0.3, 10.0
"""Degrees of tilt up to which, and N of tension from which on, a load is taken to follow its plan
without being simulated."""


def good(plan: Plan) -> bool:
    """Whether a plan leaves nothing to wish for: feasible, and a swinging load follows it."""
    return plan.feasible and plan.settings["tracked"]


def rank(plan: Plan) -> tuple:
    """For the order of plans: feasible ones first, then tracked ones, then by fitness."""
    settings = plan.settings
    return not plan.feasible, len(plan.reasons), not settings["tracked"], settings["fitness"]


def with_settings(plan: Plan, **settings: Any) -> Plan:
    """The plan with more of the settings it was found with."""
    return replace(plan, settings={**plan.settings, **settings})


def tracks(plan: Plan) -> bool:
    """Whether a load that swings stays with the plan: simulated, unless it hardly accelerates."""
    values = {each.name: each.value for each in plan.report}
    gentle = values.get("tilt of the load", np.inf) <= GENTLE_TILT and not plan.rigging.moves
    taut = values["least tension"] >= GENTLE_TENSION
    return (gentle and taut) or not simulate(plan.rigging).problems(plan.scenario.limits)


def fitness_of(scenario: Scenario, found: Plan) -> float:
    """Eq. 21 of a plan in float64, without any margin."""
    moved = scenario if found.rigging.moves else with_ends_at(scenario, found.ends)
    with jax.enable_x64(True):
        world = cast_world(build_world(moved, rounded_counts(moved)), np.float64)
        ends = pack_rows(jnp.asarray(found.end_path)) if found.rigging.moves else None
        with_stability = moved.limits.stability > 0
        position = Vec3.from_array(jnp.asarray(found.path))
        return float(_terms(world, position, with_stability, moved.drive, ends).total)


@jax.jit(static_argnums=(2, 3))
def _terms(world: World, position: Vec3, with_stability: bool, drive: str, ends: Vec3 | None):
    return position_terms(world, position, with_stability, drive, ends=ends)
