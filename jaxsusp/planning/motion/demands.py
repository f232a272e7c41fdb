"""What limits the motion of a load that hangs at one point from ends that stay.

Its speed, acceleration and jerk, the speed of cables, the tilt of a load that rides along, and
tensions with inertia. At a hook the forces that cables can give within their limits,
{Σ T_k u_k : T_lo <= T_k <= T_hi}, are a body whose faces are normal to two of the cables each; of
three cables a face is a limit of the third one's tension. That is what the verification asks for:
more cables than three share their tensions within limits wherever that is possible at all.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.mechanics.drives import moving
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.scenario.models import Payload
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.fastest import Demands
from jaxsusp.verify.simulation import TRACKING

FOLLOWED = 0.8
"""Share of what a simulated load may be off its plan that a tilted load may use: a load that rides
an acceleration hangs aside from where a level one would be."""


def covered(scenario: Scenario) -> bool:
    """Whether the limits of a task's motion are all known here."""
    return scenario.payload.attachments == "hook" and not moving(scenario.drive)


def demands_along(
    rigging: Rigging, arc: Float[np.ndarray, "places"], followed: bool = True
) -> Demands:
    """What limits the motion at places of a path, in own units.

    Args:
        rigging: the system along its path.
        arc: places as arc lengths (m).
        followed: whether a load that swings has to follow, see `riding`.
    """
    scenario, path = rigging.scenario, rigging.law.path
    limits, payload = scenario.limits, scenario.payload
    u = path.parameter(arc)
    along, bend, twist = path.by_arc(u)
    cables = rigging.end_path[0] - (path.curve(u) + attachments_of(scenario)[0])[:, None]
    units = cables / np.linalg.norm(cables, axis=-1, keepdims=True)
    square = np.full(len(arc), np.inf if limits.speed is None else limits.speed**2)
    if limits.cable_speed is not None:
        rate = np.abs((units * along[:, None]).sum(axis=-1)).max(axis=1)
        square = np.minimum(square, (limits.cable_speed / np.maximum(rate, 1e-9)) ** 2)
    faces, room = _faces(units, *limits.tension)
    faces, force = payload.mass * faces, payload.mass * GRAVITY * faces[..., 2]
    ride = riding(scenario, followed)
    return Demands(
        arc, along, bend, twist, square, limits.acceleration or np.inf, ride.jerk, ride.snap,
        ride.tilt, GRAVITY, faces, room - force,
    )  # fmt: skip


def _faces(units: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Faces n · force <= room of the forces that cables give, (places, faces, xyz) and (N)."""
    normals = [
        np.cross(units[:, i], units[:, j]) for i, j in combinations(range(units.shape[1]), 2)
    ]
    faces = np.stack([sign * normal for normal in normals for sign in (1.0, -1.0)], axis=1)
    faces = faces / np.maximum(np.linalg.norm(faces, axis=-1, keepdims=True), 1e-12)
    pull = np.einsum("pfx,pkx->pfk", faces, units)
    return faces, np.maximum(low * pull, high * pull).sum(axis=-1)


class Riding(NamedTuple):
    """What keeps a load riding along, rather than swinging."""

    tilt: float  # greatest sideways acceleration per (g + upward acceleration)
    jerk: float  # m/s³
    snap: float  # m/s⁴


def riding(scenario: Scenario, followed: bool) -> Riding:
    """Limits of tilt, jerk and snap.

    A pendulum whose pivot's acceleration rises evenly over one of its periods rides along without
    swinging on; faster changes make it swing, slower ones cost time. Where no jerk is stated the
    load is therefore tilted to its limit within one swing at the fastest. A load that has to
    follow its plan may tilt only as far as takes it aside by a share of what is allowed, and its
    jerk too takes a swing to rise: what the jerk's jumps excite is missing in the tensions.

    Args:
        scenario: the task.
        followed: whether the load has to follow its plan in simulation.
    """
    limits, period = scenario.limits, swing_period(scenario.payload)
    steepest = np.tan(np.deg2rad(limits.posture_deg)) if limits.posture_deg < 90 else np.inf
    if not followed:
        jerk = GRAVITY * min(steepest, 1.0) / period
        return Riding(steepest, jerk if limits.jerk is None else limits.jerk, np.inf)
    aside = min(FOLLOWED * TRACKING / (scenario.payload.height / 2), 0.7)
    tilt = float(min(steepest, np.tan(np.arcsin(aside))))
    jerk = GRAVITY * tilt / period
    return Riding(tilt, min(jerk, limits.jerk or np.inf), jerk / period)


def swing_period(payload: Payload) -> float:
    """Period of small swings of a load about its hook (s), the slowest of a box or a hull."""
    below = payload.height / 2 - payload.center_of_mass[2]
    radius = payload.radius**2 / 4 + payload.height**2 / 12 + below**2  # of gyration, squared
    if (body := payload.body) is not None:
        radius = np.linalg.eigvalsh(body.inertia[:2, :2]).max() + below**2
    return float(2 * np.pi * np.sqrt(radius / (GRAVITY * below)))
