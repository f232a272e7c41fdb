"""What people read about a plan: its constraint report with margins, ends and cables."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from jaxsusp.planning.plan import Plan
from jaxsusp.report.render import Column, significant
from jaxsusp.scenario.models import Limits
from jaxsusp.verify.constraints import INSTANTS, Check
from jaxsusp.verify.simulation import EDGE, TENSION, TRACKING, Simulation

ROUNDED = 1e-8
"""Values and kept margins below this, of whatever unit, are shown as zero."""


def limits_table(
    report: Sequence[Check], title: str = "Constraint report (Eq. 22)"
) -> pd.DataFrame:
    """The report, one limit per row: value, what is allowed, margin, when and of what.

    Under "kept" stands how that is known: "proved" at every instant, or "sampled" at many.
    """
    frame = pd.DataFrame(
        {
            "limit": [each.name.removeprefix("distance of ") for each in report],
            "value": [_with_unit(each.value, each.unit) for each in report],
            "allowed": [_allowed(each) for each in report],
            "margin": [_rounded(each.margin) if each.ok else each.margin for each in report],
            "kept": [each.kept for each in report],
            "at": [np.nan if each.time is None else each.time for each in report],
            "of": [each.about.removeprefix("load and ") for each in report],
        }
    )
    frame.attrs["title"] = title
    frame.attrs["columns"] = {
        "margin": Column("margin", _signed),
        "kept": Column("kept"),
        "at": Column("at (s)", lambda t: f"{t:.1f}" if np.isfinite(t) else "–"),
    }
    frame.attrs["bold"] = frozenset(
        (row, name)
        for row, each in enumerate(report)
        if not each.ok
        for name in ("limit", "margin")
    )
    frame.attrs["caption"] = _how_kept(report)
    return frame


def _how_kept(report: Sequence[Check]) -> str:
    """Whether all limits are kept, and how that is known, in one sentence."""
    broken = sum(not each.ok for each in report)
    if broken:
        return "1 limit is broken." if broken == 1 else f"{broken} limits are broken."
    proved = sum(each.proved for each in report)
    if proved == len(report):
        return "All limits are kept, proved at every instant."
    if not proved:
        return "All limits are kept where they were looked at."
    return (
        f"All limits are kept: {proved} proved at every instant, {len(report) - proved} where they "
        f"were looked at, at {INSTANTS} instants."
    )


def ends_table(plan: Plan) -> pd.DataFrame:
    """Tables 2 and 3 in our form, per robot: end, reach, greatest length and greatest tension.

    Of ends that move start and goal, the length of the way, and least and greatest reach; and the
    greatest speed of a joint, or of the base where bases roll.
    """
    rigging = plan.rigging
    robots = [str(k + 1) for k in range(rigging.cables)]
    frame = pd.DataFrame(
        {
            "robot": robots,
            **(_ways(plan) if rigging.moves else _places(plan)),
            "length": plan.lengths.max(axis=0),
            "tension": plan.tensions.max(axis=0),
            "elbow": ["up" if up else "down" for up in rigging.elbow_up],
        }
    )
    carried = "bases that roll" if rigging.rolls else "arms"
    frame.attrs["title"] = "Ends of the cables" + f", moved by {carried}" * rigging.moves
    frame.attrs["columns"] = {
        **{axis: Column(f"{axis} (m)", _metres) for axis in "xyz"},
        "start": Column("at start (m)"),
        "goal": Column("at goal (m)"),
        "way": Column("way (m)", _metres),
        "reach": Column("from shoulder (m)", _metres),
        "near": Column("least from shoulder (m)", _metres),
        "far": Column("greatest from shoulder (m)", _metres),
        "turning": Column("fastest joint (°/s)", lambda value: f"{value:.1f}"),
        "rolling": Column("greatest speed (m/s)", lambda value: f"{value:.3f}"),
        "length": Column("greatest length (m)", _metres),
        "tension": Column("greatest tension (N)", lambda value: f"{value:.2f}"),
    }
    return frame


def _places(plan: Plan) -> dict[str, np.ndarray]:
    """Where ends stay."""
    x, y, z = plan.ends.T
    return {"x": x, "y": y, "z": z, "reach": _from_shoulders(plan, plan.ends[None])[0]}


def _ways(plan: Plan) -> dict[str, Any]:
    """Where ends go, and how fast what moves them is."""
    times = np.linspace(0, plan.law.duration, INSTANTS)
    ends = plan.ends_at(times)
    reach = _from_shoulders(plan, ends)
    found = {
        "start": [_point(end) for end in ends[0]],
        "goal": [_point(end) for end in ends[-1]],
        "way": np.linalg.norm(np.diff(ends, axis=0), axis=-1).sum(axis=0),
    }
    if plan.rigging.rolls:
        rates = np.linalg.norm(np.gradient(ends, times, axis=0), axis=-1)
        return {**found, "reach": reach[0], "rolling": rates.max(axis=0)}
    rates = np.abs(np.gradient(np.rad2deg(plan.rigging.joints_at(ends)), times, axis=0))
    near, far = reach.min(axis=0), reach.max(axis=0)
    return {**found, "near": near, "far": far, "turning": rates.max(axis=(0, 2))}


def _from_shoulders(plan: Plan, ends: np.ndarray) -> np.ndarray:
    """Distances of ends from their shoulders (m)."""
    return np.linalg.norm(ends - plan.rigging.shoulders_at(ends), axis=-1)


def simulation_table(simulation: Simulation, limits: Limits) -> pd.DataFrame:
    """What the simulation saw, and what a plan may show there (see `Simulation.problems`)."""
    touched = ", ".join(f"{name} at {time:.2f} s" for time, name in simulation.contacts)
    ultimate = limits.safety_factor * limits.tension[1]
    allowed = simulation.units.number(TRACKING, "m")
    measured = (
        ("tracking error", 1e3 * simulation.tracking_error, "mm", 1e3 * allowed),
        ("tension against the plan", 100 * simulation.tension_error, "%", 100 * TENSION),
        ("tilt of the load", simulation.swing, "°", limits.posture_deg),
        ("peak tension", simulation.peak_tension, "N", ultimate),
    )
    rows = [
        (name, f"{value:.2f} {unit}", f"≤ {most:.4g} {unit}", value <= most)
        for name, value, unit, most in measured
    ]
    rows.append(("contacts", touched or "none", "none", not simulation.contacts))
    frame = pd.DataFrame(rows, columns=["simulated", "value", "allowed", "ok"])
    frame.attrs["title"] = "Simulation (MuJoCo)"
    frame.attrs["columns"] = {"ok": Column("kept")}
    edge = min(simulation.units.number(EDGE, "s"), float(simulation.times[-1]) / 8)
    frame.attrs["caption"] = (
        f"Errors between {edge:.3g} s after the start and {edge:.3g} s before the end; the load "
        "swings freely, the cables only pull."
    )
    return frame


def _with_unit(value: float, unit: str) -> str:
    return f"{significant(_rounded(value))} {unit}".rstrip()


def _rounded(value: float) -> float:
    """What is nothing but rounding as the zero that it stands for."""
    return 0.0 if abs(value) < ROUNDED else value


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


def _point(place: np.ndarray) -> str:
    """A position in words."""
    return ", ".join(f"{value + 0.0:.3f}" for value in np.round(place, 3))
