"""What limits a motion at every instant: how much of each limit it uses."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jaxsusp.planning.choices import SHORTEST
from jaxsusp.planning.motion.demands import covered, demands_along
from jaxsusp.planning.motion.pace import usage
from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.style import CABLES, INK, PATH, heading, legend, picture, quiet

NAMES = {
    "speed": "speed of load or cable",
    "acceleration": "acceleration",
    "jerk": "jerk",
    "tilt": "tilt",
    "tension": "tension, of the room that a load at rest leaves",
}
"""What may limit a motion."""


def is_paced(plan: Plan) -> bool:
    """Whether a plan's law was chosen by limits that are known at every instant."""
    return plan.settings.get("duration") == SHORTEST and covered(plan.scenario)


def pace(plan: Plan) -> Figure:
    """How much of each limit a motion uses over time, and which is nearest to its limit when.

    The limits of tilt and jerk are those with which a load that swings is made to follow, where
    plans are played.
    """
    rigging = plan.rigging.own
    played = bool(plan.settings.get("simulated", False))
    used = usage(rigging.law, lambda arc: demands_along(rigging, arc, played))._asdict()
    used = {name: 100 * values for name, values in used.items() if values.any()}
    times = np.linspace(0, plan.law.duration, len(next(iter(used.values()))))
    figure = picture(9.0, 4.6)
    curves, strip = figure.subplots(2, 1, sharex=True, height_ratios=(10, 1))
    quiet(curves)
    colors = dict(zip(NAMES, (CABLES[0], CABLES[3], CABLES[1], CABLES[2], CABLES[4]), strict=True))
    for name, values in used.items():
        curves.plot(times, values, color=colors[name], lw=1.8)
    curves.axhline(100, color=PATH, lw=1.2, ls=(0, (5, 3)))
    curves.set_ylim(0, 110)
    curves.set_xlim(0, times[-1])
    curves.set_ylabel("share of the limit (%)", fontsize=10, color=INK)
    nearest = np.argmax(np.stack(list(used.values())), axis=0)
    for row, name in enumerate(used):
        strip.fill_between(times, 0, 1, where=nearest == row, color=colors[name], lw=0, step="mid")
    strip.set_yticks([])
    strip.spines[:].set_visible(False)
    strip.set_ylabel("nearest", fontsize=10, color=INK, rotation=0, ha="right", va="center")
    strip.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: what limits the motion")
    legend(figure, [
        Line2D([], [], color=colors[name], label=NAMES[name], lw=2) for name in used
    ], columns=min(len(used), 3))  # fmt: skip
    return figure
