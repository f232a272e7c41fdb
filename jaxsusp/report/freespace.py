"""The free space of a scenario in pictures and tables: the paper's Figs 5 and 6."""

import math
import re
from collections.abc import Sequence

import numpy as np
import pandas as pd
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Ellipse, Patch

from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces, corners_of
from jaxsusp.freespace.space import FreeSpace, Route
from jaxsusp.report.drawing.painting import (
    misplaced_samples,
    paint_curve,
    paint_misplaced,
    paint_solid,
)
from jaxsusp.report.drawing.scales import decimals, frame_plane
from jaxsusp.report.drawing.scene import LOAD, STONE, cable_samples, stage
from jaxsusp.report.drawing.solids import Solid, of_obstacle
from jaxsusp.report.drawing.style import CYCLE, INK, heading, legend, panels, picture, remarks
from jaxsusp.report.render import Column
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.misplaced import Misplaced

ROUTE, SHADOW, FREE, WAY = "#C43C00", "#E3B7A0", "#0072B2", "#7A0177"

NEAR = 0.25
"""Own units of length from a section within which places and the route are drawn as in it."""

Polygon = Float[np.ndarray, "corners 2"]


def slices(scenario: Scenario, space: FreeSpace, blocked: Sequence[Misplaced] = ()) -> Figure:
    """Horizontal sections at three heights of the route: the paper's Fig. 5.

    Obstacles, what the load or a cable keeps it out of, the regions' polygons and ellipses, and
    the route seen from above, strong where it is near the height of the section. What is
    `blocked` is marked, with the nearest place for it.
    """
    figure = picture(13.0, 5.2)
    bodies = bodies_of(scenario)
    heights = _heights(scenario, space)
    all_axes = panels(figure, len(heights), sharey=True)
    unit, task = scenario.units.length, (scenario.task.start, scenario.task.goal)
    near = NEAR * unit
    for axes, height in zip(all_axes, heights, strict=True):
        for body in bodies:
            _fill(axes, body.faces, height, scenario, facecolor=SHADOW, alpha=0.55, lw=0, zorder=1)
        for obstacle in scenario.obstacles:
            solid = of_obstacle(obstacle)
            halves = HalfSpaces(solid.normals, solid.offsets)
            _fill(axes, halves, height, scenario, facecolor=STONE, ec=INK, lw=0.8, zorder=2)
        for number, region in enumerate(space.regions):
            on_route = number in space.route
            _section(axes, region, height, scenario, on_route)
        _route_from_above(axes, space, height, near)
        for name, place in (("start", scenario.task.start), ("goal", scenario.task.goal)):
            solid = abs(place[2] - height) < near  # hollow where the section does not hold it
            fill, rim = (LOAD, "white") if solid else ("none", LOAD)
            axes.plot(*place[:2], "o", ms=5, mfc=fill, mec=rim, zorder=8)
            axes.annotate(
                name, place[:2], xytext=(6, 4), textcoords="offset points", fontsize=8, zorder=9
            )
        paint_misplaced(
            axes,
            blocked,
            lambda place: place[:2],
            lambda place, height=height: bool(abs(place[2] - height) < near),
        )
        axes.set_title(
            f"z = {height:.{decimals(unit)}f} m", loc="left", fontsize=10, fontweight="bold"
        )
        axes.set_aspect("equal")
        frame_plane(axes, (0, 1), scenario.workspace, task, fontsize=9)
        axes.grid(False)
    for axes in all_axes[1:]:
        axes.set_ylabel("")
    heading(figure, f"{scenario.name}: {_caption(space)}")
    legend(
        figure,
        [
            Patch(fc=STONE, ec=INK, lw=0.8, label="obstacle"),
            Patch(fc=SHADOW, alpha=0.55, label="load or cable in contact"),
            Line2D([], [], color=FREE, lw=0.8, label="polytopes"),
            Line2D([], [], color=FREE, lw=0.8, ls=":", label="ellipsoids"),
            *[Line2D([], [], color=FREE, lw=2.2, label="on the route")] * space.connected,
            *[Line2D([], [], color=ROUTE, lw=2.2, label="shortest polyline")] * space.connected,
            *misplaced_samples(blocked),
        ],
    )
    remarks(figure, [each.words for each in blocked])
    return figure


