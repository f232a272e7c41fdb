"""What a person wants of a motion: how long it takes, and whether the load is calm at its end."""

import math
from typing import NamedTuple

from jaxsusp.errors import require
from jaxsusp.planning.choices import SHORTEST
from jaxsusp.planning.motion.demands import swing_period
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.verify.simulation import require_playable


class Wanted(NamedTuple):
    """How a path is to be driven."""

    shortest: bool = False  # as short as limits allow; else the task's duration
    calm: bool = False  # nothing swings on at the goal
    followed: bool = True  # a load that swings has to follow


def as_wanted(
    scenario: Scenario, duration: str | int | float | None, calm: bool, followed: bool = True
) -> tuple[Scenario, Wanted]:
    """A task with the duration that is wanted, and how it is to be driven.

    Args:
        scenario: as it is stated.
        duration: s, "shortest", or None for that of the scenario.
        calm: whether nothing is to swing on.
        followed: whether plans are played, and have to be followed.

    Raises:
        InputError: no such duration, or no swing that could be calmed.
    """
    shortest = duration == SHORTEST
    if duration is not None and not shortest:
        plain = isinstance(duration, int | float) and not isinstance(duration, bool)
        require(
            plain and math.isfinite(float(duration)) and float(duration) > 0,
            f'duration = {duration!r}: is no time; give seconds above 0, or "{SHORTEST}"',
        )
        task = scenario.task.model_copy(update={"duration": float(duration)})
        scenario = scenario.model_copy(update={"task": task})
    if followed and not shortest:
        require_playable(scenario.own, scenario.own.task.duration)
    if calm:
        require(
            scenario.payload.attachments == "hook",
            "calm = True calms a load that swings about one hook, and this one has separate "
            "payload.attachments; leave it out",
        )
        period = scenario.units.number(swing_period(scenario.own.payload), "s")
        require(
            scenario.task.duration > 2 * period,
            f"duration = {scenario.task.duration:g} s with calm = True: the load swings in "
            f"{period:.2g} s, and shaping takes as long; give more than {2 * period:.2g} s",
        )
    return scenario, Wanted(shortest, calm, followed)
