"""Can the load be held at all?  The answer before any search (Eq. 22, tensions)."""

from collections.abc import Iterable, Sequence
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import build_world, cast_world
from jaxsusp.suspension.cableloads import cable_loads
from jaxsusp.suspension.hanging import hanging_trouble
from jaxsusp.suspension.reach import AXIS, in_reach
from jaxsusp.suspension.rigging import ends_beside
from jaxsusp.vec3 import Vec3

GRID = (15, 15, 12)
"""Positions of the workspace that are looked at, per axis."""


class ImpossibleTaskError(InputError):
    """A task that no plan can carry out, with the limiting cable and position."""


def require_possible(scenario: Scenario, ends: str = "given") -> None:
    """Refuse a task whose start or goal no admissible tensions can hold.

    Args:
        scenario: the task.
        ends: "given" looks at the scenario's own ends; "placed" asks only for what holds with any
            ends: that K cables at their greatest tension lift the load.

    Raises:
        ImpossibleTaskError: with the place, the cable, its tension and the limit; and whether any
            other place in the workspace is better.
    """
    payload, (low, high) = scenario.payload, scenario.limits.tension
    weight, cables = payload.mass * GRAVITY, len(scenario.robots)
    if weight > cables * high:
        raise ImpossibleTaskError(
            f"{scenario.name}: the load weighs {weight:.5g} N and {cables} cables of at most "
            f"{high:g} N each cannot lift it anywhere; at task.goal "
            f"{in_words(scenario.task.goal)} even cable 1, pulling straight up, would need "
            f"{weight - (cables - 1) * high:.5g} N; lighten payload.mass or raise "
            "limits.tension[1]"
        )
    if ends == "placed":
        return
    for name, place in (("task.start", scenario.task.start), ("task.goal", scenario.task.goal)):
        if scenario.payload.attachments != "hook" and (trouble := hanging_trouble(scenario, place)):
            raise ImpossibleTaskError(
                f"{scenario.name}: no plan is possible: at {name} {in_words(place)} {trouble}; "
                "move the task, the ends or the attachments, or raise limits.posture_deg"
            )
        _require_reach(scenario, name, place)
        tensions = static_tensions(scenario, np.array([place], np.float64))[0]
        if worst := worst_tension(tensions, low, high):
            elsewhere = _elsewhere(scenario)
            raise ImpossibleTaskError(
                f"{scenario.name}: no plan is possible: at {name} {in_words(place)} {worst}"
                f"{elsewhere}; {_remedy(tensions, high)}"
            )


def _require_reach(scenario: Scenario, name: str, place: Sequence[float]) -> None:
    """Refuse a place where the plain rule of the drive mode puts an end out of its robot's reach.

    Bases that roll take their reach along; ends that stay were looked at with the scenario.
    """
    if scenario.drive not in ("end", "hybrid"):
        return
    ends = ends_beside(scenario, np.array([place], np.float64))[0]
    with jax.enable_x64(True):
        robots = cast_world(build_world(scenario), np.float64).robots
        for k, end in enumerate(ends):
            if in_reach(robots, k, Vec3(*map(jnp.asarray, end))):
                continue
            away = np.linalg.norm(end - np.asarray(robots.shoulder.to_array())[k])
            raise ImpossibleTaskError(
                f"{scenario.name}: no plan is possible: at {name} {in_words(place)} drive = "
                f'"{scenario.drive}" takes the end of robot {k + 1} to {in_words(end)}, '
                f"{away:.4g} m from its shoulder; its arm reaches {float(robots.nearest[k]):g} to "
                f"{float(robots.farthest[k]):g} m and keeps {AXIS:g} m off its own axis; move the "
                "task, the end or the base"
            )


def static_tensions(
    scenario: Scenario, position: Float[np.ndarray, "points xyz"]
) -> Float[np.ndarray, "points cables"]:
    """Tensions (N) of a load at rest; NaN where cables lie in a plane, or without equilibrium."""
    return cable_loads(scenario, position).static


def worst_tension(tensions: np.ndarray, low: float, high: float) -> str:
    """The cable that is furthest outside its limits, in words; "" if all are inside."""
    excess = np.maximum(tensions - high, low - tensions)
    excess = np.where(np.isnan(excess), np.inf, excess)
    k = int(excess.argmax())
    if excess[k] <= 0:
        return ""
    bound, which = (
        (high, "more than limits.tension[1]") if tensions[k] > high
        else (low, "less than limits.tension[0]")
    )  # fmt: skip
    return f"cable {k + 1} would have {tensions[k]:.5g} N, {which} = {bound:g} N"


def _elsewhere(scenario: Scenario) -> str:
    """What the rest of the workspace offers."""
    low, high = scenario.limits.tension
    box = scenario.workspace
    axes = [np.linspace(*ends) for ends in zip(box.lower, box.upper, GRID, strict=True)]
    grid = np.array(list(product(*axes)))
    tensions = static_tensions(scenario, grid)
    excess = np.maximum(tensions - high, low - tensions).max(axis=1)
    excess = np.where(np.isfinite(excess), excess, np.inf)
    at = int(excess.argmin())
    if excess[at] <= 0:
        return f" (it can be held elsewhere, most easily near {in_words(grid[at])})"
    return (
        f", and nowhere in the workspace are all tensions within their limits: the best place is "
        f"{in_words(grid[at])}, where {worst_tension(tensions[at], low, high)}"
    )


def _remedy(tensions: np.ndarray, high: float) -> str:
    if tensions.max() > high:
        return "lighten payload.mass, raise the ends, or raise limits.tension[1]"
    return 'move the task or the ends, lower limits.tension[0], or let ends = "placed"'


def in_words(point: Iterable[float]) -> str:
    """A place for people, (x, y, z) in m."""
    return f"({', '.join(f'{coordinate:.4g}' for coordinate in point)})"