def view(scenario: Scenario, space: FreeSpace, blocked: Sequence[Misplaced] = ()) -> Figure:
    """The regions of the route and the polyline in the scene: the paper's Fig. 6.

    Where there is no route, all regions, and what is `blocked`.
    """
    shown = space.route.tolist() or list(range(len(space.d)))
    number_of = {index: number for number, index in enumerate(shown)}
    curves = [space.polyline] if space.connected else []
    figure, stages = stage(scenario, curves)
    for axes, eye, solids in stages:
        look = {"alpha": 0.16} if space.connected else {"alpha": 0.06, "rim": 0.25}
        for index, number in number_of.items():
            solid = _solid(space.regions[index])
            color = CYCLE[number % len(CYCLE)] if space.connected else FREE
            paint_solid(axes, eye, solid, color, zorder=3.2 + 0.01 * number, **look)
        for route in space.routes:
            paint_curve(axes, eye, solids, route.polyline, zorder=4.9, color=WAY, linewidth=1.6)
        for curve in curves:
            paint_curve(axes, eye, solids, curve, zorder=5.0, color=ROUTE, linewidth=2.4)
            axes.plot(*eye.project(curve[1:-1]).T, "o", ms=4, color=ROUTE, zorder=6)
        paint_misplaced(axes, blocked, eye.project)
    heading(figure, f"{scenario.name}: {_caption(space)}")
    regions = [
        Patch(fc=CYCLE[n % len(CYCLE)], alpha=0.35, label=f"region {index + 1}")
        for n, index in enumerate(space.route)
    ]
    line = [Line2D([], [], color=ROUTE, lw=2.4, label="along the route")] if curves else []
    line += [Line2D([], [], color=WAY, lw=1.6, label="distinct taut ways")] if space.routes else []
    if not space.connected:
        regions = [Patch(fc=FREE, alpha=0.35, label="free space")] if shown else []
    legend(figure, [*cable_samples(), *line, *regions, *misplaced_samples(blocked)])
    remarks(figure, [each.words for each in blocked])
    return figure


def region_table(space: FreeSpace) -> pd.DataFrame:
    """One row per region: number, volumes, faces, neighbours, place on the route."""
    volumes = space.volumes
    place = {int(region): step for step, region in enumerate(space.route, start=1)}
    frame = pd.DataFrame(
        {
            "region": np.arange(1, len(space.d) + 1),
            "polytope": volumes[:, 0],
            "ellipsoid": volumes[:, 1],
            "faces": [len(region.polytope.b) for region in space.regions],
            "neighbours": space.adjacency.sum(axis=1),
            "route": [str(place.get(i, "")) for i in range(len(space.d))],
        }
    )
    frame.attrs["title"] = "Regions"
    frame.attrs["columns"] = {
        "polytope": Column("polytope (m³)"),
        "ellipsoid": Column("ellipsoid (m³)"),
        "route": Column("on route"),
    }
    frame.attrs["caption"] = _caption(space)
    return frame


def ways(routes: Sequence[Route], asked: int = 0) -> list[str]:
    """One line per distinct way from start to goal: its length, and what it goes round.

    Args:
        routes: the ways.
        asked: how many were asked for; where there are fewer, one line more says so.
    """
    lines = [
        f"way {number}: {route.length:.3f} m, {_words(route.bends)}"
        for number, route in enumerate(routes, start=1)
    ]
    if len(routes) < asked:
        known = "1 distinct way is" if len(routes) == 1 else f"{len(routes)} distinct ways are"
        lines.append(f"Only {known} known; {asked} were asked for.")
    return lines


def _words(bends: tuple[str, ...]) -> str:
    """What a way goes round, by the names of the obstacles."""
    return (
        "; ".join(re.sub(r'obstacles\[\d+\] "([^"]*)"', r"\1", each) for each in bends)
        or "straight"
    )


def _caption(space: FreeSpace) -> str:
    parts = f"{len(space.d)} regions cover {100 * space.coverage:.1f} % of the free space"
    if not space.connected:
        return f"{parts}; no route from start to goal"
    names = " → ".join(str(index + 1) for index in space.route)
    return f"{parts}; route through {names}, shortest polyline {space.length:.3f} m"


def _heights(scenario: Scenario, space: FreeSpace) -> list[float]:
    """Heights (m) at the start, half-way along the route, and at the goal."""
    if not space.connected:
        return [scenario.task.start[2], scenario.task.goal[2]]
    steps = np.linalg.norm(np.diff(space.polyline, axis=0), axis=1)
    gone = np.concatenate([[0.0], np.cumsum(steps)])
    middle = np.interp(gone[-1] / 2, gone, space.polyline[:, 2])
    return [scenario.task.start[2], float(middle), scenario.task.goal[2]]


