"""Convergence and distribution of a comparison: data in, figure out."""

import numpy as np
import xarray as xr
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import EngFormatter

from jaxsusp.report.comparison.gaps import runs_made
from jaxsusp.report.drawing.style import (
    INK,
    QUIET,
    Style,
    heading,
    legend,
    line_sample,
    log_axis,
    panels,
    picture,
    styles,
)
from jaxsusp.report.drawing.style import PALETTE as PALETTE
from jaxsusp.report.drawing.style import save as save

_HUGE = 1e300
"""Stands in for +inf in quantiles, where ∞ - ∞ would give NaN."""


MOST_POINTS = 1000
"""Points of a cell that are drawn: of more runs, every second, third, … has one."""


def convergence(ds: xr.Dataset) -> Figure:
    """Best fitness so far against evaluations: median over the runs, quartiles as a band.

    After the initial population an algorithm spends its `evaluations` evenly over the iterations
    that it ran, so algorithms that evaluate more per iteration reach further to the right. The view
    is cut where the steep beginning would squeeze the rest.
    """
    names, scenarios = _names(ds)
    figure = picture(12.0, 3.4 * -(-len(scenarios) // 3) + 1)
    look = styles(names)
    axes = panels(figure, len(scenarios), sharex=True, sharey=True)
    for panel, scenario in zip(axes, scenarios, strict=True):
        _title(panel, ds, scenario)
        for name in names:
            cell = ds.sel(scenario=scenario, algorithm=name)
            _draw_history(panel, cell, look[name])
    axes[0].set_yscale("log")
    axes[0].set_ylim(*_view(ds["fitness"]))
    log_axis(axes[0].yaxis)
    axes[0].xaxis.set_major_formatter(EngFormatter(sep=""))
    axes[0].set_xlim(left=0)
    for panel in axes[-3:]:  # those with no other panel below
        panel.tick_params(labelbottom=True)
        panel.set_xlabel("fitness evaluations per run", fontsize=10, color=INK)
    figure.supylabel("best fitness so far", fontsize=10, color=INK)
    heading(figure, f"Convergence: median and quartiles of {runs_made(ds)}")
    legend(figure, [line_sample(style) for style in look.values()])
    return figure


def fitness_boxes(ds: xr.Dataset) -> Figure:
    """Final fitness of every run, by algorithm and scenario.

    Filled points are violation-free runs, hollow ones are not. Boxes span the quartiles with the
    median inside. Runs of infinite fitness are counted at the top.
    """
    names, scenarios = _names(ds)
    figure = picture(12.0, 3.4 * -(-len(scenarios) // 3) + 1)
    look = styles(names)
    axes = panels(figure, len(scenarios))
    for panel, scenario in zip(axes, scenarios, strict=True):
        _title(panel, ds, scenario)
        panel.set_yscale("log")
        for place, name in enumerate(names):
            cell = ds.sel(scenario=scenario, algorithm=name)
            _draw_runs(panel, place, cell, look[name])
        slanted = {"rotation": 30, "ha": "right"} if len(names) > 4 else {}
        panel.set_xticks(range(len(names)), [s.label for s in look.values()], **slanted)
        panel.set_xlim(-0.6, len(names) - 0.4)
        panel.grid(False, axis="x")
        log_axis(panel.yaxis)
    figure.supylabel("final fitness", fontsize=10, color=INK)
    heading(figure, f"Final fitness of {runs_made(ds)}: quartiles and median")
    faces = {"violation-free run": INK, "run with violations": "white"}
    legend(
        figure,
        [Line2D([], [], marker="o", ls="", mec=INK, mfc=f, label=t) for t, f in faces.items()],
    )
    return figure


def quartiles(values: Float[np.ndarray, " *batch runs"]) -> Float[np.ndarray, "quartiles=3 *batch"]:
    """Lower quartile, median and upper quartile over the runs that are not NaN.

    A quartile between a finite value and +inf is +inf.
    """
    capped = np.minimum(values.astype(np.float64), _HUGE)
    quantile = np.nanquantile if np.isnan(capped).any() else np.quantile  # ten times faster
    result = quantile(capped, [0.25, 0.5, 0.75], axis=-1)
    return np.where(result < _HUGE / 1e6, result, np.inf)


def _view(fitness: xr.DataArray) -> tuple[float, float]:
    """From below the best final value to well above the upper quartiles."""
    values = fitness.transpose(..., "run").values
    values = values[~np.isnan(values).all(axis=-1)]
    upper = quartiles(values)[2]
    reached = upper[np.isfinite(upper)]
    return (
        (0.8 * np.nanmin(values).item(), 5 * reached.max().item()) if len(reached) else (1.0, 10.0)
    )


def _draw_history(axes: Axes, cell: xr.Dataset, style: Style) -> None:
    """Median line and quartile band of one algorithm in one scenario."""
    history = cell["history"].transpose("iteration", "run").values
    made = ~np.isnan(history).all(axis=1)
    if not made.any():
        return
    history, label = history[made], cell["iteration"].values[made]
    initial = cell["evaluations_initial"].item()
    share = label / label[-1]
    end = cell["evaluations"].item() - cell["evaluations_polish"].item()
    spent = initial + (end - initial) * share
    low, middle, high = np.where(np.isinf(band := quartiles(history)), np.nan, band)
    axes.fill_between(spent, low, high, color=style.color, alpha=0.16, linewidth=0)
    axes.plot(
        spent, middle, color=style.color, ls=style.dash, lw=1.8, label=style.label,
        marker=style.marker, markersize=5, markevery=[-1],
    )  # fmt: skip


def _draw_runs(axes: Axes, place: int, cell: xr.Dataset, style: Style) -> None:
    """Box and points of one algorithm in one scenario."""
    fitness = cell["fitness"].values
    clear = ((cell["collisions"] == 0) & (cell["violations"] == 0)).values[~np.isnan(fitness)]
    fitness = fitness[~np.isnan(fitness)]
    lost = np.isinf(fitness)
    if lost.any():
        axes.annotate(
            f"{lost.sum()} × ∞", (place, 1), xycoords=("data", "axes fraction"),
            ha="center", va="top", fontsize=8, color=style.color,
        )  # fmt: skip
    if lost.all():
        return
    low, middle, high = quartiles(fitness)
    box = {"med": middle, "q1": low, "q3": high, "whislo": low, "whishi": high}
    axes.bxp(
        [box], positions=[place], widths=0.62, showfliers=False, showcaps=False,
        patch_artist=True, manage_ticks=False,
        medianprops={"color": style.color, "linewidth": 2.4},
        boxprops={"facecolor": style.color + "22", "edgecolor": style.color},
    )  # fmt: skip
    step = -(-len(fitness) // MOST_POINTS)
    fitness, clear, lost = fitness[::step], clear[::step], lost[::step]
    spread = (np.arange(len(fitness)) * 0.618034) % 1 - 0.5  # even, and the same every time
    x = place + 0.42 * spread
    for mask, face in ((clear & ~lost, style.color), (~clear & ~lost, "white")):
        axes.scatter(
            x[mask], fitness[mask], s=17, marker=style.marker, facecolor=face,
            edgecolor=style.color, linewidth=0.9, zorder=3,
        )  # fmt: skip


def _names(ds: xr.Dataset) -> tuple[list[str], list[str]]:
    return ds["algorithm"].values.tolist(), ds["scenario"].values.tolist()


def _title(axes: Axes, ds: xr.Dataset, scenario: str) -> None:
    count = ds["obstacles"].sel(scenario=scenario).item()
    axes.set_title(scenario, loc="left", fontsize=10, fontweight="bold", color=INK)
    axes.set_title(f"{count} obstacle{'s' * (count != 1)}", loc="right", fontsize=9, color=QUIET)
