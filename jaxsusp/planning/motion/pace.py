"""How fast a path is driven: the shortest duration within limits, and what stands in its way."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.planning.motion.demands import covered, demands_along
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.fastest import Demands, Profile, least_time
from jaxsusp.trajectory.jerklimited import jerk_limited
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.constraints import INSTANTS

GRID = 200
"""Intervals on which the bound is computed."""

KEPT = 1e-3
"""Share of a limit that laws keep off it: limits are looked at at instants."""


class Pace(NamedTuple):
    """A law and what is known of how fast one could be."""

    law: TimeLaw
    bound: Profile  # the least time without limits of jerk and snap


def shortest(rigging: Rigging, followed: bool = True) -> Pace | None:
    """The fastest law of bounded jerk that keeps the limits, for the path of a system.

    Args:
        rigging: in own units, a load held at one point from ends that stay; its own law is where
            the search begins.
        followed: whether a load that swings has to follow, see `demands.riding`.

    Returns:
        The law and a bound; None where not even a slow motion keeps the limits.
    """
    assert covered(rigging.scenario)

    def demanded(arc: np.ndarray) -> Demands:
        return demands_along(rigging, arc, followed)

    bound = least_time(np.linspace(0, rigging.law.path.length, GRID + 1), demanded)
    if bound is None or not np.isfinite(stretch_of(rigging.law, demanded)):
        return None
    start = fitted(rigging.law, demanded)
    law = fitted(jerk_limited(start, demanded), demanded)
    return Pace(min(law, start, key=lambda each: each.duration), bound)


def fitted(law: TimeLaw, demanded: Callable[[np.ndarray], Demands]) -> TimeLaw:
    """A law with its time stretched or shortened evenly, so that it just keeps all limits."""
    return law.restated(law.path, 1.0, stretch_of(law, demanded))


def stretch_of(law: TimeLaw, demanded: Callable[[np.ndarray], Demands]) -> float:
    """By how much the time of a law has to be stretched, at as many instants as are reported.

    In time stretched by λ speeds are 1/λ, accelerations 1/λ² and jerks 1/λ³ of what they were.
    """
    return max(stretches(usage(law, demanded)).values()) * (1 + KEPT)


class Usage(NamedTuple):
    """How much of each limit a motion uses at instants, 1 is all of it."""

    speed: Float[np.ndarray, "times"]  # of the load or of a cable
    acceleration: Float[np.ndarray, "times"]
    jerk: Float[np.ndarray, "times"]
    tilt: Float[np.ndarray, "times"]
    tension: Float[np.ndarray, "times"]  # of the room that tensions of a load at rest leave


def stretches(used: Usage) -> dict[str, float]:
    """By how much the time of a law has to be stretched for every limit alone."""
    return {
        "speed": float(used.speed.max()),
        "acceleration": float(used.acceleration.max()) ** (1 / 2),
        "jerk": float(used.jerk.max()) ** (1 / 3),
        "tilt": float(used.tilt.max()) ** (1 / 2),
        "tension": float(used.tension.max()) ** (1 / 2),
    }


def usage(law: TimeLaw, demanded: Callable[[np.ndarray], Demands]) -> Usage:
    """How much of each limit a law uses, at even instants."""
    times = np.linspace(0, law.duration, INSTANTS)
    motion = law.at(times)
    demands = demanded(np.clip(law.law(times), 0, law.path.length))
    acceleration = motion.acceleration
    speed = np.linalg.norm(motion.velocity, axis=1) / np.sqrt(demands.square)
    sideways = np.linalg.norm(acceleration[:, :2], axis=1)
    tilt = (sideways / demands.tilt - acceleration[:, 2]) / demands.gravity
    pull = np.einsum("tfx,tx->tf", demands.faces, acceleration)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(pull > 0, pull / demands.room, 0.0)
    share = np.where((demands.room <= 0) & (pull > 0), np.inf, share)
    return Usage(
        speed,
        np.linalg.norm(acceleration, axis=1) / demands.acceleration,
        np.linalg.norm(motion.jerk, axis=1) / demands.jerk,
        np.maximum(tilt, 0.0),
        share.max(axis=1),
    )
