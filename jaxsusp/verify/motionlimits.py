"""Limits of motion that a scenario may state besides Eq. 22: lines of the report where it does."""

import numpy as np

from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.constraints import INSTANTS, Check, extreme


def motion_limits(rigging: Rigging) -> tuple[Check, ...]:
    """Speed, acceleration and jerk of the load, and the speed of cables, each where it is greatest.

    Args:
        rigging: the system along its path, in own units.
    """
    limits, least = rigging.scenario.limits, -np.inf
    times = np.linspace(0, rigging.law.duration, INSTANTS)
    motion, found = rigging.law.at(times), []
    for name, most, vector, unit in (
        ("speed", limits.speed, motion.velocity, "m/s"),
        ("acceleration", limits.acceleration, motion.acceleration, "m/s²"),
        ("jerk", limits.jerk, motion.jerk, "m/s³"),
    ):
        if most is not None:
            size = np.linalg.norm(vector, axis=1)
            found.append(extreme(name, size, times, max, least, most, unit, "load"))
    if limits.cable_speed is not None:
        speeds = np.abs(np.gradient(rigging.loads(times).lengths, times, axis=0))
        k = int(speeds.max(axis=0).argmax())
        name, most, about = "speed of a cable", limits.cable_speed, f"cable {k + 1}"
        found.append(extreme(name, speeds[:, k], times, max, least, most, "m/s", about))
    return tuple(found)