def _route_from_above(axes: Axes, space: FreeSpace, height: float, near: float) -> None:
    if not space.connected:
        return
    t = np.linspace(0, len(space.polyline) - 1, 60 * (len(space.polyline) - 1) + 1)
    fine = np.stack(
        [np.interp(t, np.arange(len(space.polyline)), c) for c in space.polyline.T], axis=1
    )
    axes.plot(fine[:, 0], fine[:, 1], color=ROUTE, lw=1.0, alpha=0.5, zorder=6)
    beside = np.abs(fine[:, 2] - height) < near
    level = np.where(beside[:, None], fine, np.nan)
    axes.plot(level[:, 0], level[:, 1], color=ROUTE, lw=2.4, zorder=7)


def _section(axes: Axes, region: Region, height: float, scenario: Scenario, strong: bool) -> None:
    """Polygon and ellipse of a region at a height."""
    look = {"lw": 2.2, "alpha": 0.9} if strong else {"lw": 0.7, "alpha": 0.55}
    _fill(axes, region.polytope, height, scenario, facecolor="none", ec=FREE, zorder=4, **look)
    if strong:
        _fill(axes, region.polytope, height, scenario, facecolor=FREE, alpha=0.1, lw=0, zorder=3)
    ellipse = ellipse_of(region.ellipsoid, height)
    if ellipse is not None:
        ellipse.set(fill=False, edgecolor=FREE, linestyle=":", zorder=4, **look)
        axes.add_patch(ellipse)


def _fill(axes: Axes, halves: HalfSpaces, height: float, scenario: Scenario, **look) -> None:
    polygon = section(halves, height, scenario.workspace.lower[:2], scenario.workspace.upper[:2])
    if len(polygon):
        axes.fill(*polygon.T, **look)


def section(halves: HalfSpaces, height: float, lower, upper) -> Polygon:
    """The polygon that a polyhedron cuts out of a level rectangle; empty where it does not.

    The rectangle is clipped by one half-plane after the other (Sutherland & Hodgman 1974).
    """
    (x0, y0), (x1, y1) = lower, upper
    polygon = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], np.float64)
    for normal, offset in zip(halves.A, halves.b - halves.A[:, 2] * height, strict=True):
        if not len(polygon):
            break
        room = offset - polygon @ normal[:2]
        following = np.roll(polygon, -1, axis=0), np.roll(room, -1)
        kept = []
        for point, here, ahead, there in zip(polygon, room, *following, strict=True):
            if here >= 0:
                kept.append(point)
            if here * there < 0:
                kept.append(point + here / (here - there) * (ahead - point))
        polygon = np.array(kept).reshape(-1, 2)
    return polygon


def ellipse_of(ellipsoid: Ellipsoid, height: float) -> Ellipse | None:
    """The ellipse that an ellipsoid cuts out of a level plane."""
    inverse = np.linalg.inv(ellipsoid.C @ ellipsoid.C.T)
    up = height - ellipsoid.d[2]
    flat = np.linalg.inv(inverse[:2, :2])
    shift = -flat @ inverse[:2, 2] * up
    left = 1 - up**2 * (inverse[2, 2] - inverse[:2, 2] @ flat @ inverse[:2, 2])
    if left <= 0:
        return None
    squares, axes = np.linalg.eigh(flat * left)
    width, high = 2 * np.sqrt(squares)
    angle = np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))
    center = ellipsoid.d[:2] + shift
    return Ellipse((center[0], center[1]), width, high, angle=angle)


def _solid(region: Region) -> Solid:
    """A region's polytope as a body that can be drawn."""
    middle = region.ellipsoid.d
    offsets = region.polytope.b - region.polytope.A @ middle  # about the middle: far away it is 0
    corners = corners_of(HalfSpaces(region.polytope.A, offsets), np.zeros(3))
    near, fine = 1e-6 * np.ptp(corners), 9 - math.floor(math.log10(np.ptp(corners)))
    faces = []
    for normal, offset in zip(region.polytope.A, offsets, strict=True):
        on_face = np.unique(corners[np.abs(corners @ normal - offset) < near].round(fine), axis=0)
        if len(on_face) >= 3:
            across = np.linalg.svd(normal[None])[2][1:]  # two directions in the face
            flat = (on_face - on_face.mean(axis=0)) @ across.T
            turned = np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))
            faces.append(middle + on_face[turned])
    return Solid.of_faces(faces)
