"""What limits a motion at every instant: how much of each limit it uses."""

from collections.abc import Iterable

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jaxsusp.planning.motion.demands import demands_along
from jaxsusp.planning.motion.pace import usage
from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.style import CABLES, INK, PATH, heading, legend, picture, quiet
from jaxsusp.report.plan.words import had_to_follow, paced_by

COLORS = {
    "speed": CABLES[0],
    "acceleration": CABLES[3],
    "jerk": CABLES[1],
    "tilt": CABLES[2],
    "tension": CABLES[4],
}
"""Of what may limit a motion."""

BESIDE = {"tension": ": share of the room that a load at rest leaves"}
"""What has to be said besides the limit itself."""


def pace(plan: Plan) -> Figure:
    """How much of each limit a motion uses over time, and which is nearest to its limit when.

    The limits are those with which the law was made, and are told: where plans are played those of
    tilt and jerk make a load that swings follow, and are narrower than those of the report.
    """
    rigging, follows = plan.rigging.own, had_to_follow(plan)
    used = usage(rigging.law, lambda arc: demands_along(rigging, arc, follows))._asdict()
    used = {name: 100 * values for name, values in used.items() if values.any()}
    times = np.linspace(0, plan.law.duration, len(next(iter(used.values()))))
    figure = picture(9.0, 5.2)
    curves, strip = figure.subplots(2, 1, sharex=True, height_ratios=(10, 1))
    quiet(curves)
    for name, values in used.items():
        curves.plot(times, values, color=COLORS[name], lw=1.8)
    curves.axhline(100, color=PATH, lw=1.2, ls=(0, (5, 3)))
    curves.set_ylim(0, 110)
    curves.set_xlim(0, times[-1])
    curves.set_ylabel("share of the limit (%)", fontsize=10, color=INK)
    nearest = np.argmax(np.stack(list(used.values())), axis=0)
    for row, name in enumerate(used):
        strip.fill_between(times, 0, 1, where=nearest == row, color=COLORS[name], lw=0, step="mid")
    strip.set_yticks([])
    strip.spines[:].set_visible(False)
    strip.set_ylabel("nearest", fontsize=10, color=INK, rotation=0, ha="right", va="center")
    strip.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: what limits the motion")
    legend(figure, [
        Line2D([], [], color=COLORS[name], label=text, lw=2) for name, text in _labels(plan, used)
    ], size=9.0, columns=1)  # fmt: skip
    return figure


def _labels(plan: Plan, used: Iterable[str]) -> list[tuple[str, str]]:
    """Every curve with the limits that it is the share of."""
    words = {name: [each.words for each in paced_by(plan) if each.kind == name] for name in used}
    return [(name, ("; ".join(words[name]) or name) + BESIDE.get(name, "")) for name in used]
