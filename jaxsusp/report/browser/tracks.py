"""What moves on the page: a plan, the best run of an algorithm, or a load that only hangs."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from jaxsusp._types import Float
from jaxsusp.planning.plan import Plan
from jaxsusp.report.browser.curves import FINE, checks_of, curves_of
from jaxsusp.report.browser.packing import packed
from jaxsusp.report.drawing.style import QUIET
from jaxsusp.report.plan.tables import limits_table
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.cableloads import Loads
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.constraints import INSTANTS, Check

_NEVER_TIGHT = ("distance off", "inside the workspace", "tension ratio", "change of", "lift of")
"""Beginnings of checks whose limits stand for rounding or nothing; they tell of no tight moment."""


def plan_track(plan: Plan, name: str, color: str) -> dict[str, Any]:
    """A plan, with its report and what speaks against it."""
    return {
        **_recorded(_motion(plan.scenario, plan.rigging.own)),
        "name": name,
        "color": color,
        "verdict": "feasible" if plan.feasible else "infeasible",
        "reasons": plan.reasons,
        **_report(plan.report),
    }


def way_track(
    scenario: Scenario,
    position: Float[np.ndarray, "samples xyz"],
    name: str,
    color: str,
    verdict: str,
    reasons: Sequence[str],
) -> dict[str, Any]:
    """A load's way (m) with the ends that its drive mode gives it, as a search saw it."""
    own, points = scenario.own, scenario.units.inside(position)
    law = TimeLaw.through(points, own.task.duration)
    motion = _motion(scenario, Rigging.of(own, law, ends_beside(own, points)))
    checks = [check for curve in motion["curves"] for check in checks_of(curve)]
    return {
        **_recorded(motion), "name": name, "color": color, "verdict": verdict, "reasons": reasons,
        **_report(checks),
    }  # fmt: skip


def standing_tracks(scenario: Scenario) -> list[dict[str, Any]]:
    """A scenario without a plan: the load hangs at the start, and at the goal."""
    own = scenario.own
    start, goal = np.array([own.task.start, own.task.goal])
    way = goal - start if (goal != start).any() else np.array([1e-3, 0.0, 0.0])
    points = start + np.linspace(0, 1, 5)[:, None] * way
    law = TimeLaw.through(points, own.task.duration)
    rig = Rigging.of(own, law, ends_beside(own, points))
    places = _places(scenario, rig, np.linspace(0, law.duration, INSTANTS), INSTANTS - 1)
    verdict = "inadmissible" if scenario.troubles else "no plan"
    told = {"verdict": verdict, "reasons": scenario.troubles}
    common = {**told, "curves": [], "limits": [], "color": QUIET}
    return [
        {
            "name": name,
            "times": packed([0.0]),
            **{key: packed(array[row:][:1]) for key, array in places.items()},
            **common,
        }
        for name, row in (("at the start", 0), ("at the goal", -1))
    ]


def _motion(scenario: Scenario, own: Rigging) -> dict[str, Any]:
    """Places in own units along the time in seconds, and the curves."""
    times = np.linspace(0, own.law.duration, INSTANTS)
    loads = own.loads(times)
    return {
        "times": packed(scenario.units.number(times[::FINE], "s")),
        **{key: packed(array) for key, array in _places(scenario, own, times, FINE, loads).items()},
        "curves": curves_of(scenario, own, loads, times),
    }


def _recorded(motion: dict[str, Any]) -> dict[str, Any]:
    """With the curves as the page reads them."""
    return {**motion, "curves": [curve.record for curve in motion["curves"]]}


def _places(
    scenario: Scenario, own: Rigging, times: np.ndarray, every: int, loads: Loads | None = None
) -> dict[str, np.ndarray]:
    """Where everything is in own units, and the tensions (N), at some of the times.

    What does not move is there once. Loads are computed at as many instants as the constraint
    report has, whose compiled program serves here as well.
    """
    loads = own.loads(times) if loads is None else loads
    u = own.law.parameter(times[::every])
    ends = own.ends_at(u if own.moves else u[:1])
    turn = Rotation.from_matrix(loads.posture[::every]).as_quat()
    level = scenario.payload.attachments == "hook"
    return {
        "position": own.law.path.curve(u),
        "turn": turn[:1] if level else turn,
        "ends": ends,
        "chains": own.chains_at(ends),
        "tensions": scenario.units.number(loads.tensions[::every], "N"),
    }


def _report(checks: Sequence[Check]) -> dict[str, Any]:
    """The limits as a table, the tightest of them first."""
    frame = limits_table(checks)
    written = [frame.attrs["columns"]["margin"].write(value) for value in frame["margin"]]
    rows = [
        {
            "limit": limit, "value": value, "allowed": allowed, "margin": margin,
            "time": each.time, "of": of, "ok": each.ok, "kept": each.kept, "bound": _bound(each),
            "tight": _share(each),
        }
        for limit, value, allowed, of, margin, each in zip(
            *(frame[name] for name in ("limit", "value", "allowed", "of")), written, checks,
            strict=True,
        )
    ]  # fmt: skip
    return {"limits": sorted(rows, key=lambda row: row["tight"])}


def _bound(check: Check) -> str:
    """What the value is proved never to be beyond, in words; "" where that is the value itself."""
    if check.bound is None or check.bound == check.value:
        return ""
    below = check.bound <= check.value
    return f"never {'below' if below else 'above'} {check.bound:.5g} {check.unit}".rstrip()


def _share(check: Check) -> float:
    """Margin as a share of the limit that is nearer; infinite where that says nothing."""
    if np.isnan(check.margin):  # nothing is known, which is worse than anything
        return -1.0
    near = check.low if check.value - check.low <= check.high - check.value else check.high
    if check.time is None or check.name.startswith(_NEVER_TIGHT) or not np.isfinite(near):
        return np.inf
    if near == 0:
        return np.inf if check.ok else -1.0
    return check.margin / abs(near)
