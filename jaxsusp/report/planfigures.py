"""Figures of one plan, after the paper's Figs 8 to 10: data in, figure out."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from jaxsusp.plans import Plan
from jaxsusp.report.look import INK, PALETTE, QUIET, heading, legend, picture, quiet
from jaxsusp.report.painting import paint_curve, paint_label, paint_solid
from jaxsusp.report.room import paint_room
from jaxsusp.report.scene3d import best_view
from jaxsusp.report.solids import Camera, Solid, cylinder, of_obstacle

AXES = {"x": PALETTE["pso"], "y": PALETTE["ga"], "z": PALETTE["dbo"]}
CABLES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#8B5A2B")
STONE, LOAD, PATH = "#C9CDD3", "#5A5F69", "#C43C00"
INSTANTS = 401
POSES = 9


def kinematics(plan: Plan) -> Figure:
    """Position, velocity, acceleration and jerk along x, y and z (Fig. 8)."""
    times = np.linspace(0, plan.law.duration, INSTANTS)
    figure = picture(11.0, 6.6)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    labels = ("position (m)", "velocity (m/s)", "acceleration (m/s²)", "jerk (m/s³)")
    for letter, axes, values, label in zip("abcd", panels, plan.at(times), labels, strict=True):
        quiet(axes)
        for i, color in enumerate(AXES.values()):
            axes.plot(times, values[:, i], color=color, lw=1.8)
        axes.set_title(f"({letter}) {label}", loc="left", fontsize=10, color=INK)
        axes.set_xlim(0, times[-1])
    for axes in panels[2:]:
        axes.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: motion of the load")
    legend(figure, [Line2D([], [], color=c, lw=2, label=name) for name, c in AXES.items()])
    return figure


def cables(plan: Plan) -> Figure:
    """Length and tension of every cable with their limits (Fig. 10)."""
    times = np.linspace(0, plan.law.duration, INSTANTS)
    loads = plan.loads_at(times)
    lengths, tensions = loads.lengths, loads.tensions
    limits, count = plan.scenario.limits, plan.rigging.cables
    figure = picture(3.9 * count, 6.0)
    grid = figure.subplots(2, count, sharex=True, sharey="row", squeeze=False)
    rows = (
        (lengths, limits.cable_length, "length (m)"),
        (tensions, limits.tension, "tension (N)"),
    )
    for axes_row, (values, bounds, label) in zip(grid, rows, strict=True):
        for k, axes in enumerate(axes_row):
            quiet(axes)
            axes.plot(times, values[:, k], color=CABLES[k % len(CABLES)], lw=2)
            for bound in bounds:
                axes.axhline(bound, color=PATH, lw=1.2, ls=(0, (5, 3)))
            axes.set_xlim(0, times[-1])
        axes_row[0].set_ylabel(label, fontsize=10, color=INK)
    for k, axes in enumerate(grid[0]):
        letter = "abcdefgh"[k % 8]
        axes.set_title(f"({letter}) cable {k + 1}", loc="left", fontsize=10, color=INK)
    for axes in grid[-1]:
        axes.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: cables, tensions with inertia")
    legend(figure, [Line2D([], [], color=PATH, lw=1.2, ls=(0, (5, 3)), label="limits")])
    return figure


def scene(plan: Plan) -> Figure:
    """The load's way with its poses, and the cables in every pose (Fig. 9)."""
    scenario = plan.scenario
    solids = [of_obstacle(obstacle) for obstacle in scenario.obstacles]
    curve = plan.at(np.linspace(0, plan.law.duration, 200)).position
    # Poses at equal distances along the path, where equal times would crowd at both ends.
    u = plan.law.path.parameter(np.linspace(0, plan.law.path.length, POSES))
    poses = plan.law.path.curve(u)
    camera = best_view(solids, [curve])
    figure = picture(13.0, 7.4)
    view, top = figure.subplots(1, 2, width_ratios=[1.15, 1])
    paint_room(view, camera, scenario.workspace.lower, scenario.workspace.upper)
    for axes, eye in ((view, camera), (top, Camera.above())):
        _bodies(axes, eye, plan, solids, poses)
        _hung(axes, eye, plan, solids, poses)
        paint_curve(axes, eye, solids, curve, zorder=5.0, color=PATH, linewidth=2.2)
    view.set_axis_off()
    view.set_aspect("equal")
    view.margins(0.04)
    quiet(top)
    top.set_aspect("equal")
    for text in view.texts:
        text.set_clip_on(False)
    top.set_xlabel("x (m)", fontsize=10, color=INK)
    top.set_ylabel("y (m)", fontsize=10, color=INK)
    heading(figure, f"{scenario.name}: the plan" + ("" if plan.feasible else " (infeasible)"))
    entries = [Line2D([], [], color=PATH, lw=2.2, label="load")]
    entries += [
        Line2D([], [], color=CABLES[k % len(CABLES)], lw=1.2, label=f"cable {k + 1}")
        for k in range(len(plan.ends))
    ]
    legend(figure, [*entries, Line2D([], [], color="#9AA3AF", lw=4, label="arm")])
    return figure


def _bodies(axes: Axes, camera: Camera, plan: Plan, solids: list[Solid], poses) -> None:
    """Obstacles and the load's poses, from back to front."""
    payload = plan.scenario.payload
    loads = [cylinder(pose, payload.radius, payload.height) for pose in poses]
    bodies = [*solids, *loads]
    for rank, i in enumerate(camera.back_to_front(bodies)):
        color, alpha = (STONE, 0.92) if i < len(solids) else (LOAD, 1.0)
        paint_solid(axes, camera, bodies[i], color, alpha, zorder=2 + rank / len(bodies))
    for name, place in (("start", plan.position[0]), ("goal", plan.position[-1])):
        beside = place + 0.2 * camera.frame[0]
        paint_label(axes, camera, beside, name, ha="left", fontsize=9, fontweight="bold")


def _hung(axes: Axes, camera: Camera, plan: Plan, solids: list[Solid], poses) -> None:
    """Cables in every pose, ends, and the arms that hold them."""
    from jaxsusp.plans import hold

    hook = np.array([0.0, 0.0, plan.scenario.payload.height / 2])
    up = plan.joints[0, :, 2] >= 0
    chains = np.asarray(hold(plan.scenario, plan.law, plan.ends, len(plan.times), up).chains)
    for k, end in enumerate(plan.ends):
        color = CABLES[k % len(CABLES)]
        for pose in poses:
            line = np.linspace(pose + hook, end, 30)
            paint_curve(axes, camera, solids, line, zorder=4.0, color=color, linewidth=0.9)
        flat = camera.project(chains[k]).T
        axes.plot(*flat, color="#9AA3AF", alpha=0.6, lw=4, solid_joinstyle="round", zorder=1.5)
        axes.plot(*camera.project(end), "o", ms=5, mfc="white", mec=INK, mew=1.2, zorder=6)
        above = end + 0.35 * camera.frame[1]
        paint_label(axes, camera, above, f"P{'₀₁₂₃₄₅₆₇₈₉'[(k + 1) % 10]}", fontsize=9, color=QUIET)
