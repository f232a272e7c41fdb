"""How smoothly, how fast and how calmly do plans move?"""

from typing import NamedTuple

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Patch

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from jaxsusp.planning.motion.demands import swing_period
from jaxsusp.planning.waypoints import sample_path
from jaxsusp.report.drawing.style import CABLES, INK, legend, panels, picture
from jaxsusp.report.render import Column
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.shaping import shaped
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.model import SWING_DAMPING
from jaxsusp.verify.simulation import simulate

TITLE = "How smoothly, how fast, how calmly"
PRINTED = ""
DIFFERS = (
    "The paper drives a Makima curve in a given time. What does a smoother path near it spare, "
    "how much sooner can the load be there within the limits, and how much of its swing at the "
    "goal can be shaped away?"
)
MADE = READ = ("pace",)
MINUTES = 2.0
INSTANTS = 4001
LONGER = 1.5
"""Of the shortest duration: that in which swings at the goal are compared."""


class Settings(NamedTuple):
    """Of `jaxsusp.plan`."""

    scenarios: tuple[str, ...] = js.scenarios()
    runs: int = 4
    iterations: int = 100
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), 1, 20)


def make(settings: Settings, work: Work) -> None:
    """One plan per scenario, and laws of several kinds on its path."""
    rows = []
    for name in settings.scenarios:
        work.told(f"  {name}")
        plan = js.plan(
            name, runs=settings.runs, iterations=settings.iterations, seed=settings.seed,
            duration="shortest",
        )  # fmt: skip
        rows.append({"scenario": name, **measured(plan)})
    work.artefacts.keep("pace", pd.DataFrame(rows), settings)


def measured(plan: js.Plan) -> dict[str, float]:
    """What a plan with a shortest law tells; SI units."""
    nominal = plan.scenario.task.duration
    searched = sample_path(plan.scenario, plan.waypoints, len(plan.path))
    found = {}
    for when, points in (("before", searched), ("after", plan.path)):
        peaks = smoothness(TimeLaw.through(points, nominal))
        found |= {f"{what}_{when}": value for what, value in peaks.items()}
    duration, period = LONGER * plan.law.duration, swing_period(plan.scenario.payload)
    plain = TimeLaw.least_jerk(plan.law.path, duration)
    calm = shaped(TimeLaw.least_jerk(plan.law.path, duration - period), period, SWING_DAMPING)
    return {
        **found,
        "clearance": plan.clearance,
        "nominal": nominal,
        "returned": plan.law.duration,
        "bound": plan.settings["least_time"],
        "swing_plain": swing_after(plan, plain),
        "swing_calm": swing_after(plan, calm),
    }


def smoothness(law: TimeLaw) -> dict[str, float]:
    """Greatest acceleration (m/s²) and jerk (m/s³), total variation of acceleration (m/s²)."""
    motion = law.at(np.linspace(0, law.duration, INSTANTS))
    return {
        "acceleration": float(np.linalg.norm(motion.acceleration, axis=1).max()),
        "jerk": float(np.linalg.norm(motion.jerk, axis=1).max()),
        "variation": float(np.linalg.norm(np.diff(motion.acceleration, axis=0), axis=1).sum()),
    }


def swing_after(plan: js.Plan, law: TimeLaw, held: float = 3.0) -> float:
    """Greatest tilt (°) of a simulated load after a law has ended, its cables held."""
    times, arc, speed, acceleration = (
        np.append(each, last)
        for each, last in zip(
            law.states, (law.duration + held, law.path.length, 0.0, 0.0), strict=True
        )
    )
    longer = TimeLaw.passing(law.path, times, arc, speed, acceleration)
    seen = simulate(Rigging(plan.scenario, longer, plan.end_path, plan.rigging.elbow_up))
    return float(seen.tilt[seen.times > law.duration].max())


def draw(artefacts: Artefacts) -> Page:
    """Table, picture and words."""
    frame = artefacts.frame("pace")
    return Page({"pace": figure(frame)}, {"pace": table(frame)}, findings(frame))


