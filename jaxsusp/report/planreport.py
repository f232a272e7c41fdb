"""What people read about a plan: its constraint report with margins, ends and cables."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from jaxsusp.plans import Plan
from jaxsusp.report.render import Column, significant
from jaxsusp.verify.limits import Check
from jaxsusp.verify.simulation import TENSION, TRACKING, Simulation


def limits_table(
    report: Sequence[Check], title: str = "Constraint report (Eq. 22)"
) -> pd.DataFrame:
    """The report, one limit per row: value, what is allowed, margin, when and of what."""
    frame = pd.DataFrame(
        {
            "limit": [each.name.removeprefix("distance of ") for each in report],
            "value": [_with_unit(each.value, each.unit) for each in report],
            "allowed": [_allowed(each) for each in report],
            "margin": [each.margin for each in report],
            "at": [np.nan if each.time is None else each.time for each in report],
            "of": [each.about.removeprefix("load and ") for each in report],
        }
    )
    frame.attrs["title"] = title
    frame.attrs["columns"] = {
        "margin": Column("margin", _signed),
        "at": Column("at (s)", lambda t: f"{t:.1f}" if np.isfinite(t) else "–"),
    }
    frame.attrs["bold"] = frozenset(
        (row, name)
        for row, each in enumerate(report)
        if not each.ok
        for name in ("limit", "margin")
    )
    broken = sum(not each.ok for each in report)
    frame.attrs["caption"] = f"{broken} limits are broken." if broken else "All limits are kept."
    return frame


def ends_table(plan: Plan) -> pd.DataFrame:
    """Tables 2 and 3 in our form: end, reach, greatest length and greatest tension per robot."""
    shoulders = np.array([np.add(r.base, [0, 0, r.links[0]]) for r in plan.scenario.robots])
    cables = range(len(plan.ends))
    frame = pd.DataFrame(
        {
            "robot": [str(k + 1) for k in cables],
            "x": plan.ends[:, 0],
            "y": plan.ends[:, 1],
            "z": plan.ends[:, 2],
            "reach": np.linalg.norm(plan.ends - shoulders, axis=1),
            "length": plan.lengths.max(axis=0),
            "tension": plan.tensions.max(axis=0),
            "elbow": ["up" if plan.joints[0, k, 2] >= 0 else "down" for k in cables],
        }
    )
    frame.attrs["title"] = "Ends of the cables"
    frame.attrs["columns"] = {
        **{axis: Column(f"{axis} (m)", _metres) for axis in "xyz"},
        "reach": Column("from shoulder (m)", _metres),
        "length": Column("greatest length (m)", _metres),
        "tension": Column("greatest tension (N)", lambda value: f"{value:.2f}"),
    }
    return frame


def simulation_table(simulation: Simulation) -> pd.DataFrame:
    """What the simulation saw."""
    touched = ", ".join(f"{name} at {time:.2f} s" for time, name in simulation.contacts)
    rows = [
        ("tracking error", f"{1e3 * simulation.tracking_error:.2f} mm",
         f"≤ {1e3 * TRACKING:.0f} mm", simulation.tracking_error <= TRACKING),
        ("tension against the plan", f"{100 * simulation.tension_error:.2f} %",
         f"≤ {100 * TENSION:.0f} %", simulation.tension_error <= TENSION),
        ("swing", f"{simulation.swing:.2f} °", "", True),
        ("peak tension", f"{simulation.peak_tension:.2f} N", "", True),
        ("contacts", touched or "none", "none", not simulation.contacts),
    ]  # fmt: skip
    frame = pd.DataFrame(rows, columns=["simulated", "value", "allowed", "ok"])
    frame.attrs["title"] = "Simulation (MuJoCo)"
    frame.attrs["columns"] = {"ok": Column("kept")}
    frame.attrs["caption"] = (
        "Errors between 5 s after the start and 5 s before the end; the load swings freely, the "
        "cables only pull."
    )
    return frame


def verdict(feasible: bool, reasons: Sequence[str], name: str) -> str:
    """One sentence, or one and a list."""
    if feasible:
        return f"{name}: the plan is feasible and certified clear at every instant."
    lines = "\n".join(f"  - {reason}" for reason in reasons)
    return f"{name}: the plan is infeasible:\n{lines}"


def _with_unit(value: float, unit: str) -> str:
    return f"{significant(value)} {unit}".rstrip()


def _allowed(each: Check) -> str:
    if np.isinf(each.low):
        return f"≤ {each.high:.4g}"
    if np.isinf(each.high):
        return f"≥ {each.low:.4g}"
    return f"{each.low:.3g} … {each.high:.4g}"


def _signed(value: float) -> str:
    return significant(value) if value < 0 or not np.isfinite(value) else f"+{significant(value)}"


def _metres(value: float) -> str:
    return f"{value:.4f}"
