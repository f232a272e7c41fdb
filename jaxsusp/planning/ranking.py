"""What a plan is worth: how the planner tells a better one from a worse one."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.planning.margins import with_ends_at
from jaxsusp.planning.plan import Plan
from jaxsusp.problem.fitness import position_terms
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import World, build_world, cast_world, rounded_counts
from jaxsusp.vec3 import Vec3, pack_rows
from jaxsusp.verify.simulation import Simulation, simulate


def rank(plan: Plan) -> tuple:
    """For the order of plans: feasible ones first, then by what is least wrong, then by fitness.

    What only simulation is against comes before what limits are against, and both before contacts.
    """
    clear, played = plan.certificate.proved, plan.settings["simulated"]
    return not plan.feasible, not clear, not played, len(plan.reasons), plan.settings["fitness"]


def with_settings(plan: Plan, **settings: Any) -> Plan:
    """The plan with more of the settings it was found with."""
    return replace(plan, settings={**plan.settings, **settings})


def simulated(plan: Plan) -> tuple[Simulation, tuple[str, ...]]:
    """A plan as it is played, and what speaks against it: nothing where a load that swings follows.

    Args:
        plan: in own units.
    """
    seen, scenario = simulate(plan.rigging), plan.scenario
    return seen, tuple(seen.problems(scenario.limits, scenario.frame))


def seen_in(seen: Simulation, say: Frame) -> dict[str, Any]:
    """What simulation saw, as settings of a plan that was played.

    Args:
        seen: in own units.
        say: how its numbers become SI units.
    """
    return {
        "simulated": True,
        "tracking_error_m": say.number(seen.tracking_error, "m"),
        "tension_error": seen.tension_error,
    }


def simulated_problems(plan: Plan) -> tuple[str, ...]:
    """What speaks against a plan once it is played."""
    return simulated(plan)[1]


def fitness_of(
    scenario: Scenario,
    path: Float[np.ndarray, "samples xyz"],
    end_path: Float[np.ndarray, "rows cables xyz"],
) -> float:
    """Eq. 21 of what was searched, Makima's samples and the ends beside them, without any margin.

    In float64; the smooth path is another one, and not what algorithms are compared by.
    """
    moves = len(end_path) > 1
    moved = scenario if moves else with_ends_at(scenario, end_path[0])
    with jax.enable_x64(True):
        world = cast_world(build_world(moved, rounded_counts(moved)), np.float64)
        ends = pack_rows(jnp.asarray(end_path)) if moves else None
        with_stability = moved.limits.stability > 0
        position = Vec3.from_array(jnp.asarray(path))
        return float(_terms(world, position, with_stability, moved.drive, ends).total)


@jax.jit(static_argnums=(2, 3))
def _terms(world: World, position: Vec3, with_stability: bool, drive: str, ends: Vec3 | None):
    return position_terms(world, position, with_stability, drive, ends=ends)
