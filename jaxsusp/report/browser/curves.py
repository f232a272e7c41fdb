"""What changes along a motion: curves with their limits, in SI units, for the page."""

from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.report.browser.packing import packed
from jaxsusp.report.drawing.style import CABLES, PALETTE, subscript
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.cableloads import Loads
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.constraints import Check
from jaxsusp.verify.gauge import least_distances
from jaxsusp.verify.pairs import KINDS

FINE, COARSE = 5, 20
"""Of the instants of the constraint report, every so many are kept; distances are fewer."""

DISTANCES = {
    "load to obstacles": PALETTE["sdbo"],
    "cables to obstacles": PALETTE["pso"],
    "arms to obstacles": PALETTE["ga"],
    "cables to arms": PALETTE["dbo"],
    "load to arms": PALETTE["sdbo-task"],
    "load to the ground": "#8B5A2B",
}
"""Kinds of distance that are drawn over time, all with the same limit, and their colours."""

Bounds = tuple[float | None, float | None]
"""Least and greatest value; None: any."""

DASHES = ("", "7 3", "2 3")
"""Of φ1, φ2 and φ3 in the colour of their robot."""


class Curve(NamedTuple):
    """One panel: lines over the same time with limits, in SI units."""

    name: str
    unit: str
    times: Float[np.ndarray, "times"]  # s
    limits: Bounds = (None, None)
    lines: tuple["Line", ...] = ()
    still: bool = False  # nothing of it changes

    @property
    def record(self) -> dict[str, Any]:
        """As the page reads it."""
        lines = [
            {**each._asdict(), "values": packed(each.values), "limits": each.limits or self.limits}
            for each in self.lines
        ]
        return {**self._asdict(), "times": packed(self.times), "lines": lines}


class Line(NamedTuple):
    """One line of a panel."""

    name: str
    color: str
    values: Float[np.ndarray, "times"]
    dash: str = ""
    limits: Bounds | None = None  # where they are not those of the panel


def checks_of(curve: Curve) -> list[Check]:
    """Where each line is nearest to its limits, as lines of a report."""
    found = []
    for line in curve.lines:
        low, high = line.limits or curve.limits
        low, high = -np.inf if low is None else low, np.inf if high is None else high
        margin = np.minimum(line.values - low, high - line.values)
        if np.isfinite(margin).any():
            at = int(np.nanargmin(margin))
            value, time = float(line.values[at]), float(curve.times[at])
            found.append(Check(curve.name, value, low, high, curve.unit, time, line.name))
    return found


def curves_of(
    scenario: Scenario, own: Rigging, loads: Loads, times: Float[np.ndarray, "times"]
) -> list[Curve]:
    """Tension, length, clearance, posture where the load turns, and joint angles.

    Args:
        scenario: in the numbers that are shown.
        own: the system in own units.
        loads: at the times, in own units.
        times: s, in own units.
    """
    units, limits = scenario.units, scenario.limits
    shown = loads.stated(units)
    clock = units.number(times, "s")
    kept = slice(None, None, FINE)
    per_cable = (
        ("tension", "N", shown.tensions, limits.tension),
        ("cable length", "m", shown.lengths, limits.cable_length),
    )
    found = [
        Curve(name, unit, clock[kept], bounds, _per_cable(values[kept]))
        for name, unit, values, bounds in per_cable
    ]
    found.append(_clearance(scenario, own, times))
    if scenario.payload.attachments != "hook":
        turn = np.where(loads.balanced, np.rad2deg(loads.turn), np.nan)[kept]
        line = Line("from level", PALETTE["sdbo"], turn)
        found.append(
            Curve("turn of the load", "°", clock[kept], (None, limits.posture_deg), (line,))
        )
    return [*found, _joints(scenario, own, times)]


def _per_cable(values: Float[np.ndarray, "times cables"]) -> tuple[Line, ...]:
    return tuple(
        Line(f"cable {k + 1}", CABLES[k % len(CABLES)], each) for k, each in enumerate(values.T)
    )


def _clearance(scenario: Scenario, own: Rigging, times: np.ndarray) -> Curve:
    """Least distances of the kinds that keep the warning distance."""
    units, few = scenario.units, times[::COARSE]
    least = least_distances(own, few, [KINDS.index(name) for name in DISTANCES])
    lines = tuple(
        Line(name, color, units.number(values, "m"))
        for (name, color), values in zip(DISTANCES.items(), least.T, strict=True)
        if np.isfinite(values).any()
    )
    limit = scenario.limits.clearance, None
    return Curve("clearance", "m", units.number(few, "s"), limit, lines)


def _joints(scenario: Scenario, own: Rigging, times: np.ndarray) -> Curve:
    """Joint angles; of arms that stand still once."""
    kept = times[::FINE] if own.moves else times[:1]
    joints = np.rad2deg(own.joints_at(own.ends_at(own.law.parameter(kept))))
    given = scenario.limits.joint_limits_deg
    lines = tuple(
        Line(
            f"robot {k + 1} φ{subscript(i + 1)}", CABLES[k % len(CABLES)], joints[:, k, i], dash,
            None if given is None else given[k if len(given) > 1 else 0][i],
        )
        for k in range(own.cables)
        for i, dash in enumerate(DASHES)
    )  # fmt: skip
    clock = scenario.units.number(kept, "s")
    return Curve("joint angle", "°", clock, lines=lines, still=not own.moves or own.rolls)
