"""Can the load be held at all?  The answer before any search (Eq. 22: tensions and lengths)."""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.scenario.ownunits import TOUCH
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


class Trouble(NamedTuple):
    """Why a task is impossible whatever the way."""

    kind: str  # "tensions", "lengths", "posture" or "reach"
    text: str  # for people


def require_possible(scenario: Scenario, ends: str = "given") -> None:
    """Refuse a task whose load cannot be held at start or goal within the limits of its cables.

    Args:
        scenario: the task.
        ends: "given" looks at the scenario's own ends; "placed" asks only for what holds with any
            ends: that K cables at their greatest tension lift the load.

    Raises:
        ImpossibleTaskError: with the place, the cable, its tension or length and the limit; and
            whether any other place in the workspace is better.
    """
    if found := trouble(scenario, ends):
        raise ImpossibleTaskError(found.text)


def trouble(scenario: Scenario, ends: str = "given") -> Trouble | None:
    """What `require_possible` refuses a task for; None where it does not."""
    if found := _too_heavy(scenario):
        return found
    if ends == "placed":
        return None
    for name, place in (("task.start", scenario.task.start), ("task.goal", scenario.task.goal)):
        where = f"{scenario.name}: no plan is possible: at {name} {scenario.frame.words(place)}"
        for check in (_hanging, _reach, _tensions, _lengths):
            if found := check(scenario, place):
                return found._replace(text=f"{where} {found.text}")
    return None


def _too_heavy(scenario: Scenario) -> Trouble | None:
    """All cables at their greatest tension, straight up, do not lift the load."""
    weight, cables = scenario.payload.mass * GRAVITY, len(scenario.robots)
    high = scenario.limits.tension[1]
    if weight <= cables * high:
        return None
    each, all_of_them, heavy = scenario.frame.number(np.array([high, cables * high, weight]), "N")
    text = (
        f"{scenario.name}: no plan is possible: {cables} cables of at most {each:.5g} N lift "
        f"{all_of_them:.5g} N, and the load weighs {heavy:.5g} N; lighten payload.mass or raise "
        "limits.tension[1]"
    )
    return Trouble("tensions", text)


def _hanging(scenario: Scenario, place: Sequence[float]) -> Trouble | None:
    """A load on separate attachments that does not hang as planned."""
    if scenario.payload.attachments == "hook" or not (found := hanging_trouble(scenario, place)):
        return None
    remedy = "move the task, the ends or the attachments, or raise limits.posture_deg"
    return Trouble("posture", f"{found}; {remedy}")


def _tensions(scenario: Scenario, place: Sequence[float]) -> Trouble | None:
    tensions = static_tensions(scenario, np.array([place], np.float64))[0]
    if not (worst := worst_tension(scenario, tensions)):
        return None
    remedy = _remedy(tensions, scenario.limits.tension[1])
    return Trouble("tensions", f"{worst}{_elsewhere(scenario)}; {remedy}")


def _lengths(scenario: Scenario, place: Sequence[float]) -> Trouble | None:
    found = cable_loads(scenario, np.array([place], np.float64)).lengths[0]
    limits = scenario.limits.cable_length
    if not (_excess(found, *limits) > TOUCH).any():
        return None
    lengths, (low, high) = (scenario.frame.number(np.array(each), "m") for each in (found, limits))
    k, bound, which = _furthest(lengths, low, high, "limits.cable_length")
    text = f"cable {k + 1} would be {lengths[k]:.5g} m long, {which} = {bound:g} m"
    remedy = 'move the task or the ends, widen limits.cable_length, or let ends = "placed"'
    return Trouble("lengths", f"{text}; {remedy}")


def _reach(scenario: Scenario, place: Sequence[float]) -> Trouble | None:
    """A place where the plain rule of the drive mode puts an end out of its robot's reach.

    Bases that roll take their reach along; ends that stay were looked at with the scenario.
    """
    if scenario.drive not in ("end", "hybrid"):
        return None
    ends, say = ends_beside(scenario, np.array([place], np.float64))[0], scenario.frame
    with jax.enable_x64(True):
        robots = cast_world(build_world(scenario), np.float64).robots
        for k, end in enumerate(ends):
            if in_reach(robots, k, Vec3(*map(jnp.asarray, end))):
                continue
            away = np.linalg.norm(end - np.asarray(robots.shoulder.to_array())[k])
            lengths = (away, float(robots.nearest[k]), float(robots.farthest[k]), AXIS)
            away, nearest, farthest, axis = (say.number(each, "m") for each in lengths)
            text = (
                f'drive = "{scenario.drive}" takes the end of robot {k + 1} to {say.words(end)}, '
                f"{away:.4g} m from its shoulder; its arm reaches {nearest:g} to "
                f"{farthest:g} m and keeps {axis:g} m off its own axis; move the "
                "task, the end or the base"
            )
            return Trouble("reach", text)
    return None


def static_tensions(
    scenario: Scenario, position: Float[np.ndarray, "points xyz"]
) -> Float[np.ndarray, "points cables"]:
    """Tensions (N) of a load at rest; NaN where cables lie in a plane, or without equilibrium."""
    return cable_loads(scenario, position).static


def worst_tension(scenario: Scenario, tensions: np.ndarray) -> str:
    """The cable that is furthest outside its limits, in words; "" if all are inside."""
    tensions, (low, high) = (
        scenario.frame.number(np.asarray(each), "N") for each in (tensions, scenario.limits.tension)
    )
    if not (_excess(tensions, low, high) > 0).any():
        return ""
    k, bound, which = _furthest(tensions, low, high, "limits.tension")
    return f"cable {k + 1} would have {tensions[k]:.5g} N, {which} = {bound:g} N"


def _excess(values: np.ndarray, low: float, high: float) -> np.ndarray:
    """By how much values are outside their limits; NaN is the worst of all."""
    return np.nan_to_num(np.maximum(values - high, low - values), nan=np.inf)


def _furthest(values: np.ndarray, low: float, high: float, key: str) -> tuple[int, float, str]:
    """The value that is furthest outside its limits, the limit, and what it is, in words."""
    k = int(_excess(values, low, high).argmax())
    return (k, high, f"more than {key}[1]") if values[k] > high else (k, low, f"less than {key}[0]")


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
        where = scenario.frame.words(grid[at])
        return f" (it can be held elsewhere, most easily near {where})"
    return (
        f", and nowhere in the workspace are all tensions within their limits: the best place is "
        f"{scenario.frame.words(grid[at])}, where {worst_tension(scenario, tensions[at])}"
    )


def _remedy(tensions: np.ndarray, high: float) -> str:
    if tensions.max() > high:
        return "lighten payload.mass, raise the ends, or raise limits.tension[1]"
    return 'move the task or the ends, lower limits.tension[0], or let ends = "placed"'
