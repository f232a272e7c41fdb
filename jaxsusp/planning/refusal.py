"""Why is there no plan?  What can be proved, what can be named, and what remains open.

In the order of what it is worth: a start or goal at which cables cannot hold the load within their
limits; a proof that no way exists for load and cables, with the least that would have to go; a
proof that no roomy one does; tensions that fail on every way found; what the best attempt failed
by. Regions of free space that do not connect start and goal prove nothing.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxsusp.errors import InputError
from jaxsusp.freespace.build import FINER, free_space
from jaxsusp.freespace.cells.forbidden import Errand, forbidden_of
from jaxsusp.freespace.cells.passage import beside, narrowest_place
from jaxsusp.freespace.cells.removal import least_removal
from jaxsusp.freespace.cells.subdivision import Cells, subdivide
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.mechanics.drives import moving
from jaxsusp.planning.feasibility import ImpossibleTaskError, trouble, worst_tension
from jaxsusp.planning.motion.along import plan_along
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.ranking import simulated_problems
from jaxsusp.problem.constraints import WORKSPACE_TOLERANCE
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.suspension.heldway import HOOK, SEPARATE, least_excess
from jaxsusp.trajectory.timelaw import TimeLaw

LONGER = 1.25
"""Ratio of the durations that are tried."""

LONGEST = 31
"""Greatest number of such steps: a thousand times what was asked for."""

CALMER = 8
"""Such steps from where limits are kept at which it is tried whether a swinging load follows."""

KINDS = (
    "proved blocked", "no passage wider than", "tensions", "lengths", "posture", "reach", "arms",
    "regions do not connect", "unknown",
)  # fmt: skip


class Refusal(NamedTuple):
    """Why a task has no plan, or none was found."""

    kind: str  # of `KINDS`
    text: str  # for people
    remove: tuple[str, ...] = ()  # the fewest obstacles that have to go, where it is proved blocked
    cell: float = 0.0  # m, longest side of the cells of what is proved

    def stated(self, units: Frame) -> "Refusal":
        """The same with its numbers in those of a scenario; its text is in SI units already."""
        return self._replace(cell=units.number(self.cell, "m"))


def why_not(
    scenario: Scenario | Named,
    ends: str = "given",
    space: FreeSpace | None = None,
    plan: Plan | None = None,
) -> Refusal:
    """What stands between start and goal, as far as it can be told.

    Args:
        scenario: the task.
        ends: "given", or "placed": cables could then be anywhere, and only the load counts.
        space: a free space of it that does not connect start and goal, if one is at hand.
        plan: the best infeasible plan, if there is one: it tells of arms and reach.

    Raises:
        InputError: as from `free_space`, where its regions have to be looked at.
    """
    asked = load_scenario(scenario)
    scenario = asked.own
    if found := trouble(scenario, ends):
        return Refusal(*found)
    space = None if space is None else space.own
    fixed = ends == "given" and not moving(scenario.drive)
    cells = _cells(scenario, fixed)
    if cells.verdict == "blocked":
        return _blocked(scenario, fixed, cells).stated(asked.units)
    found = _narrow(scenario, fixed, cells)
    found += _tensions(scenario) if ends == "given" else []
    found += [] if plan is None else _attempt(plan)
    if not found and (fixed or space is not None):
        found = _regions(scenario, space)
    if not found:
        found = [Refusal("unknown", _nothing(fixed))]
    text = "; ".join(each.text for each in found)
    return found[0]._replace(text=f"{scenario.name}: {text}").stated(asked.units)


def require_way(scenario: Scenario, ends: str = "given") -> None:
    """Refuse a task whose start and goal no way can join.

    Raises:
        ImpossibleTaskError: with what is proved, the fewest obstacles to take away, and a remedy.
    """
    scenario = scenario.own
    fixed = ends == "given" and not moving(scenario.drive)
    cells = _cells(scenario, fixed)
    if cells.verdict == "blocked":
        raise ImpossibleTaskError(_blocked(scenario, fixed, cells).text)


def explained(plan: Plan, ends: str) -> Plan:
    """An infeasible plan with what stands in its way as the first of its reasons.

    Of a plan whose path has no law that is the limit that leaves none: that nothing else is known
    comes after it, or not at all where every way would have the same limit.
    """
    if plan.feasible:
        return plan
    refusal = why_not(plan.scenario, ends, plan=plan)
    if refusal.kind == "unknown" and "no_law" in plan.settings:
        anywhere = plan.settings["no_law"] not in ("", "limits.tension")
        return replace(plan, reasons=plan.reasons if anywhere else (*plan.reasons, refusal.text))
    return replace(plan, reasons=(refusal.text, *plan.reasons))


def _errand(scenario: Scenario) -> Errand:
    """Wherever a plan may take the load's centre: somewhat more than the checks allow."""
    return Errand.of(scenario, 2 * WORKSPACE_TOLERANCE)


