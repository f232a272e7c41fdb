"""The paper's Figs. 8, 11 and 12 in its own form, for the width of a page.

`figures` says more: medians instead of averages, evaluations instead of iterations.
"""

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.gaps import clear_runs
from jaxsusp.report.drawing.style import (
    INK,
    QUIET,
    Style,
    legend,
    line_sample,
    log_axis,
    picture,
    quiet,
    styles,
)
from jaxsusp.report.render import significant
from jaxsusp.trajectory.timelaw import TimeLaw

PAGE = 7.09
"""Width of a page (inches)."""

INSTANTS = 4001
"""At which a motion is drawn, and its greatest values are told: peaks of the jerk are narrow."""

DASHES = ("-", (0, (5, 2)), (0, (1, 1)), (0, (5, 2, 1, 2)))
"""Of the algorithms in turn, where lines have no markers."""

MOTION = {
    "position": "position (m)",
    "velocity": "velocity (m/s)",
    "acceleration": "acceleration (m/s²)",
    "jerk": "jerk (m/s³)",
}


def motions(laws: Mapping[str, TimeLaw], width: float = PAGE) -> Figure:
    """Fig. 8: position, velocity, acceleration and jerk along x, y and z, by algorithm.

    Args:
        laws: the motion that each algorithm's best run comes to.
        width: of the figure, inches.
    """
    figure = picture(width, 1.1 * width)
    grid = figure.subplots(len(MOTION), 3, sharex=True, sharey="row")
    look = styles(laws)
    for name, dash in zip(laws, DASHES * len(laws), strict=False):
        law = laws[name]
        times = np.linspace(0, law.duration, INSTANTS)
        for row, values in zip(grid, law.at(times), strict=True):
            for axes, along in zip(row, values.T, strict=True):
                axes.plot(times, along, color=look[name].color, ls=dash, lw=1.4)
    for letter, row, quantity in zip("abcd", grid, MOTION.values(), strict=True):
        row[0].set_ylabel(quantity, fontsize=8, color=INK)
        for axes, axis in zip(row, "xyz", strict=True):
            _small(axes)
            axes.set_title(f"({letter}) {axis}", loc="left", fontsize=8, color=INK)
            axes.set_xlim(0, max(law.duration for law in laws.values()))
    for axes in grid[-1]:
        axes.set_xlabel("time (s)", fontsize=8, color=INK)
    figure.align_ylabels(grid[:, 0])
    legend(
        figure,
        [
            Line2D([], [], color=look[name].color, ls=dash, lw=1.4, label=look[name].label)
            for name, dash in zip(laws, DASHES * len(laws), strict=False)
        ],
    )
    return figure


def average_convergence(ds: xr.Dataset, scenario: str, width: float = PAGE) -> Figure:
    """Fig. 11: best fitness so far, mean over the runs, against iterations and evaluations.

    An algorithm that evaluates more often per iteration looks faster in the first panel than it is.

    Args:
        ds: a comparison.
        scenario: one of its scenarios.
        width: of the figure, inches.
    """
    figure = picture(width, 0.47 * width)
    left, right = figure.subplots(1, 2, sharey=True)
    look = styles(ds["algorithm"].values.tolist())
    for name, style in look.items():
        cell = ds.sel(scenario=scenario, algorithm=name)
        mean = cell["history"].mean("run", skipna=True).values.astype(np.float64)
        made, mean = cell["iteration"].values[np.isfinite(mean)], mean[np.isfinite(mean)]
        first = cell["evaluations_initial"].item()
        each = cell["evaluations"].item() - first - cell["evaluations_polish"].item()
        spent = first + each * made / made.max(initial=1)
        for axes, along in ((left, made), (right, spent)):
            _line(axes, along, mean, style)
    for letter, axes, name in zip("ab", (left, right), ("iterations", "evaluations"), strict=True):
        _small(axes)
        axes.set_yscale("log")
        axes.set_xlim(left=0)
        axes.set_xlabel(f"fitness {name}" if name == "evaluations" else name, fontsize=8, color=INK)
        axes.set_title(f"({letter}) against {name}", loc="left", fontsize=8, color=INK)
    log_axis(left.yaxis)
    right.xaxis.set_major_formatter(EngFormatter(sep=""))
    left.set_ylabel("average best fitness so far", fontsize=8, color=INK)
    legend(figure, [line_sample(style) for style in look.values()])
    return figure


