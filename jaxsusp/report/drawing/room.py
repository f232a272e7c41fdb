"""The room a scene stands in: floor, scales and the edges of the workspace."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from jaxsusp.report.drawing.painting import paint_label
from jaxsusp.report.drawing.scales import anchor, axis_name, tick
from jaxsusp.report.drawing.solids import Camera
from jaxsusp.report.drawing.style import FAINT, QUIET

PAPER = "#F6F6F4"


def ground_of(scenario: Any) -> float:
    """The z of the floor of a picture (m): the ground, or below all where there is none."""
    if scenario.ground_height is not None:
        return scenario.ground_height
    return min(scenario.workspace.lower[2], *(robot.base[2] for robot in scenario.robots))


def paint_room(axes: Axes, camera: Camera, lower, upper, floor: float = 0.0) -> None:
    """Draw the floor with a grid and its scales, and the workspace as a wire box.

    Args:
        axes: plain axes.
        camera: who looks.
        lower: lowest corner of the workspace (m).
        upper: highest corner (m).
        floor: its z, that of the ground where there is one (m).
    """
    low, high = np.asarray(lower, np.float64), np.asarray(upper, np.float64)
    ring = _ring(low, high)
    outline = camera.project(np.array([[x, y, floor] for x, y in ring]))
    axes.fill(*outline.T, facecolor=PAPER, edgecolor=QUIET, lw=0.8, zorder=1)
    grid = [((x, low[1], floor), (x, high[1], floor)) for x in _ticks(low[0], high[0])]
    grid += [((low[0], y, floor), (high[0], y, floor)) for y in _ticks(low[1], high[1])]
    _segments(axes, camera, grid, color=FAINT, lw=0.8, zorder=1.1)
    edges = [((x, y, low[2]), (x, y, high[2])) for x, y in ring]
    for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
        edges += [((*a, z), (*b, z)) for z in (low[2], high[2])]
    _segments(axes, camera, edges, color=QUIET, lw=0.7, ls=(0, (2, 3)), zorder=1.2)
    _scales(axes, camera, low, high, floor)


def _scales(axes: Axes, camera: Camera, low, high, floor: float) -> None:
    """Numbers along the two floor edges next to the viewer and up the edge on the left."""

    def label(point, text) -> None:
        paint_label(axes, camera, point, text, color=QUIET)

    gap = 0.045 * (high - low).max()  # between an edge and its numbers
    starts = [anchor(*ends) for ends in zip(low, high, strict=True)]
    names = [axis_name(i, *ends) for i, ends in enumerate(zip(low, high, strict=True))]
    sides = np.where(camera.towards[:2] > 0, 1, -1)
    near, away = np.where(sides > 0, high[:2], low[:2]), gap * sides
    for x in _ticks(low[0], high[0]):
        label((x, near[1] + away[1], floor), tick(x, starts[0]))
    for y in _ticks(low[1], high[1]):
        label((near[0] + away[0], y, floor), tick(y, starts[1]))
    middle = (low + high) / 2
    off = [4.6 if start else 3.2 for start in starts]  # longer names
    label((middle[0], near[1] + off[0] * away[1], floor), names[0])
    label((near[0] + off[1] * away[0], middle[1], floor), names[1])
    left = min(_ring(low, high), key=lambda corner: camera.frame[0, :2] @ corner)
    left = left - 0.7 * gap * camera.frame[0, :2]
    for z in _ticks(low[2], high[2]):
        label((*left, z), tick(z, starts[2]))
    label((*left, high[2] + gap), names[2])


def _ticks(low: float, high: float) -> list[float]:
    """Round numbers between low and high, about eight of them."""
    values = MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(low, high)
    return [float(value) for value in values if low <= value <= high]


def _ring(low, high) -> list[tuple[float, float]]:
    """The corners of the workspace seen from above, in order."""
    return [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]


def _segments(axes: Axes, camera: Camera, pairs: list, **look) -> None:
    for pair in pairs:
        axes.plot(*camera.project(np.array(pair, np.float64)).T, **look)
