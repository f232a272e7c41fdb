"""The law with which a plan drives its path: as long as was asked for, or as short as can be.

Shortest laws come as families: a law for every factor by which more time is taken, from 1, where
limits are just kept. A load that hangs at one point from ends that stay has the jerk-limited law
(`pace`), stretched; all others have the minimum-jerk law in the least duration that will do. What
is wanted calm is shaped afterwards, so that stretching does not take the shaping out of tune.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from jaxsusp.planning.motion.along import plan_along
from jaxsusp.planning.motion.demands import covered, demands_along, swing_period
from jaxsusp.planning.motion.noroom import obstruction
from jaxsusp.planning.motion.pace import shortest, stretch_of
from jaxsusp.planning.motion.wanted import Wanted
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.ranking import seen_in, simulated, with_settings
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.shaping import shaped
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.certificate import certify
from jaxsusp.verify.model import SWING_DAMPING
from jaxsusp.verify.report import constraint_report
from jaxsusp.verify.simulation import TENSION, TRACKING, Simulation

TRIES = 12
"""Times that a shortest law is slowed until a swinging load follows."""

SLOWER = 1.02
"""By how much at least."""

CLOSE = 1.01
"""Ratio of durations to which the least one is found where no limit is known in closed form."""

MOST = 64.0
"""Ratio to the task's duration beyond which durations are not looked for, either way."""


class Laws(NamedTuple):
    """Shortest laws for a path."""

    law: Callable[[float], TimeLaw]  # by the factor of more time, 1 or more
    bound: float | None  # least time (s) without a limit of jerk; None where it is not known


def driven(found: Plan, wanted: Wanted) -> Plan:
    """A plan on the same path with the law that is wanted.

    A shortest law is never slower than the one a feasible plan has.

    Args:
        found: in own units, with the minimum-jerk law of the task's duration.
        wanted: what.
    """
    if not wanted.shortest:
        return _with_law(found, _least_jerk(found, wanted), wanted) if wanted.calm else found
    laws = shortest_laws(found.rigging, wanted)
    if laws is None:
        return _stuck(found, wanted)
    told: dict[str, Any] = {"has_to_follow": wanted.followed}
    if laws.bound is not None:
        told["least_time"] = found.scenario.frame.number(laws.bound, "s")
    return with_settings(_faster(found, _with_law(found, laws.law(1.0), wanted)), **told)


def followed(found: Plan, wanted: Wanted) -> Plan:
    """A feasible plan with a shortest law, slowed until a swinging load follows where it is played.

    Args:
        found: in own units, feasible.
        wanted: what was asked for.
    """
    seen, problems = simulated(found)
    if not problems:
        return with_settings(found, **seen_in(seen, found.scenario.frame))
    nominal = _with_law(found, _least_jerk(found, wanted), wanted)
    laws = shortest_laws(nominal.rigging, wanted)
    plan, more = found, 1.0
    assert laws is not None  # there was one for the plan itself
    for _ in range(TRIES):
        more *= _stretch_for(seen)
        plan = _faster(nominal, _with_law(found, laws.law(more), wanted))
        seen, problems = simulated(plan)
        if not problems:
            break
    plan = replace(plan, feasible=not problems, reasons=problems)
    return with_settings(plan, **seen_in(seen, plan.scenario.frame))


def shortest_laws(rigging: Rigging, wanted: Wanted) -> Laws | None:
    """The shortest laws for the path of a system in own units; None where none keeps the limits."""
    period = swing_period(rigging.scenario.payload) if wanted.calm else None

    def tuned(law: TimeLaw) -> TimeLaw:
        return law if period is None else shaped(law, period, SWING_DAMPING)

    if not covered(rigging.scenario):
        least = _least_duration(rigging, lambda each: tuned(_plain(rigging, each)))
        if least is None:
            return None
        return Laws(lambda more: tuned(_plain(rigging, least * more)), None)
    pace = shortest(rigging, wanted.followed)
    if pace is None:
        return None

    def law_of(more: float) -> TimeLaw:
        return tuned(pace.law.restated(pace.law.path, 1.0, more))

    first = 1.0
    for _ in range(6 if wanted.calm else 0):  # shaping moves the law along its path
        rest = stretch_of(law_of(first), lambda arc: demands_along(rigging, arc, wanted.followed))
        if rest <= 1:
            break
        first *= max(rest, 1.002)
    return Laws(lambda more: law_of(first * more), pace.bound.duration)


def _least_duration(rigging: Rigging, law_in: Callable[[float], TimeLaw]) -> float | None:
    """The shortest duration on which everything is kept, by bisection; None where there is none.

    Of ends that move, and of loads that turn, no limit is known in closed form.
    """
    certificate, asked = certify(rigging), rigging.law.duration

    def keeps(duration: float) -> bool:
        slow = Rigging(rigging.scenario, law_in(duration), rigging.end_path, rigging.elbow_up)
        checks = constraint_report(slow, certificate)
        return all(each.ok for each in checks if not each.name.startswith("distance of"))

    low, high = asked / 2, asked
    while not keeps(high):
        low, high = high, 2 * high
        if high > MOST * asked:
            return None
    while low > asked / MOST and keeps(low):
        low, high = low / 2, low
    while high > CLOSE * low:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if keeps(middle) else (middle, high)
    return high


def _plain(rigging: Rigging, duration: float) -> TimeLaw:
    return TimeLaw.least_jerk(rigging.law.path, duration)


def _least_jerk(found: Plan, wanted: Wanted) -> TimeLaw:
    """The law of the task's duration, shaping included where it is to be calm."""
    duration = found.scenario.task.duration
    if not wanted.calm:
        return _plain(found.rigging, duration)
    period = swing_period(found.scenario.payload)
    return shaped(_plain(found.rigging, duration - period), period, SWING_DAMPING)


def _with_law(found: Plan, law: TimeLaw, wanted: Wanted) -> Plan:
    """The plan with another law, which is shaped where the load is to be calm; and told to be."""
    scenario, told = found.scenario, dict(found.settings)
    if wanted.calm:
        told["swing_period_s"] = scenario.frame.number(swing_period(scenario.payload), "s")
    return plan_along(
        scenario, found.waypoints, law, found.end_path, found.rigging.elbow_up, told
    )  # fmt: skip


def _faster(nominal: Plan, other: Plan) -> Plan:
    """The faster of two plans, if it is feasible."""
    gains = other.feasible and other.law.duration < nominal.law.duration
    return other if gains or not nominal.feasible else nominal


def _stretch_for(seen: Simulation) -> float:
    """By how much a law has to be slowed, roughly, for a load that swings to follow.

    A load hangs aside as it is accelerated (1/λ²); what is missing in tensions goes with the
    change of jerk (1/λ⁴).
    """
    aside = seen.tracking_error / seen.units.number(TRACKING, "m")
    return max(SLOWER, aside ** (1 / 2), (seen.tension_error / TENSION) ** (1 / 4))


def _stuck(found: Plan, wanted: Wanted) -> Plan:
    """A plan on whose path no motion keeps the limits, with the one that leaves none."""
    if covered(found.scenario):
        field, reason = obstruction(found.rigging, wanted.followed)
    else:
        field, longest = "", found.scenario.frame.number(MOST * found.law.duration, "s")
        reason = f"no law of up to {longest:.4g} s keeps all limits along this way; see which break"
    found = with_settings(found, no_law=field)
    return replace(found, feasible=False, reasons=(reason, *found.reasons))
