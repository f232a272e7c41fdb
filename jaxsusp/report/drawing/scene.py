"""A scenario and the best trajectories in it: the paper's Fig. 7, view and top view."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import jax.numpy as jnp
import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jaxsusp.mechanics import arm
from jaxsusp.mechanics.drives import moving
from jaxsusp.report.comparison.gaps import runs_made
from jaxsusp.report.drawing.painting import (
    Curve,
    hidden,
    paint_curve,
    paint_label,
    paint_solid,
    refine,
)
from jaxsusp.report.drawing.room import ground_of, paint_room
from jaxsusp.report.drawing.scales import frame_plane
from jaxsusp.report.drawing.solids import Camera, Solid, of_load, of_obstacles, solids_of
from jaxsusp.report.drawing.style import (
    INK,
    QUIET,
    Style,
    heading,
    legend,
    picture,
    quiet,
    styles,
    subscript,
)
from jaxsusp.report.drawing.style import save as save
from jaxsusp.report.render import significant
from jaxsusp.scenario.ownunits import frame_of
from jaxsusp.scenario.world import attachments_of
from jaxsusp.suspension.rigging import ends_beside

STONE = "#C9CDD3"
LOAD = "#5A5F69"

WIDTH = 13.0
"""Inches; of figures for a screen."""

BESIDE = 0.4
"""Own units of length in the picture, within which what stands before a curve disturbs it."""

_CABLES = {"start": "-", "goal": (0, (5, 3))}
"""Dashes of the cables at either end of the task."""


def scene(
    scenario: Any, ds: xr.Dataset | None = None, arms: bool = False, width: float = WIDTH
) -> Figure:
    """Draw a scenario: a view from where the trajectories are seen best, and the top view.

    Cables are shown at start (solid) and goal (dashed). What an obstacle hides is thin and pale.

    Args:
        scenario: a `Scenario`.
        ds: the comparison at this scenario, with `position` (algorithm, sample, axis) and
            `fitness`, `collisions`, `violations` (algorithm, run); None draws the scenario alone.
        arms: draw the robots as well, in the view only.
        width: of the figure, inches; below `WIDTH` it is for print: curves carry markers, and the
            obstacles' names are left to the caption.

    Returns:
        A figure with two axes: the view (metres in the picture plane) and the top view (x, y).
    """
    curves, printed = _trajectories(ds), width < WIDTH
    look = styles(curves)
    figure, stages = stage(scenario, list(curves.values()), width)
    for axes, eye, solids in stages:
        for name, curve in curves.items():
            paint_curve(
                axes, eye, solids, curve, zorder=5.0, color=look[name].color, linewidth=2.2,
                linestyle=look[name].dash,
            )  # fmt: skip
    if printed:
        _mark(stages, curves, look)
    if arms:
        _arms(*stages[0][:2], scenario)
    best = "" if ds is None else f": best of {runs_made(ds)} per algorithm, and its fitness"
    heading(figure, scenario.name + best)
    legend(figure, [*cable_samples(), *_samples(ds, printed)])
    return figure


Stage = tuple[Axes, Camera, list[Solid]]
"""Axes, who looks, and the obstacles in sight."""


def stage(
    scenario: Any, curves: list[Curve], width: float = WIDTH
) -> tuple[Figure, tuple[Stage, Stage]]:
    """A figure of a scenario to draw into: a view that shows the curves well, and the top view.

    Args:
        scenario: a `Scenario`; its obstacles, loads and cables are drawn.
        curves: what is to be seen (m); none for a view of the task.
        width: of the figure, inches.
    """
    task = np.array([scenario.task.start, scenario.task.goal], np.float64)
    solids = of_obstacles(scenario.obstacles)
    camera = best_view(solids, curves or [task], unit=frame_of(scenario).length)
    figure = picture(width, 7.0 / 13.0 * width)
    view, top = figure.subplots(1, 2, width_ratios=[1.25, 1])
    paint_room(
        view, camera, scenario.workspace.lower, scenario.workspace.upper, ground_of(scenario)
    )
    stages = (view, camera, solids), (top, Camera.above(), solids)
    for axes, eye, _ in stages:
        _obstacles(axes, eye, scenario, solids)
        _cables(axes, eye, scenario, solids)
    _finish_view(view, scenario, named=width >= WIDTH)
    _finish_top(top, scenario)
    return figure, stages


def paint_task(axes: Axes, scenario: Any, camera: Camera | None = None) -> Camera:
    """Draw a task with its robots into axes of somebody else's figure.

    Args:
        axes: plain axes; they get metres in the picture plane.
        scenario: a `Scenario`; its start and goal may be inadmissible.
        camera: who looks; by default from where start and goal are seen best.
    """
    solids = of_obstacles(scenario.obstacles)
    task = np.array([scenario.task.start, scenario.task.goal], np.float64)
    eye = camera or best_view(solids, [task], unit=frame_of(scenario).length)
    paint_room(axes, eye, scenario.workspace.lower, scenario.workspace.upper, ground_of(scenario))
    _obstacles(axes, eye, scenario, solids)
    _cables(axes, eye, scenario, solids)
    _arms(axes, eye, scenario)
    _finish_view(axes, scenario)
    return eye


def best_view(
    solids: list[Solid], curves: list[Curve], posts: Sequence = (), lines: Sequence = (),
    unit: float = 1.0,
) -> Camera:  # fmt: skip
    """The camera that hides least of the curves and foreshortens them least.

    Args:
        solids: what may hide them.
        curves: what is to be seen (m).
        posts: thin things that should not stand in front of the curves, as polylines (m).
        lines: straight lines (2, 3) that should not be seen end on (m).
        unit: the scene's own unit of length (m).
    """
    fine = [refine(curve, 3) for curve in curves]
    points = np.concatenate(fine)
    steps = np.concatenate([np.diff(curve, axis=0) for curve in fine])
    standing = np.concatenate([np.empty((0, 3)), *(refine(post, 12) for post in posts)])
    spans = np.array([np.subtract(stop, start) for start, stop in lines]).reshape(-1, 3)

    def merit(camera: Camera) -> float:
        share = _seen(steps, camera).sum() / np.linalg.norm(steps, axis=1).sum()
        some = points[:: len(points) // 60 + 1]
        covered = _covered(some, standing, camera, BESIDE * unit).mean()
        ends_on = 1 - (_seen(spans, camera) / np.linalg.norm(spans, axis=1)).min(initial=1.0)
        return float(share - 2 * hidden(points, solids, camera).mean() - covered - ends_on / 2)

    angles = product(range(-170, 180, 15), (22, 30))
    return max((Camera(np.deg2rad(a), np.deg2rad(e)) for a, e in angles), key=merit)


def _seen(steps: Curve, camera: Camera) -> Float[np.ndarray, " points"]:
    """Lengths in the picture (m)."""
    return np.linalg.norm(camera.project(steps), axis=1)


def _covered(
    points: Curve, standing: Float[np.ndarray, "posts xyz"], camera: Camera, beside: float = BESIDE
) -> Bool[np.ndarray, " points"]:
    """Which points have one of the others close in front of them."""
    apart = camera.project(points)[:, None] - camera.project(standing)
    near = np.linalg.norm(apart, axis=-1) < beside
    return (near & (standing @ camera.towards > (points @ camera.towards)[:, None])).any(axis=1)


def _trajectories(ds: xr.Dataset | None) -> dict[str, Curve]:
    """Best trajectory of every algorithm that has one."""
    if ds is None:
        return {}
    position = ds["position"].transpose("algorithm", "sample", "axis").sel(axis=["x", "y", "z"])
    curves = dict(zip(ds["algorithm"].values.tolist(), position.values, strict=True))
    return {name: curve for name, curve in curves.items() if np.isfinite(curve).all()}


def cable_samples() -> list[Line2D]:
    """Legend entries of the cables."""
    return [
        Line2D([], [], color=QUIET, lw=1, ls=dash, label=f"cables at {place}")
        for place, dash in _CABLES.items()
    ]


def _mark(stages: tuple[Stage, Stage], curves: dict[str, Curve], look: Mapping[str, Style]) -> None:
    """Markers by which curves can be told apart in grey, at other places on each of them."""
    for axes, eye, _ in stages:
        for shift, (name, curve) in enumerate(curves.items()):
            some = curve[4 + 2 * shift :: max(len(curve) // 4, 1)]
            flat = eye.project(some).T
            axes.plot(
                *flat, look[name].marker, ms=5, color=look[name].color, mec="white", mew=0.6,
                zorder=5.5,
            )  # fmt: skip


def _samples(ds: xr.Dataset | None, marked: bool = False) -> list[Line2D]:
    """Legend entries of the algorithms with the fitness of the run that is drawn."""
    if ds is None:
        return []
    entries = []
    run = ds["fitness"].fillna(np.inf).argmin("run")
    best = ds[["fitness", "collisions", "violations"]].isel(run=run)
    for name, style in styles(_trajectories(ds)).items():
        fitness, collisions, violations = (v.item() for v in best.sel(algorithm=name).values())
        doubt = "  (violates limits)" if collisions + violations else ""
        text = f"{style.label}  {significant(fitness)}{doubt}"
        marker = style.marker if marked else ""
        entries.append(
            Line2D([], [], color=style.color, ls=style.dash, lw=2.2, marker=marker, label=text)
        )
    return entries


def _obstacles(axes: Axes, camera: Camera, scenario: Any, solids: list[Solid]) -> None:
    """Obstacles and the load at start and goal, from back to front; obstacles are numbered."""
    unit, task = frame_of(scenario).length, (scenario.task.start, scenario.task.goal)
    loads = [of_load(scenario.payload, place) for place in task]
    bodies = [*solids, *loads]
    for rank, i in enumerate(camera.back_to_front(bodies)):
        color = STONE if i < len(solids) else LOAD
        paint_solid(axes, camera, bodies[i], color, zorder=2 + rank / len(bodies))
    for number, obstacle in enumerate(scenario.obstacles, start=1):
        corners = np.concatenate([solid.corners for solid in solids_of(obstacle)])
        top = corners[corners[:, 2] > corners[:, 2].max() - 1e-6 * unit]
        top = top.mean(axis=0)
        if not hidden(top[None] + [0, 0, 1e-3 * unit], solids, camera).any():
            paint_label(axes, camera, top, str(number), fontsize=7.5, color="#5F6670")
    start, goal = (np.asarray(p, np.float64) for p in (scenario.task.start, scenario.task.goal))
    ahead = camera.frame[0] @ (goal - start)  # name each on the side away from the other
    for name, place, side in (("start", start, -ahead), ("goal", goal, ahead)):
        step, align = (-1, "right") if side < -0.5 * unit else (1, "left")
        beside = place + step * max(0.18 * unit, 1.2 * scenario.payload.radius) * camera.frame[0]
        paint_label(axes, camera, beside, name, ha=align, fontsize=9, fontweight="bold")


def _cables(axes: Axes, camera: Camera, scenario: Any, solids: list[Solid]) -> None:
    """The cables at start and goal, and the ends they hang from; those at the goal filled."""
    hung = attachments_of(scenario)
    ends, unit = _ends(scenario), frame_of(scenario).length
    for (name, dash), held in zip(_CABLES.items(), ends, strict=True):
        lower = np.array(getattr(scenario.task, name), np.float64) + hung
        for line in zip(lower, held, strict=True):
            paint_curve(
                axes, camera, solids, refine(np.array(line), 60), zorder=4.0, color=QUIET,
                linewidth=1.0, linestyle=dash,
            )  # fmt: skip
    for held, face in ((ends[1], INK), (ends[0], "white")):
        flat = camera.project(held)
        axes.plot(*flat.T, "o", ms=5, mfc=face, mec=INK, mew=1.2, zorder=6 + (face == "white"))
    for number, end in enumerate(ends[0], start=1):
        above = end + 0.3 * unit * camera.frame[1]
        paint_label(axes, camera, above, f"P{subscript(number)}", fontsize=9)


def _ends(scenario: Any) -> Float[np.ndarray, "places=2 cables xyz"]:
    """The ends with the load at start and goal, moved by the plain rule of the drive mode."""
    task = np.array([scenario.task.start, scenario.task.goal], np.float64)
    if moving(scenario.drive):
        return ends_beside(scenario, task)
    ends = np.array([robot.end for robot in scenario.robots], np.float64)
    return np.stack([ends, ends])


def _arms(axes: Axes, camera: Camera, scenario: Any) -> None:
    """The robots, elbow up, at their nominal ends."""
    for robot in scenario.robots:
        base, links, end = (jnp.asarray(v, float) for v in (robot.base, robot.links, robot.end))
        joints = arm.inverse(base, links, end).elbow_up
        shoulder = base + jnp.array([0.0, 0.0, robot.links[0]])
        chain = np.stack([base, shoulder, arm.elbow(base, links, joints), end]).astype(np.float64)
        flat = camera.project(chain).T
        axes.plot(*flat, color="#9AA3AF", alpha=0.55, lw=5, solid_joinstyle="round", zorder=1.5)
        axes.plot(*flat[:, :3], "o", color="#7C8694", ms=4, zorder=1.6)


def _finish_view(axes: Axes, scenario: Any, named: bool = True) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.045)
    for text in axes.texts:
        text.set_clip_on(False)
    if not named:
        return
    names = obstacle_names(scenario)
    lines = ["   ".join(names[i : i + 5]) for i in range(0, len(names), 5)]
    axes.text(
        0.5, -0.01, "\n".join(lines), transform=axes.transAxes, ha="center", va="top",
        fontsize=8, color="#5F6670", linespacing=1.5,
    )  # fmt: skip


def obstacle_names(scenario: Any) -> list[str]:
    """The obstacles with their numbers in pictures."""
    return [f"{i} {o.name or o.kind}" for i, o in enumerate(scenario.obstacles, start=1)]


def _finish_top(axes: Axes, scenario: Any) -> None:
    quiet(axes)
    axes.set_aspect("equal")
    frame_plane(axes, (0, 1), scenario.workspace, (scenario.task.start, scenario.task.goal))
