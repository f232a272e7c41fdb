"""A plan: everything it takes to carry out a task, with the checks it went through.

All of it follows from a scenario, the waypoints, the ends and the arms' elbows; `plan_through`
works it out. A plan holds the results as well, so that it can be used without this package.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.coordination.arms import Posture, build_robots, postures
from jaxsusp.errors import InputError, require, require_count
from jaxsusp.mechanics import arm
from jaxsusp.problem import require_hook_with_three_cables
from jaxsusp.scenario import Scenario
from jaxsusp.trajectory.makima import makima
from jaxsusp.trajectory.timelaw import Motion, TimeLaw
from jaxsusp.verify.certificate import Certificate, certify
from jaxsusp.verify.limits import Check, cable_loads, constraint_report, with_ends
from jaxsusp.world import build_world, rounded_counts

DENSE = 4
"""Instants per sample at which arms are checked for the choice of their elbows."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A trajectory with all that belongs to it; host arrays, SI units, n samples, K cables.

    `feasible` means: the constraint report and the certificate found nothing wrong. Otherwise
    `reasons` says what.
    """

    scenario: Scenario
    feasible: bool
    reasons: tuple[str, ...]
    waypoints: Float[np.ndarray, "waypoints xyz"]
    path: Float[np.ndarray, "points xyz"]  # Makima samples that the smooth path goes through
    ends: Float[np.ndarray, "cables xyz"]
    times: Float[np.ndarray, "samples"]
    position: Float[np.ndarray, "samples xyz"]
    velocity: Float[np.ndarray, "samples xyz"]
    acceleration: Float[np.ndarray, "samples xyz"]
    jerk: Float[np.ndarray, "samples xyz"]
    lengths: Float[np.ndarray, "samples cables"]
    tensions: Float[np.ndarray, "samples cables"]  # with inertia
    joints: Float[np.ndarray, "samples cables joints"]
    report: tuple[Check, ...]
    certificate: Certificate
    settings: Mapping[str, Any] = field(default_factory=dict)  # how it was found; plain values

    @cached_property
    def law(self) -> TimeLaw:
        """The motion at any time."""
        return TimeLaw.through(self.path, self.scenario.task.duration)

    def at(self, times: Float[Array, "times"]) -> Motion:
        """Position, velocity, acceleration and jerk at any times (s)."""
        return self.law.at(np.asarray(times, np.float64))

    def cables_at(self, times: Float[Array, "times"]) -> tuple[np.ndarray, np.ndarray]:
        """Lengths (m) and tensions with inertia (N) at any times (s), each (times, K)."""
        motion = self.at(times)
        loads = cable_loads(self.scenario, self.ends, motion.position, motion.acceleration)
        return loads.lengths, loads.tensions

    @property
    def clearance(self) -> float:
        """Least exact distance of load, cables and arms to obstacles (m)."""
        kinds = ("load to obstacles", "cables to obstacles", "arms to obstacles")
        return min(each.value for each in self.certificate.clearances if each.kind in kinds)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the plan as JSON, see `jaxsusp.planfile`."""
        from jaxsusp.planfile import save

        save(self, path)

    def save_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the samples as CSV with the units in the column names."""
        from jaxsusp.planfile import save_csv

        save_csv(self, path)


def plan_through(
    scenario: Scenario,
    waypoints: Float[Array, "..."] | Sequence,
    ends: Float[Array, "..."] | Sequence | None = None,
    samples: int = 40,
    *,
    elbow_up: Any = None,
    settings: Mapping[str, Any] | None = None,
) -> Plan:
    """The plan that goes through given waypoints, checked.

    Args:
        scenario: the task.
        waypoints: (m, 3), positions of the load's centre between start and goal (m).
        ends: (K, 3), upper cable ends (m); default the scenario's.
        samples: number n of samples of the path and of the plan.
        elbow_up: of every robot; default chosen, see `jaxsusp.coordination.arms`.
        settings: kept with the plan.

    Returns:
        A `Plan`, feasible or with reasons.

    Raises:
        InputError: shapes that do not fit, numbers that are not finite, or a system that planning
            does not cover.
    """
    require_cable_driven(scenario)
    require_count("samples", samples, least=3)
    waypoints = _points("waypoints", waypoints)
    given = [robot.end for robot in scenario.robots] if ends is None else ends
    ends = _points("ends", given)
    require(
        len(ends) == len(scenario.robots),
        f"ends: got {len(ends)} for {len(scenario.robots)} robots; give one per robot",
    )
    require(len(waypoints) > 0, "waypoints: none given; give one or more")
    path = sample_path(scenario, waypoints, samples)
    law = TimeLaw.through(path, scenario.task.duration)
    posture = hold(scenario, law, ends, samples, elbow_up)
    certificate = certify(scenario, law, ends, posture.chains)
    report = constraint_report(scenario, law, ends, posture.joints, certificate)
    reasons = tuple(_reasons(report, certificate))
    times = np.linspace(0, scenario.task.duration, samples)
    motion = law.at(times)
    loads = cable_loads(scenario, ends, motion.position, motion.acceleration)
    return Plan(
        scenario,
        not reasons,
        reasons,
        waypoints,
        path,
        ends,
        times,
        *motion,
        loads.lengths,
        loads.tensions,
        np.tile(posture.joints, (samples, 1, 1)),
        report,
        certificate,
        dict(settings or {}),
    )


def sample_path(scenario: Scenario, waypoints: np.ndarray, samples: int) -> np.ndarray:
    """Makima samples (n, 3) through start, waypoints and goal, float64."""
    knots = np.vstack([scenario.task.start, waypoints, scenario.task.goal])
    with jax.enable_x64(True):
        return np.asarray(_makima(jnp.asarray(knots), samples))


_makima = jax.jit(makima, static_argnums=1)


def hold(scenario: Scenario, law: TimeLaw, ends, samples: int, elbow_up: Any = None) -> Posture:
    """How the arms hold the ends while the load passes; host arrays."""
    position = law.at(np.linspace(0, law.duration, DENSE * samples)).position
    with jax.enable_x64(True):
        ends = jnp.asarray(ends, jnp.float64)
        world = with_ends(build_world(scenario, rounded_counts(scenario)), ends)
        robots = build_robots(scenario)
        posture = postures(world, robots, jnp.asarray(position), ends)
        if elbow_up is None:
            return Posture(*map(np.asarray, posture))
        found = arm.inverse(robots.base, robots.links, ends)
        up = jnp.asarray(elbow_up, bool)
        joints = jnp.where(up[:, None], found.elbow_up, found.elbow_down)
        chains = arm.chain(robots.base, robots.links, joints)
        return Posture(np.asarray(joints), np.asarray(chains), np.asarray(posture.slack), up)


def require_cable_driven(scenario: Scenario) -> None:
    """Refuse what planning does not cover: ends that move, and other hangings."""
    require_hook_with_three_cables(scenario)
    require(
        scenario.drive == "cable",
        f'{scenario.name}: drive = "{scenario.drive}": planning moves the load by the lengths of '
        'its cables; give drive = "cable"',
    )


def _points(name: str, given: Any) -> np.ndarray:
    points = np.array(given, np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise InputError(
            f"{name}: got an array of shape {points.shape}; give finite positions (rows of x, y, "
            "z) in m"
        )
    return points


def _reasons(report: tuple[Check, ...], certificate: Certificate) -> list[str]:
    """What is wrong: limits, and the first time at which each pair comes too close."""
    found = [
        each.reason for each in report if not each.ok and not each.name.startswith("distance of")
    ]
    for contact in certificate.contacts:
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
