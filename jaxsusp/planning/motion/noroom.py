"""Which limit leaves no law along a path, and where on the path it asks most."""

from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.planning.motion.bounds import Bound, bounds
from jaxsusp.planning.motion.demands import demands_along
from jaxsusp.planning.motion.pace import stretches, usage
from jaxsusp.scenario.models import Limits
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.fastest import Demands
from jaxsusp.verify.constraints import INSTANTS

NO_ROOM = 1e-2
"""Share of the load's weight below which tensions at rest leave no room to accelerate."""

SLOW = 64.0
"""Ratio to the task's duration up to which it makes sense to give a duration instead."""


class Obstruction(NamedTuple):
    """What leaves no law."""

    field: str  # of the scenario, "" where it is none alone
    reason: str


def obstruction(rigging: Rigging, followed: bool) -> Obstruction:
    """The limit for which the system's own law has to be stretched most.

    Args:
        rigging: in own units, a load held at one point from ends that stay.
        followed: whether a load that swings has to follow.
    """
    law, say = rigging.law, rigging.scenario.frame
    asked = usage(law, lambda arc: demands_along(rigging, arc, followed))
    needed = stretches(asked)
    kind = max(needed, key=lambda each: needed[each])
    tightest = _least_room(rigging)
    if tightest.share <= 0 or (kind == "tension" and tightest.share < NO_ROOM):
        return Obstruction("limits.tension", _no_tension(rigging.scenario.limits, tightest, say))
    at = int(getattr(asked, kind).argmax())
    time = np.linspace(0, law.duration, INSTANTS)[at : at + 1]
    there = demands_along(rigging, law.law(time), followed)
    bound = _bound_of(kind, rigging, there, followed)
    what = f"{bound.field} = {bound.value}" if bound.field else bound.words
    takes, place = law.duration * needed[kind], law.at(time).position[0]
    remedy = "widen it" if kind == "tension" else "raise it" if bound.field else "state another"
    if needed[kind] <= SLOW:
        remedy += ", or give duration in seconds"
    return Obstruction(
        bound.field,
        f"{what}: no shortest law that keeps it can be computed: the way would take about "
        f"{say.number(takes, 's'):.3g} s; it asks most at {say.words(place)}; {remedy}",
    )


def _bound_of(kind: str, rigging: Rigging, there: Demands, followed: bool) -> Bound:
    """The limit of a kind; of the load's speed and the cables' the one that is narrower there."""
    scenario = rigging.scenario
    found = {each.field: each for each in bounds(scenario, followed) if each.kind == kind}
    if len(found) == 2:
        of_load = scenario.limits.speed**2 <= there.square[0]  # pyright: ignore[reportOptionalOperand]
        return found["limits.speed" if of_load else "limits.cable_speed"]
    return next(iter(found.values()))


class _Room(NamedTuple):
    """Where tensions of a load at rest are nearest to their limits."""

    share: float  # of the weight
    place: Float[np.ndarray, "xyz"]


def _least_room(rigging: Rigging) -> _Room:
    path = rigging.law.path
    arc = np.linspace(0, path.length, 401)
    room = demands_along(rigging, arc, False).room.min(axis=1)
    at = int(room.argmin())
    place = path.curve(path.parameter(arc[at : at + 1]))[0]
    return _Room(float(room[at]) / (rigging.scenario.payload.mass * GRAVITY), place)


def _no_tension(limits: Limits, tightest: _Room, say: Frame) -> str:
    low, high = (say.number(each, "N") for each in limits.tension)
    share = max(tightest.share, 0.0)
    return (
        f"limits.tension = [{low:g}, {high:g}] N leaves no room to accelerate: at "
        f"{say.words(tightest.place)} a load at rest is within {100 * share:.2g} % of its weight "
        "of the limits; widen them, lighten payload.mass, or move the ends"
    )
