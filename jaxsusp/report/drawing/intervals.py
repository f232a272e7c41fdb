"""Estimates with their intervals: rows of marks, and curves over something measured."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from jaxsusp._types import Float
from jaxsusp.report.drawing.style import FAINT, INK, QUIET


class Look(NamedTuple):
    """How one series of estimates is told from the others, in grey as well."""

    label: str
    color: str
    marker: str
    filled: bool = True

    @property
    def sample(self) -> Line2D:
        """What a legend shows of it."""
        return Line2D([], [], ls="", markersize=5, label=self.label, **self.mark)

    @property
    def mark(self) -> dict:
        """Of a line's markers."""
        return {
            "color": self.color,
            "marker": self.marker,
            "markerfacecolor": self.color if self.filled else "white",
        }


class Estimates(NamedTuple):
    """One series: a number per row and its interval."""

    look: Look
    middle: Float[np.ndarray, "rows"]
    low: Float[np.ndarray, "rows"]
    high: Float[np.ndarray, "rows"]


def rows_of_intervals(
    axes: Axes, names: Sequence[str], series: Sequence[Estimates], size: float = 8.0
) -> None:
    """A row per name, the series below each other in it, and a line where nothing changes.

    Args:
        axes: an empty panel.
        names: of the rows, the first one at the top.
        series: what every row holds.
        size: of letters (pt).
    """
    axes.axvline(0, color=QUIET, lw=1, zorder=1)
    pitch = 0.72 / max(len(series), 1)
    for number, each in enumerate(series):
        y = np.arange(len(names)) + (number - (len(series) - 1) / 2) * pitch
        axes.hlines(y, each.low, each.high, color=each.look.color, lw=1.3, zorder=2)
        axes.plot(each.middle, y, ls="", markersize=4.5, zorder=3, **each.look.mark)
    for edge in np.arange(len(names) - 1) + 0.5:
        axes.axhline(edge, color=FAINT, lw=0.8)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(labelsize=size, labelcolor=INK)
    axes.grid(False, axis="y")
