"""A plan along a given path with a given law, worked out and checked on the real curve.

All of a plan follows from a scenario, the points of the path, the law, the ends and the elbows.
"""

from collections.abc import Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.mechanics.posture.load import angles
from jaxsusp.planning.plan import Plan
from jaxsusp.scenario.ownunits import UNCHANGED, Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.certificate import Certificate, certify
from jaxsusp.verify.constraints import TURN, Check
from jaxsusp.verify.report import constraint_report


def plan_along(
    scenario: Scenario,
    waypoints: Float[np.ndarray, "waypoints xyz"],
    law: TimeLaw,
    end_path: Float[np.ndarray, "rows cables xyz"],
    elbow_up: Any = None,
    settings: Mapping[str, Any] | None = None,
) -> Plan:
    """The plan that drives a path with a law, checked; everything in the task's own units.

    Args:
        scenario: the task, in its own units.
        waypoints: whence the path came (m); kept with the plan.
        law: the path and when the load is where on it.
        end_path: ends beside the points of the path (m); one row where they stay.
        elbow_up: of every robot; default chosen, see `jaxsusp.suspension.armclearance`.
        settings: kept with the plan.

    Returns:
        A `Plan`, feasible or with reasons.
    """
    rigging = Rigging.of(scenario, law, end_path, elbow_up)
    return plan_of(rigging, waypoints, certify(rigging), settings)


def plan_of(
    rigging: Rigging,
    waypoints: Float[np.ndarray, "waypoints xyz"],
    certificate: Certificate,
    settings: Mapping[str, Any] | None = None,
) -> Plan:
    """The plan of a system in own units whose distances along the path are known already.

    A certificate speaks of the path, whatever the law; only its times are those of a law.
    """
    scenario, law = rigging.scenario, rigging.law
    report = constraint_report(rigging, certificate)
    reasons = tuple(_reasons(report, certificate, scenario.frame))
    times = np.linspace(0, law.duration, len(law.path.points))
    along, loads = rigging.ends_at(law.parameter(times)), rigging.loads(times)
    return Plan(
        scenario,
        not reasons,
        reasons,
        waypoints,
        law.path.points,
        rigging.end_path,
        *law.states,
        times,
        *law.at(times),
        loads.lengths,
        loads.tensions,
        _angles(loads.posture),
        along if rigging.moves else rigging.end_path[0],
        rigging.joints_at(along),
        report,
        certificate,
        dict(settings or {}),
    )


def _angles(posture: np.ndarray) -> np.ndarray:
    with jax.enable_x64(True):
        return np.asarray(_angles_of(jnp.asarray(posture)))


_angles_of = jax.jit(jax.vmap(angles))


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
