"""Pictures of the study of scaling: times and memory on logarithmic axes, with fitted laws."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiments.studies.scaling_fit import Law
from jaxsusp.report.drawing.style import INK, PALETTE, QUIET, legend, log_axis, panels, picture

MEASURED, FITTED, CHUNKS = PALETTE["pso"], PALETTE["sdbo"], PALETTE["dbo"]
IN_CHUNKS = "runs in chunks"


def time_figure(
    parts: dict[str, pd.DataFrame], laws: dict[str, Law], frame: pd.DataFrame
) -> Figure:
    """Seconds by size, a panel per axis; devices and workers in the last."""
    drawing = _figure(parts, laws, "seconds", 1.0, "time (s)", hands=frame)
    drawing.set_label(
        "Time of a batch by what there is to do, medians with the quickest and slowest call; lines "
        "are the fitted laws, and the dotted one is proportional to the work."
    )
    return drawing


def memory_figure(parts: dict[str, pd.DataFrame], laws: dict[str, Law]) -> Figure:
    """Memory by size."""
    drawing = _figure(parts, laws, "memory", 2**-20, "memory (MiB)")
    drawing.set_label(
        "Greatest memory of the process by what there is to do; lines are the fitted laws."
    )
    return drawing


def _figure(
    parts: dict[str, pd.DataFrame],
    laws: dict[str, Law],
    column: str,
    unit: float,
    text: str,
    hands: pd.DataFrame | None = None,
) -> Figure:
    axes_of = [axis for axis in parts if axis != IN_CHUNKS]
    extra = hands is not None and bool(hands["axis"].isin(["devices", "workers"]).any())
    count = len(axes_of) + extra
    drawing = picture(7.09, 2.2 * -(-count // 3) + 0.5)
    grid = panels(drawing, count)
    for axes, axis in zip(grid, axes_of, strict=False):
        _curve(axes, parts[axis], laws[axis], column, unit, MEASURED)
        if axis == "runs" and IN_CHUNKS in parts:
            _curve(axes, parts[IN_CHUNKS], laws[IN_CHUNKS], column, unit, CHUNKS)
        if column == "seconds":
            _proportional(axes, parts[axis], unit)
        _logarithmic(axes, axis)
        law = laws[axis]
        told = f"p = {law.exponent:.2f}" if law.grows else "level"
        axes.set_title(f"{axis}: {told}", loc="left", fontsize=9, color=INK)
    if extra:
        assert hands is not None
        _bars(grid[-1], hands)
    for axes in grid[::3]:
        axes.set_ylabel(text, fontsize=8.0)
    handles = [
        Line2D([], [], color=MEASURED, marker="o", ls="", label="measured"),
        Line2D([], [], color=FITTED, label="fitted"),
    ]
    if IN_CHUNKS in parts:
        handles.insert(1, Line2D([], [], color=CHUNKS, marker="o", ls="", label="in chunks"))
    legend(drawing, handles, size=8.0)
    return drawing


def _curve(axes: Axes, part: pd.DataFrame, law: Law, column: str, unit: float, color: str) -> None:
    x, y = part["size"], part[column] * unit
    if column == "seconds":
        spread = [y - part["least"] * unit, part["most"] * unit - y]
        axes.errorbar(x, y, np.maximum(spread, 0), fmt="o", color=color, ms=4, lw=1)
    else:
        axes.plot(x, y, "o", color=color, ms=4)
    fine = np.geomspace(x.min(), x.max(), 100)
    axes.plot(fine, law.at(fine) * unit, color=FITTED, lw=1.1, zorder=1)


def _proportional(axes: Axes, part: pd.DataFrame, unit: float) -> None:
    """Through the last point."""
    x, last = part["size"].to_numpy(float), float(part["seconds"].iloc[-1]) * unit
    line = last * x / x[-1]
    seen = line >= 0.5 * part["seconds"].min() * unit
    axes.plot(x[seen], line[seen], ":", color=QUIET, lw=1)


def _logarithmic(axes: Axes, axis: str) -> None:
    axes.set(xscale="log", yscale="log")
    low, high = axes.get_ylim()
    if high < 3 * low:  # a level curve is not blown up into noise
        axes.set_ylim(low / 2, 2 * high)
    log_axis(axes.xaxis)
    log_axis(axes.yaxis)
    axes.tick_params(labelsize=8.0)
    axes.set_xlabel(axis, fontsize=8.0)


def _bars(axes: Axes, frame: pd.DataFrame) -> None:
    """Seconds by who computes."""
    part = frame[frame["axis"].isin(["devices", "workers"])]
    names = [
        "here" if axis == "workers" and size == 0 else f"{size} {axis[0]}."
        for axis, size in zip(part["axis"], part["size"], strict=True)
    ]
    color = [MEASURED if axis == "devices" else CHUNKS for axis in part["axis"]]
    x, y = np.arange(len(part)), part["seconds"].to_numpy()
    spread = np.maximum([y - part["least"], part["most"] - y], 0)
    axes.bar(x, y, 0.7, color=color, yerr=spread, error_kw={"lw": 1})
    axes.set_xticks(x, names)
    axes.tick_params(labelsize=8.0)
    axes.set_title("devices; workers", loc="left", fontsize=9, color=INK)
