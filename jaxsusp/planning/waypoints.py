"""A plan through given waypoints, laid on the smoothest path that stands, and checked."""

from collections.abc import Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.errors import InputError, require, require_count
from jaxsusp.mechanics.drives import moving
from jaxsusp.planning.motion.along import plan_along
from jaxsusp.planning.motion.drive import driven
from jaxsusp.planning.motion.smooth import smoothest
from jaxsusp.planning.motion.wanted import Wanted, as_wanted
from jaxsusp.planning.plan import Plan
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.suspension.rigging import ends_beside
from jaxsusp.trajectory.makima import makima
from jaxsusp.trajectory.timelaw import TimeLaw

FAR = 1e6
"""The greatest coordinate of waypoints and ends, in the task's own units."""


def plan_through(
    scenario: Scenario | Named,
    waypoints: Float[Array, "..."] | Sequence,
    ends: Float[Array, "..."] | Sequence | None = None,
    samples: int = 40,
    *,
    elbow_up: Any = None,
    settings: Mapping[str, Any] | None = None,
    duration: str | int | float | None = None,
    calm: bool = False,
    smooth: bool = True,
) -> Plan:
    """The plan that goes through given waypoints, checked.

    Its path is the smoothest one near Makima's curve through them that keeps what that one keeps,
    see `motion.smooth`, and is driven with the minimum-jerk law or what else is asked for.

    Args:
        scenario: the task, or its name or file.
        waypoints: (m, 3), positions of the load's centre between start and goal (m).
        ends: upper cable ends (m): (K, 3), or (n, K, 3) beside the samples of the path in a drive
            mode that moves them; default the scenario's, moved by the plain rule of its mode.
        samples: number n of samples of the path and of the plan.
        elbow_up: of every robot; default chosen, see `jaxsusp.suspension.armclearance`.
        settings: kept with the plan.
        duration: seconds from rest to rest, default the scenario's; or "shortest": as short as
            limits allow. A swing of the load is limited, but nothing is played here.
        calm: whether the law is shaped so that nothing swings on at the goal.
        smooth: whether the path may leave Makima's samples to be smoother; where not, a plan shows
            what was searched.

    Returns:
        A `Plan`, feasible or with reasons.

    Raises:
        InputError: shapes that do not fit, numbers that are not finite, or a system that planning
            does not cover.
    """
    asked, wanted = as_wanted(load_scenario(scenario), duration, calm)
    scenario = asked.own
    require_rule(scenario)
    require_count("samples", samples, least=3)
    waypoints = _points("waypoints", waypoints, asked.units)
    require(len(waypoints) > 0, "waypoints: none given; give one or more")
    beside = None if ends is None else _end_path(asked, ends, samples)
    if elbow_up is not None:
        elbow_up = np.array(elbow_up, bool)
        require(
            elbow_up.shape == (len(scenario.robots),),
            f"elbow_up: got shape {elbow_up.shape}; give one truth value per robot",
        )
    found = laid(scenario, waypoints, beside, samples, wanted, elbow_up, settings, smooth)
    return found.stated(asked)


def laid(
    scenario: Scenario,
    waypoints: Float[np.ndarray, "waypoints xyz"],
    ends: Float[np.ndarray, "*rows cables xyz"] | None,
    samples: int,
    wanted: Wanted,
    elbow_up: Any = None,
    settings: Mapping[str, Any] | None = None,
    smooth: bool = True,
) -> Plan:
    """The same of what is right already, all in own units."""
    path = sample_path(scenario, waypoints, samples)
    rule = ends_beside(scenario, path) if ends is None else ends.reshape(-1, *ends.shape[-2:])
    law = TimeLaw.through(path, scenario.task.duration)
    found = plan_along(scenario, waypoints, law, rule, elbow_up, settings)
    return smoothest(found, lambda plan: driven(plan, wanted)) if smooth else driven(found, wanted)


def sample_path(scenario: Scenario, waypoints: np.ndarray, samples: int) -> np.ndarray:
    """Makima samples (n, 3) through start, waypoints and goal, float64."""
    knots = np.vstack([scenario.task.start, waypoints, scenario.task.goal])
    with jax.enable_x64(True):
        return np.asarray(_makima(jnp.asarray(knots), samples))


_makima = jax.jit(makima, static_argnums=1)


def _end_path(scenario: Scenario, given: Any, samples: int) -> np.ndarray:
    """Ends as rows beside the path in own units, as many as the drive mode asks for."""
    ends, count = _numbers("ends", given), len(scenario.robots)
    if not moving(scenario.drive):
        shape, what = (count, 3), "give one per robot"
    else:
        shape = samples, count, 3
        what = f'drive = "{scenario.drive}" moves them; give one per sample and robot'
    require(
        ends.shape == shape,
        f"ends: got an array of shape {ends.shape} for {count} robots; {what}: shape {shape}, in m",
    )
    return _near("ends", scenario.units.inside(ends), scenario.units).reshape(-1, count, 3)


def _points(name: str, given: Any, units: Frame) -> np.ndarray:
    """Positions (rows of x, y, z) in own units from what a person gave."""
    points = _numbers(name, given)
    require(
        points.ndim == 2 and points.shape[1] == 3,
        f"{name}: got an array of shape {points.shape}; give positions (rows of x, y, z) in m",
    )
    return _near(name, units.inside(points), units)


def _near(name: str, places: np.ndarray, units: Frame) -> np.ndarray:
    """Places of which a plan can be made."""
    wrong = places[~(np.abs(places) <= FAR)]
    require(
        wrong.size == 0,
        f"{name}: has {units.number(wrong[:1], 'm')} in it, from the middle of the robots' bases; "
        f"give finite numbers up to {units.number(FAR, 'm'):g} m",
    )
    return places


def _numbers(name: str, given: Any) -> np.ndarray:
    """An array of numbers."""
    try:
        return np.array(given, np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: is no array of numbers; give rows of x, y, z in m") from None