def _cells(scenario: Scenario, fixed: bool) -> Cells:
    return subdivide(forbidden_of(scenario, fixed), _errand(scenario))


def _blocked(scenario: Scenario, fixed: bool, cells: Cells) -> Refusal:
    """What is proved, what has to go, and what else could help."""
    forbidden, say = forbidden_of(scenario, fixed), scenario.frame
    gone, opens, cells = least_removal(forbidden, _errand(scenario), cells)
    names = tuple(forbidden.names[i] for i in sorted(gone or ()))
    text = (
        f"{scenario.name}: no plan is possible: every way from task.start "
        f"{say.words(scenario.task.start)} to task.goal {say.words(scenario.task.goal)} takes the "
        f"load{' or a cable' if fixed else ''} closer than limits.clearance = "
        f"{say.number(scenario.limits.clearance, 'm'):g} m to an obstacle, as cells of "
        f"{cells.words(say)} prove"
    )
    if names:
        count = "1 obstacle" if len(names) == 1 else f"{len(names)} obstacles"
        after = "there is a way" if opens else "no cells prove that"
        text += f"; at least {count} must go; without {' and '.join(names)} {after}"
    remedy = "move obstacles or the task"
    if fixed and _cells(scenario, False).verdict != "blocked":
        remedy = f'the load alone is not blocked: move the ends, let ends = "placed", or {remedy}'
    return Refusal("proved blocked", f"{text}; {remedy}", names, float(cells.size.max()))


def _narrow(scenario: Scenario, fixed: bool, cells: Cells) -> list[Refusal]:
    """No way by cells that are clear as a whole, nor one that is found by going sideways."""
    if cells.verdict == "open":
        return []
    forbidden = forbidden_of(scenario, fixed)
    found = narrowest_place(forbidden, _errand(scenario))
    if found.room > 0:
        return []
    say = scenario.frame
    least = say.number(scenario.limits.clearance, "m")
    room = say.number(max(np.ceil(1e3 * min(cells.diagonal, found.most)) / 1e3, 0.001), "m")
    text = (
        f"no way keeps {'load and all cables' if fixed else 'the load'} more than "
        f"{least + room:.4g} m from every obstacle (limits.clearance = {least:g} m), as cells of "
        f"{cells.words(say)} prove, and no narrower one was found; it is narrowest near "
        f"{say.words(found.place)} by {' and '.join(beside(forbidden, found.place))}"
    )
    return [Refusal("no passage wider than", text, cell=float(cells.size.max()))]


def _tensions(scenario: Scenario) -> list[Refusal]:
    """Where the load cannot rest on any way found."""
    along = HOOK if scenario.payload.attachments == "hook" else SEPARATE
    fixed = not moving(scenario.drive)
    forbidden = forbidden_of(scenario, fixed)
    cells = subdivide(forbidden, _errand(scenario), along, all_obstacles=True)
    weakest = least_excess(scenario, cells)
    if weakest.excess <= 0:
        return []
    worst, say = worst_tension(scenario, weakest.tensions), scenario.frame
    text = (
        f"on every way found the load passes a place like {say.words(weakest.place)}, where at "
        f"rest {worst} (a hint, looked at in the middle of cells of {cells.words(say)}); lighten "
        "payload.mass, raise or move the ends, or widen limits.tension"
    )
    return [Refusal("tensions", text)]


