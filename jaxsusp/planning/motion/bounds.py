"""The limits with which shortest laws are made, for people: which, how much, and why.

Limits that a scenario states are theirs; those of tilt and jerk are often narrower, or not stated
at all, and follow from what a load that swings needs (`demands.riding`).
"""

from typing import NamedTuple

import numpy as np

from jaxsusp.planning.motion.demands import riding, swing_period
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario

STATED = (
    ("speed", "speed", "speed of the load", "m/s"),
    ("speed", "cable_speed", "speed of a cable", "m/s"),
    ("acceleration", "acceleration", "acceleration", "m/s²"),
)
"""Limits that hold where they are stated: the kind of `pace.Usage`, the field, in words, unit."""


class Bound(NamedTuple):
    """One limit."""

    kind: str  # of `pace.Usage`
    name: str
    value: str  # with its unit, in that of the scenario
    field: str = ""  # of the scenario, where it is a limit that is stated there
    why: str = ""  # it is this much, where it is not

    @property
    def words(self) -> str:
        """The limit with its value and where it comes from."""
        most = f"{self.name} {'within' if self.kind == 'tension' else '≤'} {self.value}"
        return f"{most} ({self.field})" if self.field else f"{most}, {self.why}"


def bounds(scenario: Scenario, followed: bool) -> tuple[Bound, ...]:
    """The limits of a hook's motion, those of speed, acceleration, jerk, tilt and tension in turn.

    Args:
        scenario: the task, stated or in own units; numbers are told in SI units either way.
        followed: whether a load that swings has to follow, see `demands.riding`.
    """
    own, say = scenario.own, scenario.own.frame
    found = [
        Bound(kind, name, f"{say.number(most, unit):.4g} {unit}", f"limits.{field}")
        for kind, field, name, unit in STATED
        if (most := getattr(own.limits, field)) is not None
    ]
    low, high = (say.number(each, "N") for each in own.limits.tension)
    tension = Bound("tension", "tension", f"[{low:.4g}, {high:.4g}] N", "limits.tension")
    return (*found, _jerk(own, say, followed), *_tilt(own, followed), tension)


def _jerk(own: Scenario, say: Frame, followed: bool) -> Bound:
    jerk, swing = riding(own, followed).jerk, say.number(swing_period(own.payload), "s")
    value = f"{say.number(jerk, 'm/s³'):.3g} m/s³"
    if jerk == own.limits.jerk:
        return Bound("jerk", "jerk", value, "limits.jerk")
    aim = "a swinging load follows" if followed else "the load hardly swings"
    why = f"so that {aim} (from level to its limit of tilt in a swing of {swing:.2g} s at least)"
    return Bound("jerk", "jerk", value, why=why)


def _tilt(own: Scenario, followed: bool) -> tuple[Bound, ...]:
    tilt, stated = np.rad2deg(np.arctan(riding(own, followed).tilt)), own.limits.posture_deg
    if tilt < stated * (1 - 1e-9):
        why = f"so that a swinging load follows (limits.posture_deg = {stated:.4g}°)"
        return (Bound("tilt", "tilt", f"{tilt:.3g}°", why=why),)
    if stated >= 90:
        return ()
    return (Bound("tilt", "tilt", f"{stated:.4g}°", "limits.posture_deg"),)
