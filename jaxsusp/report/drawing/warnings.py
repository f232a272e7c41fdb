"""The environment of a suspension with its warning areas: the paper's Fig. 4."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.spatial import ConvexHull

from jaxsusp.report.drawing.painting import paint_solid
from jaxsusp.report.drawing.scene import STONE, WIDTH, cable_samples, stage
from jaxsusp.report.drawing.solids import (
    Camera,
    Solid,
    box,
    cylinder,
    of_load,
    of_obstacle,
    of_polytope,
    sphere,
)
from jaxsusp.report.drawing.style import INK, heading, legend

WARNING, LOAD = "#E8A200", "#B00020"
LOAD_KEEPS_OUT = "where the load's centre must not be at the obstacle's height (dotted)"


def environment(scenario: Any, width: float = WIDTH) -> Figure:
    """Obstacles in their warning areas, and the load in red at start and goal.

    Args:
        scenario: a `Scenario`.
        width: of the figure, inches.

    Returns:
        A figure with a view and the top view; in the latter dotted what the load's centre keeps out
        of.
    """
    figure, stages = stage(scenario, [], width)
    heading(figure, f"{scenario.name}: obstacles and warning areas")
    clear, payload = scenario.limits.clearance, scenario.payload
    task = (scenario.task.start, scenario.task.goal)
    for axes, eye, _ in stages:
        for place in task:
            paint_solid(axes, eye, of_load(payload, place), LOAD, zorder=4.5)
        for obstacle in scenario.obstacles:
            for solid in grown(obstacle, clear):
                paint_solid(axes, eye, solid, WARNING, alpha=0.3, zorder=3.4, rim=0.9)
    top, eye, _ = stages[1]
    for obstacle in scenario.obstacles:
        for solid in grown(obstacle, clear + payload.radius):
            outline = _outline(solid, eye)
            top.plot(*outline.T, color=INK, lw=0.9, ls=":", zorder=3.6)
    legend(
        figure,
        [
            Patch(fc=STONE, ec=INK, lw=0.7, label="obstacle"),
            Patch(fc=WARNING, ec=INK, lw=0.7, alpha=0.5, label="warning area"),
            Patch(fc=LOAD, label="load"),
            Line2D([], [], color=INK, lw=0.9, ls=":", label="for the load's centre"),
            *cable_samples(),
        ],
    )
    return figure


def grown(obstacle: Any, by: float) -> list[Solid]:
    """An obstacle of a scenario, larger on every side (m); a mesh as what stands for it."""
    match obstacle.kind:
        case "mesh" if obstacle.shape != "box":
            placed = (body.placed(obstacle.center, obstacle.yaw_deg) for body in obstacle.bodies)
            return [of_polytope(body.larger(by)) for body in placed]
        case "box" | "mesh":
            return [box(obstacle.center, np.add(obstacle.size, 2 * by), obstacle.yaw_deg)]
        case "cylinder":
            return [cylinder(obstacle.center, obstacle.radius + by, obstacle.height + 2 * by)]
        case "sphere":
            return [sphere(obstacle.center, obstacle.radius + by)]
    return [of_obstacle(obstacle)]  # says what it is


def _outline(solid: Solid, eye: Camera) -> np.ndarray:
    """The contour of a body in the picture, closed."""
    flat = eye.project(solid.corners)
    around = ConvexHull(flat).vertices
    return flat[np.append(around, around[0])]
