"""The house look: one colour, marker and dash per algorithm, quiet axes, PNG files.

Figures are made with matplotlib's object interface and never touch pyplot's global state, so they
work without a display, in threads and in notebooks.
"""

import io
import math
import os
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from jaxsusp._files import atomic_path

INK = "#2B2B2B"
QUIET = "#8A8A8A"
FAINT = "#E4E4E4"
DPI = 200

LETTERS = 9.5
"""Of a title, per inch."""

PALETTE = {
    "pso": "#0072B2",
    "ga": "#E69F00",
    "dbo": "#009E73",
    "sdbo": "#C43C00",
    "dbo-task": "#56B4E9",
    "sdbo-task": "#CC79A7",
}
"""Okabe and Ito's colours, the red a little darker: distinct for all kinds of colour vision."""

CYCLE = ("#332288", "#8B5A2B", "#444444", "#999933", "#882255")
"""For algorithms without a colour of their own, in order of appearance."""

CABLES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#8B5A2B")
"""One colour per cable, from the first again after the last."""

PATH = "#C43C00"
"""The load's way, and limits."""

SPARE_MARKERS = ("X", "*", "h", "<", ">")
"""Their markers, so that lines can be told apart in grey, too."""

_MARKERS = {"pso": "o", "ga": "s", "dbo": "^", "sdbo": "D", "dbo-task": "v", "sdbo-task": "P"}


class Style(NamedTuple):
    """How one algorithm looks in every figure."""

    label: str
    color: str
    marker: str
    dash: str


class Picture(Figure):
    """A matplotlib figure that also shows itself in a notebook without any set-up."""

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        self.savefig(buffer, format="png", dpi=0.4 * DPI)
        return buffer.getvalue()


def picture(width: float, height: float) -> Picture:
    """An empty figure (inches) that keeps its labels from overlapping."""
    layout = ConstrainedLayoutEngine(w_pad=0.08, h_pad=0.08, wspace=0.03, hspace=0.05)
    figure = Picture(figsize=(width, height), layout=layout, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure as PNG, atomically; the same figure gives the same bytes."""
    with atomic_path(path) as scratch, _laid_out(figure):
        figure.savefig(scratch, format="png", dpi=DPI, metadata={"Software": None})


@contextmanager
def _laid_out(figure: Figure) -> Iterator[None]:
    """The figure with everything in its place: matplotlib draws twice what it has to lay out."""
    engine, dpi = figure.get_layout_engine(), figure.dpi
    if engine is None:
        yield
        return
    figure.dpi = DPI
    try:
        engine.execute(figure)
        figure.set_layout_engine("none")
        yield
    finally:
        figure.set_layout_engine(engine)
        figure.dpi = dpi


def picture_file(pixels: np.ndarray, path: str | os.PathLike[str]) -> None:
    """Write an image (height, width, 3) of bytes as PNG, atomically."""
    with atomic_path(path) as scratch:
        imsave(scratch, pixels, format="png", metadata={})


def styles(algorithms: Iterable[str]) -> dict[str, Style]:
    """Style of every algorithm; the known ones look the same whatever the company."""
    names = list(algorithms)
    strangers = [name for name in names if name not in PALETTE]
    spare = {name: CYCLE[i % len(CYCLE)] for i, name in enumerate(strangers)}
    markers = {name: SPARE_MARKERS[i % len(SPARE_MARKERS)] for i, name in enumerate(strangers)}
    return {
        name: Style(
            label=label(name),
            color=PALETTE.get(name) or spare[name],
            marker=_MARKERS.get(name) or markers[name],
            dash="--" if name.endswith("-task") else "-",
        )
        for name in names
    }


def label(algorithm: str) -> str:
    """The paper's spelling, "sdbo-task" → "SDBO-task"; other names stay as they are."""
    if algorithm not in PALETTE:
        return algorithm
    head, *tail = algorithm.split("-")
    return "-".join([head.upper(), *tail])


def line_sample(style: Style) -> Line2D:
    """What a legend shows of an algorithm's line."""
    return Line2D(
        [], [], color=style.color, ls=style.dash, lw=1.8, marker=style.marker, label=style.label
    )


def subscript(number: int) -> str:
    """A number as small digits below the line, 12 → "₁₂"."""
    return str(number).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))


def panels(figure: Figure, count: int, **options) -> list[Axes]:
    """A grid of `count` styled axes, at most three in a row."""
    columns = min(count, 3)
    grid = figure.subplots(math.ceil(count / columns), columns, squeeze=False, **options).ravel()
    for spare in grid[count:]:
        spare.remove()
    for axes in grid[:count]:
        quiet(axes)
    return list(grid[:count])


def quiet(axes: Axes) -> None:
    """Only what the eye needs: two spines, a faint grid behind the data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(QUIET)
    axes.tick_params(which="both", color=QUIET, labelcolor=INK, labelsize=9)
    axes.grid(True, color=FAINT, linewidth=0.8)
    axes.set_axisbelow(True)


def heading(figure: Figure, title: str) -> None:
    """Title at the top left, in as many lines as the width of the figure asks for."""
    title = textwrap.fill(title, int(LETTERS * figure.get_figwidth()))
    figure.suptitle(title, x=0.008, ha="left", fontsize=12, fontweight="bold", color=INK)


def remarks(figure: Figure, lines: Iterable[str]) -> None:
    """Sentences below the title, for what a picture cannot show."""
    across = int(_ACROSS * figure.get_figwidth() / 13)
    rows = [part for line in lines for part in textwrap.wrap(line, across)]
    engine, height = figure.get_layout_engine(), figure.get_figheight()
    if rows and isinstance(engine, ConstrainedLayoutEngine):
        look = {"fontsize": 9, "linespacing": 1.4, "va": "top", "color": INK}
        figure.text(0.008, 1 - 0.36 / height, "\n".join(rows), **look)
        engine.set(rect=(0, 0, 1, 1 - (len(rows) + 0.5) * 9 * 1.4 / 72 / height))


_ACROSS = 185
"""Characters in a line of remarks on a figure 13 inches wide."""


def legend(
    figure: Figure, handles: Sequence[Artist], size: float = 10.0, columns: int | None = None
) -> None:
    """One row below the panels, where it hides nothing; more rows of many or long entries.

    Args:
        figure: with panels.
        handles: what is shown.
        size: of letters (pt).
        columns: in how many; default as many as there is room for.
    """
    length = sum(len(str(handle.get_label())) + _SAMPLE for handle in handles)
    rows = max(1 + (len(handles) >= 10), math.ceil(length / (_LETTERS * figure.get_figwidth())))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns or -(-len(handles) // rows),
        frameon=False,
        fontsize=size,
        labelcolor=INK,
    )


_SAMPLE, _LETTERS = 8, 12.5
"""Letters that a legend's sample takes up with its gaps, and letters in an inch."""


def log_axis(axis: Axis) -> None:
    """Label a logarithmic axis with plain numbers, as many as its range asks for."""
    low, high = axis.get_view_interval()
    decades = math.log10(high / low) if 0 < low < high else 0
    steps = (1, 2, 5) if decades < 2.2 else (1, 3) if decades < 3.2 else (1,)
    axis.set_major_locator(LogLocator(subs=steps, numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.9g}"))
    axis.set_minor_formatter(NullFormatter())