def findings(frame: pd.DataFrame) -> str:
    """What the table says, in the median."""
    jerk = (frame["jerk_after"] / frame["jerk_before"]).median()
    acceleration = (frame["acceleration_after"] / frame["acceleration_before"]).median()
    ratio = frame["returned"] / frame["bound"]
    calm = (frame["swing_calm"] / frame["swing_plain"]).max()
    return (
        f"In the same time the smoothed path has {100 * jerk:.0f} % of the peak jerk and "
        f"{100 * acceleration:.0f} % of the peak acceleration of the curve that was searched, in "
        f"the median. Within the limits the load is there after {frame['returned'].min():.1f} to "
        f"{frame['returned'].max():.1f} s instead of {frame['nominal'].iloc[0]:g} s, "
        f"{ratio.min():.2f} to {ratio.max():.2f} times the least time in which any law, of "
        "whatever jerk, would do on that path. What separates the two is that a load that swings "
        "has to follow in simulation. A calm law leaves "
        f"at most {100 * calm:.1f} % of the swing that the minimum-jerk law of the same duration, "
        f"{LONGER:g} times the shortest, leaves at the goal."
    )


def table(frame: pd.DataFrame) -> pd.DataFrame:
    """Everything, one scenario a row."""
    shown = frame.copy()
    for name in ("acceleration", "jerk", "variation"):
        for when in ("before", "after"):
            shown[f"{name}_{when}"] *= 1e3
    whole = "{:.0f}".format
    shown.attrs["title"] = "Smoothness at equal duration, shortest durations, and swing at the goal"
    shown.attrs["columns"] = {
        "acceleration_before": Column("peak acceleration, searched (mm/s²)", whole),
        "acceleration_after": Column("smoothed", whole),
        "jerk_before": Column("peak jerk, searched (mm/s³)", whole),
        "jerk_after": Column("smoothed ", whole),
        "variation_before": Column("variation of acceleration, searched (mm/s²)", whole),
        "variation_after": Column("smoothed  ", whole),
        "clearance": Column("clearance (m)", "{:.3f}".format),
        "nominal": Column("task (s)", "{:g}".format),
        "returned": Column("shortest (s)", "{:.2f}".format),
        "bound": Column("bound (s)", "{:.2f}".format),
        "swing_plain": Column("swing, plain (°)", "{:.3f}".format),
        "swing_calm": Column("swing, calm (°)", "{:.4f}".format),
    }
    return shown[["scenario", *shown.attrs["columns"]]]  # attributes come along


def figure(frame: pd.DataFrame) -> Figure:
    """Peak jerk before and after, and durations beside their bound."""
    drawing = picture(7.09, 3.2)
    left, right = panels(drawing, 2)
    x, names = np.arange(len(frame)), [name.removeprefix("scenario-") for name in frame["scenario"]]
    for axes, pairs, text in (
        (left, ("jerk_before", "jerk_after"), "peak jerk (m/s³)"),
        (right, ("returned", "bound"), "duration (s)"),
    ):
        for place, (column, color) in enumerate(zip(pairs, CABLES, strict=False)):
            axes.bar(x + 0.4 * place - 0.2, frame[column], 0.38, color=color)
        axes.set_xticks(x, names)
        axes.set_xlabel("scenario", fontsize=8.0)
        axes.set_ylabel(text, fontsize=8.0)
        axes.tick_params(labelsize=8.0)
    left.set_title("searched and smoothed, 40 s", loc="left", fontsize=9, color=INK)
    right.set_title("shortest and bound", loc="left", fontsize=9, color=INK)
    legend(drawing, [
        bar(CABLES[0], "searched; shortest"), bar(CABLES[1], "smoothed; bound"),
    ], size=8.0)  # fmt: skip
    drawing.set_label(
        "Peak jerk along the curve that was searched and along the smoothed path in the task's "
        "duration, and the shortest duration that a swinging load follows beside its bound"
    )
    return drawing


def bar(color: str, text: str) -> Patch:
    """What a legend shows of bars."""
    return Patch(color=color, label=text)
