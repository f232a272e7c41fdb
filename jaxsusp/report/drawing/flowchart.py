"""Flow charts: steps as boxes, loops as frames with the way back, conditions as hexagons."""

import textwrap
from collections.abc import Sequence
from typing import Any, NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from jaxsusp.report.drawing.sourceflow import Choice, Element, Leave, Loop, Step
from jaxsusp.report.drawing.style import INK, QUIET, picture

STEP, ASKED, FRAME = "#E3EEF6", "#FBEFD5", "#FAFAF8"

NAME, TEXT = 8.0, 7.2
"""Sizes of letters (points): of names and conditions, and of what they say."""

_LINE = {NAME: 0.145, TEXT: 0.132}
_ACROSS = {NAME: 13.6, TEXT: 17.6}
"""Inches of a line, and letters in an inch, by size; names are of one width."""

GAP, PAD, INSET = 0.2, 0.07, 0.2
"""Inches between boxes, within a box, and of a frame's contents from its sides."""


def chart(elements: Sequence[Element], start: str, width: float = 3.46) -> Figure:
    """A flow from top to bottom.

    Args:
        elements: what is done, see `sourceflow`.
        start: what the chart begins with, the name of the whole.
        width: of the figure, inches; the height follows.
    """
    ways = _exits(elements)
    right = width - 0.08 - (1.0 if ways else 0.0)
    sheet = _Sheet(right, width - 0.08)
    height = sheet.block([_Start(start), *elements], 0.08, right, 0.1) + 0.1
    figure = picture(width, height)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, width)
    axes.set_ylim(height, 0)
    for draw in sheet.drawn:
        draw(axes)
    return figure


class _Start(NamedTuple):
    """Where a flow begins."""

    name: str


