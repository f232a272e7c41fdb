"""Distributions of running times drawn: ours on every group of functions, and beside published."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jaxsusp.report.drawing.style import (
    INK,
    QUIET,
    Style,
    heading,
    legend,
    line_sample,
    panels,
    picture,
    remarks,
    styles,
)
from jaxsusp.studies.bbob.published import Published
from jaxsusp.studies.bbob.summary import PARTS, SOLVED, STEPS, distribution

DASHES = ("--", ":", "-.", "-")
"""Of published algorithms: two greys of each."""


def curves(shares: pd.DataFrame, dim: int, title: str) -> Figure:
    """Shares of runs and targets that each algorithm reached, a panel per group of functions.

    Args:
        shares: of `summary.distributions`.
        dim: which dimension.
        title: what was run.
    """
    here = shares.loc[shares["dimension"] == dim]
    look = styles(dict.fromkeys(here["algorithm"]))
    figure = picture(12.0, 8.0)
    axes = panels(figure, len(PARTS), sharex=True, sharey=True)
    for panel, group in zip(axes, PARTS, strict=True):
        panel.set_title(group, loc="left", fontsize=10, fontweight="bold", color=INK)
        numbers = PARTS[group]
        panel.set_title(f"f{numbers[0]} – f{numbers[-1]}", loc="right", fontsize=9, color=QUIET)
        for row in here.loc[here["group"] == group].to_dict("records"):
            _line(panel, _steps(row), look[row["algorithm"]])
        _across(panel)
    axes[0].set_ylim(-0.02, 1.02)
    figure.supylabel("share of runs and targets reached", fontsize=10, color=INK)
    heading(figure, title)
    legend(figure, [line_sample(style) for style in look.values()])
    return figure


def beside_published(shares: pd.DataFrame, times: Published, title: str, note: str) -> Figure:
    """Share of all runs that solved their function, a panel per dimension.

    Args:
        shares: ours, of `summary.distributions`: full lines, or the house's dashes.
        times: published ones: thin grey lines of several dashes.
        title: what was run.
        note: what a reader has to know to compare them.
    """
    ours = shares.loc[shares["group"] == SOLVED]
    dims = sorted({*ours["dimension"]})
    figure = picture(12.0, 5.8)
    axes = panels(figure, len(dims), sharey=True)
    look, theirs = styles(dict.fromkeys(ours["algorithm"])), _grey(times)
    for panel, dim in zip(axes, dims, strict=True):
        panel.set_title(f"D = {dim}", loc="left", fontsize=10, fontweight="bold", color=INK)
        for name, style in theirs.items():
            spent = [each.solved for key, each in times.items() if key[:2] == (name, dim)]
            if spent:
                _line(panel, distribution(np.concatenate(spent) / dim), style, 1.3)
        for row in ours.loc[ours["dimension"] == dim].to_dict("records"):
            _line(panel, _steps(row), look[row["algorithm"]])
        _across(panel)
    axes[0].set_ylim(-0.02, 1.02)
    figure.supylabel("share of runs that reached 1e-8", fontsize=10, color=INK)
    heading(figure, title)
    remarks(figure, [note])
    legend(figure, [line_sample(style) for style in (*look.values(), *theirs.values())])
    return figure


def _grey(times: Published) -> dict[str, Style]:
    """Styles of published algorithms: dark and light grey, with the dashes in turn."""
    names = dict.fromkeys(name for name, *_ in times)
    return {
        name: Style(f"{name} (published)", (INK, QUIET)[i % 2], "", DASHES[i // 2 % len(DASHES)])
        for i, name in enumerate(names)
    }


def _steps(row: dict) -> np.ndarray:
    return np.array([row[f"{step:g}"] for step in STEPS])


def _line(axes: Axes, shares: np.ndarray, style: Style, width: float = 1.8) -> None:
    axes.plot(
        10**STEPS, shares, color=style.color, ls=style.dash, lw=width,
        marker=style.marker or None, markersize=5, markevery=(5, 10), zorder=1 + width / 2,
    )  # fmt: skip


def _across(axes: Axes) -> None:
    axes.set_xscale("log")
    axes.set_xlim(1, 10 ** STEPS[-1])
    axes.set_xlabel("evaluations / D", fontsize=10, color=INK)
