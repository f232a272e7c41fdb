"""Limits of motion that a scenario may state besides Eq. 22: lines of the report where it does."""

import numpy as np

from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.constraints import INSTANTS, Check, slack


def motion_limits(rigging: Rigging) -> tuple[Check, ...]:
    """Speed, acceleration and jerk of the load, and the speed of cables, each where it is greatest.

    Args:
        rigging: the system along its path, in own units.
    """
    limits = rigging.scenario.limits
    times = np.linspace(0, rigging.law.duration, INSTANTS)
    motion, found = rigging.law.at(times), []
    for name, most, vector, unit in (
        ("speed", limits.speed, motion.velocity, "m/s"),
        ("acceleration", limits.acceleration, motion.acceleration, "m/s²"),
        ("jerk", limits.jerk, motion.jerk, "m/s³"),
    ):
        if most is not None:
            size = np.linalg.norm(vector, axis=1)
            found.append(_greatest(name, size, most, unit, times, "load"))
    if limits.cable_speed is not None:
        speeds = np.abs(np.gradient(rigging.loads(times).lengths, times, axis=0))
        k = int(speeds.max(axis=0).argmax())
        name, about = "speed of a cable", f"cable {k + 1}"
        found.append(_greatest(name, speeds[:, k], limits.cable_speed, "m/s", times, about))
    return tuple(found)


def _greatest(name: str, values, most: float, unit: str, times, about: str) -> Check:
    at = int(values.argmax())
    return Check(
        name, float(values[at]), -np.inf, most, unit, float(times[at]), about, slack(unit, most)
    )