class _Sheet:
    """Places boxes below each other; what is drawn is kept until the height is known."""

    def __init__(self, right: float, edge: float):
        self.right, self.edge = right, edge
        self.drawn = []

    def block(
        self, elements: "Sequence[Element | _Start]", left: float, right: float, top: float
    ) -> float:
        """Elements in order between two sides; returns where they end."""
        middle, below = (left + right) / 2, top
        for place, element in enumerate(elements):
            if place:
                ended = isinstance(elements[place - 1], Leave)
                label = _otherwise(elements[place - 1])
                if not ended:
                    self._arrow((middle, below), (middle, below + GAP), label)
                below += GAP
            below = self._element(element, left, right, below)
        return below

    def _element(self, element: "Element | _Start", left: float, right: float, top: float) -> float:
        match element:
            case Step(name, says):
                return self._step(name, says, left, right, top)
            case Loop(head, body):
                return self._framed(head, body, left, right, top, again=True)
            case Choice(condition, (Leave(how),), ()):
                return self._exit(condition, how, left, right, top)
            case Choice(condition, then, otherwise):
                below = top
                if then:
                    below = self._framed(f"if {condition}", then, left, right, below)
                if otherwise:
                    head = "otherwise" if then else f"if not ({condition})"
                    below = self._framed(head, otherwise, left, right, below + GAP * bool(then))
                return below
            case Leave(how):
                return self._end(_told(how), left, right, top)
            case _Start(name):
                return self._end(name, left, right, top)

    def _step(self, name: str, says: str, left: float, right: float, top: float) -> float:
        across = right - left - 2 * PAD
        lines = textwrap.wrap(says, int(across * _ACROSS[TEXT]))
        height = 2 * PAD + _LINE[NAME] + len(lines) * _LINE[TEXT]
        self._box(left, top, right - left, height, STEP)
        self._text(left + PAD, top + PAD, name, NAME, family="monospace", weight="bold")
        self._text(left + PAD, top + PAD + _LINE[NAME] + 0.015, "\n".join(lines), TEXT)
        return top + height

    def _framed(
        self, head: str, body: Sequence[Element], left: float, right: float, top: float,
        again: bool = False,
    ) -> float:  # fmt: skip
        """A frame with a heading; of a loop with the way back on the left."""
        place = len(self.drawn)
        lines = textwrap.wrap(head, int((right - left - 2 * PAD) * _ACROSS[NAME]))
        inner = top + 2 * PAD + len(lines) * _LINE[NAME]
        self._text(left + PAD, top + PAD, "\n".join(lines), NAME, family="monospace")
        shift = INSET if again else INSET / 2
        below = self.block(body, left + shift, right - INSET / 2, inner)
        end = below + (0.16 if again else 0.08)
        if again:
            x, middle = left + INSET / 2, (left + shift + right - INSET / 2) / 2
            way = [(middle, below), (middle, end - 0.07), (x, end - 0.07), (x, inner + 0.1)]
            self._line(way)
            self._arrow((x, inner + 0.1), (left + shift, inner + 0.1))
        self.drawn.insert(place, _rounded(left, top, right - left, end - top, FRAME, again))
        return end

    def _exit(self, condition: str, how: str, left: float, right: float, top: float) -> float:
        """A question; its yes leaves to the right."""
        lines = textwrap.wrap(condition, int((right - left - 4 * PAD) * _ACROSS[NAME]))
        height, tip = 2 * PAD + len(lines) * _LINE[NAME], 0.1
        corners = [
            (left, top + height / 2), (left + tip, top), (right - tip, top),
            (right, top + height / 2), (right - tip, top + height), (left + tip, top + height),
        ]  # fmt: skip
        self.drawn.append(
            lambda axes: axes.add_patch(Polygon(corners, fc=ASKED, ec=INK, lw=0.7, zorder=2))
        )
        self._text(left + 2 * PAD, top + PAD, "\n".join(lines), NAME, family="monospace")
        place = self.right + 0.28
        self._arrow((right, top + height / 2), (place, top + height / 2), "yes")
        told = "\n".join(textwrap.wrap(_told(how), int((self.edge - place) * _ACROSS[TEXT])))
        self._text(place + 0.03, top + height / 2, told, TEXT, va="center")
        return top + height

    def _end(self, text: str, left: float, right: float, top: float) -> float:
        height = 2 * PAD + _LINE[TEXT]
        across = min(right - left, 0.3 + len(text) / _ACROSS[TEXT])
        middle = (left + right) / 2
        self._box(middle - across / 2, top, across, height, "white", round_=0.1)
        self._text(middle, top + PAD, text, TEXT, ha="center")
        return top + height

    def _box(self, x, y, width, height, color, round_=0.03) -> None:
        self.drawn.append(_rounded(x, y, width, height, color, True, round_, zorder=2, edge=INK))

    def _text(self, x, y, text, size, **look) -> None:
        look = {"va": "top", "ha": "left", "color": INK, "zorder": 4, **look}
        self.drawn.append(
            lambda axes: axes.text(x, y, text, fontsize=size, linespacing=1.2, **look)
        )

    def _line(self, points: list[tuple[float, float]]) -> None:
        self.drawn.append(
            lambda axes: axes.plot(*zip(*points, strict=True), color=QUIET, lw=0.9, zorder=3)
        )

    def _arrow(self, start, stop, label: str = "") -> None:
        look = {"arrowstyle": "-|>", "color": INK, "lw": 0.8, "shrinkA": 0, "shrinkB": 0}
        level = start[1] == stop[1]
        x, y = (start[0] + stop[0]) / 2, (start[1] + stop[1]) / 2

        def draw(axes: Axes) -> None:
            axes.annotate("", stop, start, arrowprops={**look, "mutation_scale": 7}, zorder=3)
            side: dict[str, Any] = {"ha": "left", "va": "center"}
            if level:
                side = {"ha": "center", "va": "bottom"}
            axes.text(x + 0.05 * (not level), y - 0.02 * level, label, fontsize=TEXT, color=INK,
                      zorder=4, **side)  # fmt: skip

        self.drawn.append(draw)


def _rounded(x, y, width, height, color, solid, round_=0.05, zorder=1.0, edge=QUIET):
    """A box with round corners, dashed where it is no loop."""

    def draw(axes: Axes) -> None:
        axes.add_patch(
            FancyBboxPatch(
                (x, y),
                width,
                height,
                boxstyle=f"round,pad=0,rounding_size={round_}",
                fc=color,
                ec=edge,
                lw=0.7,
                ls="-" if solid else (0, (3, 2)),
                zorder=zorder,
            )
        )

    return draw


def _asks(element: "Element | _Start") -> bool:
    """Whether an element is a question whose yes leaves at once."""
    match element:
        case Choice(_, (Leave(),), ()):
            return True
    return False


def _otherwise(element: "Element | _Start") -> str:
    """What is written at the arrow from an element to the next."""
    if _asks(element):
        return "no"
    left = isinstance(element, Choice) and element.then and isinstance(element.then[-1], Leave)
    return "otherwise" if left else ""


def _exits(elements: Sequence[Element]) -> bool:
    """Whether any question has its yes on the right."""
    inner = [
        part
        for element in elements
        for part in (
            (element.body,) if isinstance(element, Loop)
            else (element.then, element.otherwise) if isinstance(element, Choice) else ()
        )
    ]  # fmt: skip
    return any(map(_asks, elements)) or any(map(_exits, inner))


def _told(how: str) -> str:
    """What leaving means, in words."""
    return "leave the loop" if how == "break" else "done" if how == "return" else how