def _attempt(plan: Plan) -> list[Refusal]:
    """What the best attempt says of robots."""
    found, say = [], plan.scenario.frame
    reach = [
        each.stated(say) for each in plan.report if not each.ok and each.name.startswith(_OF_ROBOTS)
    ]
    if reach:
        found.append(Refusal("reach", f"in the best attempt {reach[0].reason}"))
    arms = [
        each for each in plan.certificate.stated(say).contacts if "robot" in " ".join(each.bodies)
    ]
    if arms:
        (one, other), least = arms[0].bodies, say.thousandths(arms[0].least)
        text = (
            f"in the best attempt {one} and {other} come within {least} m of each "
            f"other, {arms[0].required:g} m are required"
        )
        found.append(Refusal("arms", text))
    return found


_OF_ROBOTS = ("reach", "joint")


def _regions(scenario: Scenario, space: FreeSpace | None) -> list[Refusal]:
    """A way by clear cells exists, and the regions of the free space do not join start and goal."""
    try:
        space = free_space(scenario) if space is None else space
        if space.connected:
            return []
        finer = free_space(scenario, **FINER)
    except InputError as error:  # an end of a cable stands in a warning area
        return [Refusal("regions do not connect", str(error))]
    text = (
        f"a way is known to exist, but {len(space.d)} convex regions do not join start and goal; "
    )
    if finer.connected:
        text += f"with coverage = {FINER['coverage']} they do"
    else:
        text += f"nor do {len(finer.d)} at coverage = {FINER['coverage']}: it is narrow"
    return [Refusal("regions do not connect", text)]


def _nothing(fixed: bool) -> str:
    what = "load and cables" if fixed else "the load alone"
    return (
        f"nothing is known that rules a plan out, and a way for {what} is known to exist; more "
        "runs, iterations or waypoints may find a plan"
    )


def unhurried(plan: Plan) -> Plan:
    """An infeasible plan with the duration that would do as the first of its reasons.

    The same way is driven in more time: half-way between what breaks limits and what does not,
    until durations are a ratio of `LONGER` apart, and then on to where a swinging load follows.
    Where even the longest does not do, speed is not what is wrong, and the plan is returned as it
    is.
    """
    if plan.feasible or not _slower(plan, LONGEST).feasible:
        return plan
    breaks, keeps = -1, LONGEST
    while keeps - breaks > 1:
        middle = (breaks + keeps) // 2
        fine = _slower(plan, middle).feasible
        breaks, keeps = (breaks, middle) if fine else (middle, keeps)
    tries = range(max(keeps, 1), keeps + CALMER)
    follows = (not simulated_problems(_slower(plan, steps)) for steps in tries)
    does = next((steps for steps, fine in zip(tries, follows, strict=True) if fine), None)
    if does is None:
        return plan
    say, duration = plan.scenario.frame, plan.scenario.task.duration
    asked, enough = (say.number(each, "s") for each in (duration, duration * LONGER**does))
    reason = (
        f"task.duration = {asked:.4g} s is too short for this way: in {enough:.3g} s all limits "
        "are kept and a swinging load follows; give more time"
    )
    return replace(plan, reasons=(reason, *plan.reasons))


def _slower(plan: Plan, steps: int) -> Plan:
    """The plan's way in a duration so many steps longer."""
    scenario = plan.scenario
    task = scenario.task.model_copy(update={"duration": scenario.task.duration * LONGER**steps})
    scenario = scenario.model_copy(update={"task": task})
    law = TimeLaw.least_jerk(plan.law.path, task.duration)
    return plan_along(scenario, plan.waypoints, law, plan.end_path, plan.rigging.elbow_up)