def minima(ds: xr.Dataset, scenario: str, width: float = PAGE) -> Figure:
    """Fig. 12: the fitness of every run and the least of them; beside it what the paper prints.

    Args:
        ds: a comparison.
        scenario: one of its scenarios; of others than the paper's its panel stays away.
        width: of the figure, inches.
    """
    table = paper.table1()
    both = scenario in table["scenario"].values.tolist()
    figure = picture(width if both else width / 2, 0.43 * width)
    panels = figure.subplots(1, 1 + both, squeeze=False)[0]
    for axes in panels:
        axes.set_yscale("log")
    look = styles(ds["algorithm"].values.tolist())
    for place, (name, style) in enumerate(look.items()):
        cell = ds.sel(scenario=scenario, algorithm=name)
        _runs(panels[0], place, cell, style)
        if both and name in table["algorithm"].values.tolist():
            row = table.sel(scenario=scenario, algorithm=name)
            _printed(panels[1], place, row, style)
    titles = ("(a) ours: all runs", "(b) as printed: minimum, average, maximum")
    for axes, title in zip(panels, titles, strict=False):
        _small(axes)
        bottom, top = axes.get_ylim()
        axes.set_ylim(0.8 * bottom, top)  # for the numbers below the least
        axes.set_xticks(range(len(look)), [style.label for style in look.values()])
        axes.set_xlim(-0.6, len(look) - 0.4)
        axes.set_title(title, loc="left", fontsize=8, color=INK)
        axes.grid(False, axis="x")
        log_axis(axes.yaxis)
    panels[0].set_ylabel("fitness", fontsize=8, color=INK)
    faces = {"clear run": QUIET, "run with a collision or violation": "white"}
    samples = [
        Line2D([], [], marker="o", ls="", ms=4, mec=QUIET, mfc=face, label=text)
        for text, face in faces.items()
    ]
    samples.append(Line2D([], [], marker="_", ls="", ms=12, mew=2, color=INK, label="minimum"))
    if both:
        samples.append(Line2D([], [], marker="_", ls="", ms=6, color=QUIET, label="maximum (b)"))
    legend(figure, samples)
    return figure


def _line(axes: Axes, along: np.ndarray, mean: np.ndarray, style: Style) -> None:
    some = max(len(mean) // 6, 1)
    axes.plot(
        along, mean, color=style.color, ls=style.dash, lw=1.3, marker=style.marker, ms=4,
        markevery=some, label=style.label,
    )  # fmt: skip


def _runs(axes: Axes, place: int, cell: xr.Dataset, style: Style) -> None:
    """Points of all runs that found something, side by side, and a stroke at the least."""
    fitness, clear = cell["fitness"].values, clear_runs(cell).values
    spread = (np.arange(len(fitness)) * 0.618034) % 1 - 0.5  # even, and the same every time
    found = np.isfinite(fitness)
    for mask, face in ((clear & found, style.color), (~clear & found, "white")):
        axes.scatter(
            place + 0.5 * spread[mask], fitness[mask], s=12, marker=style.marker,
            facecolor=face, edgecolor=style.color, linewidth=0.8, zorder=3,
        )  # fmt: skip
    if found.any():
        _stroke(axes, place, fitness[found].min())


def _printed(axes: Axes, place: int, row: xr.Dataset, style: Style) -> None:
    low, mean, high = (row[name].item() for name in ("min", "average", "max"))
    axes.plot([place, place], [low, high], color=style.color, lw=1.2, zorder=2)
    axes.plot([place - 0.12, place + 0.12], [high, high], color=style.color, lw=1.2)
    axes.plot(place, mean, style.marker, ms=5, color=style.color, zorder=3)
    _stroke(axes, place, low)


def _stroke(axes: Axes, place: int, low: float) -> None:
    axes.plot([place - 0.3, place + 0.3], [low, low], color=INK, lw=1.8, zorder=4)
    axes.annotate(
        significant(low), (place, low), xytext=(0, -3), textcoords="offset points", ha="center",
        va="top", fontsize=7.5, color=INK,
    )  # fmt: skip


def _small(axes: Axes) -> None:
    quiet(axes)
    axes.tick_params(labelsize=7.5)
