"""Bodies and curves on plain axes through a parallel camera, the hidden parts pale."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from scipy.spatial import ConvexHull

from jaxsusp.report.drawing.solids import Camera, Solid
from jaxsusp.report.drawing.style import INK

Curve = Float[np.ndarray, "points xyz"]

ALARM, REFUGE = "#B00020", "#00703C"
"""Where the load must not be, and where else it could be."""

HALO = [withStroke(linewidth=2.2, foreground="white")]


def paint_solid(
    axes: Axes, camera: Camera, solid: Solid, color: str, alpha: float = 1.0, zorder: float = 2.0,
    rim: float = 0.7,
) -> None:  # fmt: skip
    """A shaded body: light from above, behind the viewer's left shoulder."""
    right, up = camera.frame
    light = camera.towards - 0.45 * right + 0.75 * up
    facing = np.flatnonzero(solid.normals @ camera.towards > 1e-9)
    bright = 0.62 + 0.38 * np.clip(solid.normals @ light / np.linalg.norm(light), 0, 1)
    tones = np.clip(bright[facing, None] * np.array(to_rgb(color)) * 1.06, 0, 1)
    faces = axes.add_collection(
        PolyCollection(
            [camera.project(solid.faces[i]) for i in facing],
            facecolors=tones,
            edgecolors="face" if solid.smooth else "white",  # no seams between smooth faces
            linewidths=0.5,
            zorder=zorder,
        ),
        autolim=False,
    )
    if alpha < 1:  # the body as a whole, where alpha would show overlaps
        faces.set_agg_filter(_fade(alpha))
    outline = camera.project(solid.corners)
    outline = outline[ConvexHull(outline).vertices]
    edge = tuple(0.6 * np.array(to_rgb(color)))
    axes.fill(*outline.T, facecolor="none", edgecolor=edge, linewidth=rim, zorder=zorder + 1e-4)


def paint_curve(
    axes: Axes, camera: Camera, solids: list[Solid], curve: Curve, zorder: float, **line
) -> None:
    """A polyline: full where it is in sight, thin and pale where a body is in front of it."""
    fine = refine(curve)
    out_of_sight = hidden((fine[:-1] + fine[1:]) / 2, solids, camera)
    flat = camera.project(fine)
    turns = np.flatnonzero(np.diff(out_of_sight)) + 1
    for part in np.split(np.arange(len(out_of_sight)), turns):
        points = flat[part[0] : part[-1] + 2]
        look = {"solid_capstyle": "butt", "zorder": zorder, **line}
        if out_of_sight[part[0]]:
            look |= {"alpha": 0.4, "linewidth": 0.55 * line["linewidth"]}
        axes.plot(*points.T, **look)


def paint_label(
    axes: Axes, camera: Camera, point: tuple | np.ndarray, text: str, **options
) -> None:
    """Text at a point of the scene, with a halo that keeps it legible on anything."""
    x, y = camera.project(np.asarray(point, np.float64))
    look = {"fontsize": 8, "color": INK, "ha": "center", "va": "center", "zorder": 9, **options}
    axes.text(x, y, text, path_effects=HALO, clip_on=True, **look)


def paint_misplaced(
    axes: Axes,
    blocked: Iterable[Any],
    project: Callable,
    shown: Callable[[np.ndarray], bool] = lambda place: True,
) -> None:
    """Crosses where the load must not be, and arrows to the nearest places where it may.

    Args:
        axes: of the picture.
        blocked: `suspension.misplaced.Misplaced`.
        project: from a place in the world to one in the picture.
        shown: whether a place is in what the picture shows, a slice for instance; faint if not.
    """
    for each in blocked:
        place = np.array(each.at)
        at = project(place)
        axes.plot(*at, "X", zorder=9.6, **_CROSS, alpha=1 if shown(place) else _FAINT)
        if each.nearest is not None:
            nearest = np.array(each.nearest)
            to, alpha = project(nearest), 1 if shown(nearest) else _FAINT
            arrow = {"arrowstyle": "->", "color": REFUGE, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", to, at, arrowprops=arrow | {"alpha": alpha}, zorder=9.4)
            axes.plot(*to, "o", zorder=9.5, **_RING, alpha=alpha)


def misplaced_samples(blocked: Iterable[Any]) -> list[Line2D]:
    """Legend entries of what `paint_misplaced` draws."""
    blocked = list(blocked)
    if not blocked:
        return []
    names = ", ".join(each.name for each in blocked)
    entries = [Line2D([], [], ls="", marker="X", label=f"{names}: no place for the load", **_CROSS)]
    if any(each.nearest is not None for each in blocked):
        entries.append(Line2D([], [], ls="", marker="o", label="nearest place for it", **_RING))
    return entries


_FAINT = 0.3
"""Opacity of what is elsewhere than the slice that a picture shows."""

_CROSS = {"ms": 9, "mfc": ALARM, "mec": "white", "mew": 0.8}
_RING = {"ms": 11, "mfc": "none", "mec": REFUGE, "mew": 1.8}  # seen around a cross as well


def freest(
    places: Float[np.ndarray, "places picture=2"],
    drawn: Float[np.ndarray, "points picture=2"],
    enough: float,
) -> int:
    """The first of some places in the picture that is far enough from what is drawn.

    Args:
        places: where something could go (m).
        drawn: points of what is there (m).
        enough: distance with which to be content (m); without such a place it is the farthest.
    """
    apart = np.linalg.norm(places[:, None] - drawn, axis=-1).min(axis=1)
    return int(np.minimum(apart, enough).argmax())


def _fade(alpha: float) -> Callable:
    """A filter of matplotlib's Agg renderer that makes a finished drawing translucent."""

    def fade(image: np.ndarray, dpi) -> tuple[np.ndarray, int, int]:
        image[..., 3] *= alpha
        return image, 0, 0

    return fade


def refine(curve: Curve, parts: int = 6) -> Float[np.ndarray, "refined xyz"]:
    """The same polyline with every segment cut into equal parts."""
    curve = np.asarray(curve, np.float64)
    knots = np.arange(len(curve))
    fine = np.linspace(0, len(curve) - 1, parts * (len(curve) - 1) + 1)
    return np.stack([np.interp(fine, knots, axis) for axis in curve.T], axis=1)


def hidden(points: Curve, solids: list[Solid], camera: Camera) -> Bool[np.ndarray, " points"]:
    """Which points lie behind any of the bodies."""
    result = np.zeros(len(points), bool)
    spread = camera.spread(points)
    for solid in solids:
        if camera.overlap(spread, camera.spread(solid.corners)):
            result |= solid.hides(points, camera.towards)
    return result
