"""Free space in the plane, in the colours of the paper's Fig. 5."""

from typing import Any

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.report.drawing.scales import frame_plane
from jaxsusp.report.drawing.solids import of_obstacles
from jaxsusp.report.drawing.style import INK, legend, picture, quiet
from jaxsusp.report.freespace import ellipse_of, section
from jaxsusp.scenario.scenario import Scenario

BLACK, GROWN = "#1A1A1A", "#BDBDBD"
LINE, ELLIPSE, WAY = "#C98F00", "#0072B2", "#C2307F"
TASK, TARGET = "#C4161C", "#00703C"


def plane(
    scenario: Scenario,
    space: FreeSpace,
    way: Float[np.ndarray, "samples xyz"],
    height: float,
    width: float = 5.4,
) -> Figure:
    """A level section of a free space, with a trajectory.

    Args:
        scenario: the task.
        space: its regions; those on the route are drawn strongly.
        way: the trajectory (m), from above.
        height: of the section (m).
        width: of the figure, inches.
    """
    figure = picture(width, 1.16 * width)
    axes = figure.subplots()
    quiet(axes)
    axes.grid(False)
    room = scenario.workspace.lower[:2], scenario.workspace.upper[:2]

    def fill(halves: HalfSpaces, **look) -> None:
        polygon = section(halves, height, *room)
        if len(polygon):
            axes.fill(*polygon.T, **look)

    for body in space.bodies:
        fill(body, fc=GROWN, ec="none", zorder=1)
    for solid in of_obstacles(scenario.obstacles):
        fill(HalfSpaces(solid.normals, solid.offsets), fc=BLACK, ec="none", zorder=2)
    for number, region in enumerate(space.regions):
        strong = number in space.route
        if strong:
            fill(region.polytope, fc=LINE, alpha=0.13, ec="none", zorder=2.5)
        look = {"lw": 1.6, "zorder": 4} if strong else {"lw": 0.6, "zorder": 3}
        fill(region.polytope, fc="none", ec=LINE, **look)
        ellipse = ellipse_of(region.ellipsoid, height)
        if ellipse is not None:
            ellipse.set(fill=False, edgecolor=ELLIPSE, linestyle="-" if strong else ":", **look)
            axes.add_patch(ellipse)
    axes.plot(*way[:, :2].T, color=WAY, lw=2.4, zorder=6)
    targets = space.polyline[1:-1]
    axes.plot(*targets[:, :2].T, "s", ms=6, color=TARGET, mec="white", zorder=7)
    task = np.array([scenario.task.start, scenario.task.goal])
    axes.plot(*task[:, :2].T, "o", ms=7, color=TASK, mec="white", zorder=7)
    for name, place in zip(("start", "goal"), task, strict=True):
        axes.annotate(name, place[:2], xytext=(7, 4), textcoords="offset points", fontsize=8,
                      color=INK, zorder=8)  # fmt: skip
    axes.set_aspect("equal")
    frame_plane(axes, (0, 1), scenario.workspace, task, fontsize=9)
    dot: dict[str, Any] = {"ls": "", "mec": "white"}
    legend(
        figure,
        [
            Patch(fc=BLACK, label="obstacle"),
            Patch(fc=GROWN, label="margin"),
            Line2D([], [], color=LINE, lw=1.6, label="polygon"),
            Line2D([], [], color=ELLIPSE, lw=1.6, label="ellipse"),
            Line2D([], [], color=WAY, lw=2.4, label="trajectory"),
            Line2D([], [], marker="o", color=TASK, ms=7, label="start, goal", **dot),
            Line2D([], [], marker="s", color=TARGET, ms=6, label="target", **dot),
        ],
    )
    return figure
