"""The workspace picture: slices through the positions that a suspension can hold."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from jaxsusp.report.drawing.painting import HALO, misplaced_samples, paint_misplaced
from jaxsusp.report.drawing.scales import decimals, frame_plane
from jaxsusp.report.drawing.style import FAINT, INK, QUIET, heading, legend, picture, quiet, remarks
from jaxsusp.report.drawing.style import save as save
from jaxsusp.report.render import Column, percent, significant
from jaxsusp.suspension.misplaced import Misplaced
from jaxsusp.suspension.workspace import Workspace

_BLOCKED = "#B9A7A0"
_MARGIN = LinearSegmentedColormap.from_list("margin", ["#DCEBF5", "#56A0CC", "#0B4A78"])
_NAMES = "xyz"


def slices(space: Workspace, blocked: Sequence[Misplaced] = ()) -> Figure:
    """Three level and three upright slices; colour is the margin of the tensions to their limits.

    Level slices go through start, goal and the middle between their heights, upright ones likewise,
    looking along the shorter side of the way; where that is no way at all, through it and a fifth
    of the workspace to either side. What is `blocked` is marked, with the nearest place for it.
    """
    figure = picture(13.0, 7.4)
    grid = figure.subplots(2, 3)
    task = np.array([space.scenario.task.start, space.scenario.task.goal])
    middle = task.mean(axis=0)
    heights = _spread(task[0, 2], middle[2], task[1, 2], space.axes[2])
    cuts = [(2, height, (0, 1)) for height in heights]
    across = 1 if np.ptp(task[:, 0]) >= np.ptp(task[:, 1]) else 0  # look along the shorter way
    places = _spread(task[0, across], middle[across], task[1, across], space.axes[across])
    cuts += [(across, place, (1 - across, 2)) for place in places]
    images = [paint_slice(axes, space, *cut) for axes, cut in zip(grid.flat, cuts, strict=True)]
    for axes, (normal, at, shown) in zip(grid.flat, cuts, strict=True):

        def projected(place: np.ndarray, shown=shown) -> np.ndarray:
            return place[list(shown)]

        def in_slice(place: np.ndarray, normal=normal, at=at) -> bool:
            return bool(abs(place[normal] - at) <= _pitch(space, normal))

        paint_misplaced(axes, blocked, projected, in_slice)
    paint_scale(figure, images[0], grid)
    legend(figure, [*slice_samples(), *misplaced_samples(blocked)])
    remarks(figure, [each.words for each in blocked])
    usable, box = space.volume(space.usable), space.cell * space.clear.size
    heading(
        figure,
        f"{space.scenario.name}: {significant(usable, 3)} m³ of {significant(box, 3)} m³ "
        f"({usable / box:.0%}) can be held",
    )
    return figure


def paint_scale(figure: Figure, image: Any, beside: Any) -> None:
    """The scale of the colour of slices, beside their axes."""
    bar = figure.colorbar(image, ax=beside, shrink=0.7, aspect=30, pad=0.015)
    bar.set_label("margin of the tensions to their limits", fontsize=10, color=INK)
    bar.outline.set_edgecolor(QUIET)
    bar.ax.tick_params(color=QUIET, labelcolor=INK, labelsize=9)


def slice_samples() -> list[Patch]:
    """Legend entries of slices."""
    return [
        Patch(color=_MARGIN(0.6), label="can be held"),
        Patch(color=_BLOCKED, label="could be held, but load or a cable meets an obstacle"),
        Patch(facecolor="white", edgecolor=QUIET, label="cannot be held"),
    ]


def volume_table(space: Workspace) -> pd.DataFrame:
    """Volumes (m³) and shares of the workspace box."""
    rows = {
        "workspace box": np.ones_like(space.clear),
        "admissible tensions": space.admissible,
        "clear of obstacles": space.clear,
        "both": space.usable,
    }
    frame = pd.DataFrame(
        {
            "set": list(rows),
            "volume": [space.volume(which) for which in rows.values()],
            "share": [float(which.mean()) for which in rows.values()],
        }
    )
    frame.attrs["title"] = f"Load positions of {space.scenario.name}"
    frame.attrs["columns"] = {
        "volume": Column("volume (m³)"),
        "share": Column("share of the box", percent),
    }
    counts = " × ".join(str(len(axis)) for axis in space.axes)
    frame.attrs["caption"] = f"{counts} cells, judged at their centres"
    return frame


def paint_slice(axes: Axes, space: Workspace, normal: int, at: float, shown: tuple[int, int]):
    """One slice: the layer of cells next to `at` along the axis `normal`."""
    digits = decimals(space.scenario.units.length)
    layer = int(np.abs(space.axes[normal] - at).argmin())
    usable, admissible, margin = (
        np.take(array, layer, axis=normal).T
        for array in (space.usable, space.admissible, space.margin)
    )
    across, up = (space.axes[axis] for axis in shown)
    quiet(axes)
    axes.grid(False)
    axes.set_facecolor("white")
    look = {"shading": "nearest", "rasterized": True}
    blocked = np.ma.masked_where(~(admissible & ~usable), np.ones_like(margin))
    axes.pcolormesh(across, up, blocked, cmap=ListedColormap([_BLOCKED]), **look)
    held = np.ma.masked_where(~usable, margin)
    image = axes.pcolormesh(across, up, held, cmap=_MARGIN, vmin=0, vmax=1, **look)
    _landmarks(axes, space, normal, float(space.axes[normal][layer]), shown)
    axes.set_aspect("equal")
    task = space.scenario.task
    frame_plane(axes, shown, space.scenario.workspace, (task.start, task.goal), fontsize=9)
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_color(FAINT)
    axes.set_title(f"{_NAMES[normal]} = {space.axes[normal][layer]:.{digits}f} m", loc="left",
                   fontsize=10, fontweight="bold", color=INK)  # fmt: skip
    return image


def _landmarks(
    axes: Axes, space: Workspace, normal: int, at: float, shown: tuple[int, int]
) -> None:
    """Start and goal, full in the slice that holds them and hollow in the others."""
    pitch = _pitch(space, normal)
    for name in ("start", "goal"):
        place = np.array(getattr(space.scenario.task, name))
        here = abs(place[normal] - at) <= pitch
        x, y = place[list(shown)]
        axes.plot(x, y, "o", ms=6, mec=INK, mfc=INK if here else "none", mew=1.2, zorder=5)
        axes.annotate(
            name, (x, y), xytext=(6, 5), textcoords="offset points", fontsize=8,
            color=INK if here else "#5F6670", zorder=6, path_effects=HALO,
        )  # fmt: skip


def _pitch(space: Workspace, axis: int) -> float:
    """From one layer of cells to the next (m)."""
    return float(np.diff(space.axes[axis]).max(initial=0.1 * space.scenario.units.length))


def _spread(first: float, middle: float, last: float, axis: np.ndarray) -> list[float]:
    """Three places to cut: those asked for, or one to either side where they are the same."""
    if abs(last - first) > 3 * float(np.diff(axis).max(initial=0)):
        return [first, middle, last]
    away = float(np.ptp(axis)) / 5
    return [middle - away, middle, middle + away]
