"""A plan through given waypoints, worked out and checked on the real curve.

All of a plan follows from a scenario, the waypoints, the ends and the arms' elbows.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.errors import InputError, require, require_count
from jaxsusp.mechanics.drives import moving
from jaxsusp.mechanics.posture.load import angles
from jaxsusp.planning.plan import Plan
from jaxsusp.scenario.ownunits import UNCHANGED, Frame
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.makima import makima
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.certificate import Certificate, certify
from jaxsusp.verify.constraints import TURN, Check, constraint_report

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
) -> Plan:
    """The plan that goes through given waypoints, checked.

    Args:
        scenario: the task, or its name or file.
        waypoints: (m, 3), positions of the load's centre between start and goal (m).
        ends: upper cable ends (m): (K, 3), or (n, K, 3) beside the samples of the path in a drive
            mode that moves them; default the scenario's, moved by the plain rule of its mode.
        samples: number n of samples of the path and of the plan.
        elbow_up: of every robot; default chosen, see `jaxsusp.suspension.armclearance`.
        settings: kept with the plan.

    Returns:
        A `Plan`, feasible or with reasons.

    Raises:
        InputError: shapes that do not fit, numbers that are not finite, or a system that planning
            does not cover.
    """
    asked = load_scenario(scenario)
    scenario = asked.own
    require_rule(scenario)
    require_count("samples", samples, least=3)
    waypoints = _points("waypoints", waypoints, asked.units)
    require(len(waypoints) > 0, "waypoints: none given; give one or more")
    path = sample_path(scenario, waypoints, samples)
    law = TimeLaw.through(path, scenario.task.duration)
    end_path = ends_beside(scenario, path) if ends is None else _end_path(asked, ends, samples)
    if elbow_up is not None:
        elbow_up = np.array(elbow_up, bool)
        require(
            elbow_up.shape == (len(scenario.robots),),
            f"elbow_up: got shape {elbow_up.shape}; give one truth value per robot",
        )
    rigging = Rigging.of(scenario, law, end_path, elbow_up)
    certificate = certify(rigging)
    report = constraint_report(rigging, certificate)
    reasons = tuple(_reasons(report, certificate, scenario.frame))
    times = np.linspace(0, law.duration, samples)
    along, loads = rigging.ends_at(law.parameter(times)), rigging.loads(times)
    return Plan(
        scenario,
        not reasons,
        reasons,
        waypoints,
        path,
        end_path,
        times,
        *law.at(times),
        loads.lengths,
        loads.tensions,
        _angles(loads.posture),
        along if rigging.moves else end_path[0],
        rigging.joints_at(along),
        report,
        certificate,
        dict(settings or {}),
    ).stated(asked)


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


def _angles(posture: np.ndarray) -> np.ndarray:
    with jax.enable_x64(True):
        return np.asarray(_angles_of(jnp.asarray(posture)))


_angles_of = jax.jit(jax.vmap(angles))


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


def _reasons(
    report: tuple[Check, ...], certificate: Certificate, frame: Frame = UNCHANGED
) -> list[str]:
    """What is wrong: limits, and the first time at which each pair comes too close.

    Args:
        report: of limits.
        certificate: of distances.
        frame: how their numbers become SI units.
    """
    found = [
        f"level is no equilibrium: {each.reason}" if each.name == TURN else each.reason
        for each in (line.stated(frame) for line in report)
        if not each.ok and not each.name.startswith("distance of")
    ]
    for contact in certificate.stated(frame).contacts:
        one, other = contact.bodies
        required = f"the {contact.required:.4g} m required"
        if contact.least <= 0:
            found.append(
                f"{one} hits {other}: it is nearer than {required} from {contact.time:.2f} s"
            )
        else:
            found.append(
                f"{one} comes as near as {contact.least:.4g} m to {other}, nearer than {required} "
                f"from {contact.time:.2f} s"
            )
    if not certificate.proved and not certificate.contacts:
        found.append(
            f"clearance was not proved after {certificate.distances} distances; move the path "
            "away from what it grazes"
        )
    return found
