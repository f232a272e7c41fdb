"""Scales that are read with pleasure, wherever in the world and of whatever size a scene is."""

import math
from typing import Any

from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter

from jaxsusp.report.drawing.style import INK

FAR = 1e4
"""m beyond which coordinates have too many digits for a scale: it then counts from a round one."""

NAMES = "xyz"


def anchor(low: float, high: float, far: float = FAR) -> float:
    """What a scale from low to high counts from (m): 0, or a round number far from there."""
    if max(abs(low), abs(high)) < far:
        return 0.0
    step = 10.0 ** (math.ceil(math.log10(high - low)) + 1)
    return step * round((low + high) / 2 / step)


def axis_name(axis: int, low: float, high: float) -> str:
    """The name of a coordinate with its unit, and what it is counted from."""
    start = anchor(low, high)
    away = f" {'−' if start > 0 else '+'} {abs(start):.0f}" if start else ""
    return f"{NAMES[axis]}{away} (m)"


def tick(value: float, start: float) -> str:
    """A number on a scale that counts from `start`."""
    return f"{round(value - start, 9) + 0.0:g}"


def frame_plane(axes: Axes, shown: tuple[int, int], box: Any, places: Any = (), **text) -> None:
    """Limits, scales and names of a picture plane that shows a box, and some places beside it.

    Args:
        axes: plain axes in the coordinates of the world (m).
        shown: which coordinates go to the right and up.
        box: with the corners `lower` and `upper` (m).
        places: that are to be seen as well (m).
        text: how names are written.
    """
    for axis, scale, limit in (
        (shown[0], axes.xaxis, axes.set_xlim),
        (shown[1], axes.yaxis, axes.set_ylim),
    ):
        room = 0.04 * (box.upper[axis] - box.lower[axis])
        low, high = box.lower[axis], box.upper[axis]
        low = min([low, *(place[axis] - room for place in places if place[axis] < low)])
        high = max([high, *(place[axis] + room for place in places if place[axis] > high)])
        limit(low, high)
        count_from(scale, axis, low, high, **text)


def count_from(scale: Axis, axis: int, low: float, high: float, **text) -> None:
    """Name a scale, and let it count from a round number where it is far away."""
    if start := anchor(low, high):
        scale.set_major_formatter(
            FuncFormatter(lambda value, _: tick(value, start).replace("-", "−"))
        )
    scale.set_label_text(axis_name(axis, low, high), **{"fontsize": 10, "color": INK, **text})


def decimals(length: float) -> int:
    """Of heights and places in a scene whose own unit of length is so many metres."""
    return max(2, 2 - math.floor(math.log10(length) + 1e-9))
