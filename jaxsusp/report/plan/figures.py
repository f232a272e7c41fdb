"""Curves of one plan over time, after the paper's Figs 8 and 10: data in, figure out."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from scipy.spatial.transform import Rotation

from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.scales import anchor
from jaxsusp.report.drawing.style import (
    CABLES,
    INK,
    PALETTE,
    PATH,
    heading,
    legend,
    picture,
    quiet,
    subscript,
)
from jaxsusp.scenario.ownunits import in_words
from jaxsusp.verify.constraints import INSTANTS

AXES = {"x": PALETTE["pso"], "y": PALETTE["ga"], "z": PALETTE["dbo"]}
FLATTENED = 5.0
"""Sizes of the workspace beyond which a coordinate is counted from a round number near to it."""

DASHES = (0, (5, 3))
ACROSS = 4
"""Most panels beside each other where there is one per cable."""


def kinematics(plan: Plan) -> Figure:
    """Position, velocity, acceleration and jerk along x, y and z (Fig. 8)."""
    times = _instants(plan)
    figure = picture(11.0, 6.6)
    panels = figure.subplots(2, 2, sharex=True).ravel()
    labels = (_position_name(plan), "velocity (m/s)", "acceleration (m/s²)", "jerk (m/s³)")
    motion = plan.at(times)
    motion = motion._replace(position=motion.position - _counted_from(plan))
    for axes, values in zip(panels, motion, strict=True):
        _curves(axes, times, values, AXES.values())
    _name(panels, labels)
    for axes in panels[2:]:
        axes.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: motion of the load")
    legend(figure, _samples(AXES))
    return figure


def _counted_from(plan: Plan) -> np.ndarray:
    """What positions in curves are counted from (m): zero, but far away round numbers.

    Far is what would flatten the curves of x, y and z, which share a scale.
    """
    box = plan.scenario.workspace
    far = FLATTENED * max(high - low for low, high in zip(box.lower, box.upper, strict=True))
    return np.array([anchor(*ends, far) for ends in zip(box.lower, box.upper, strict=True)])


def _position_name(plan: Plan) -> str:
    start = _counted_from(plan)
    return f"position from {in_words(start)} (m)" if start.any() else "position (m)"


def cables(plan: Plan, width: float | None = None) -> Figure:
    """Length and tension of every cable with their limits (Fig. 10).

    Args:
        plan: any plan.
        width: of the figure, inches; by default by the number of cables.
    """
    times, limits = _instants(plan), plan.scenario.limits
    loads = plan.loads_at(times)
    rows = {
        "length (m)": (loads.lengths, limits.cable_length),
        "tension (N)": (loads.tensions, limits.tension),
    }
    figure, grid = _per_cable(plan.rigging.cables, "cable", list(rows), width)
    for panels, (values, bounds) in zip(grid, rows.values(), strict=True):
        for k, axes in enumerate(panels):
            _curves(axes, times, values[:, k, None], [CABLES[k % len(CABLES)]])
            _limits(axes, bounds)
    heading(figure, f"{plan.scenario.name}: cables, tensions with inertia")
    legend(figure, _samples({"limits": PATH}, lw=1.2, ls=DASHES))
    return figure


def posture(plan: Plan) -> Figure:
    """The load's posture angles, and how far it is turned from level in all, with the limit."""
    times = _instants(plan)
    loads = plan.loads_at(times)
    hangs = np.where(loads.balanced, 1.0, np.nan)[:, None]
    # R = Rz(α3) Ry(α2) Rx(α1)
    angles = Rotation.from_matrix(loads.posture).as_euler("ZYX", degrees=True)[:, ::-1]
    figure = picture(11.0, 4.0)
    panels = left, right = figure.subplots(1, 2)
    _curves(left, times, hangs * angles, AXES.values())
    _curves(right, times, hangs * np.rad2deg(loads.turn)[:, None], [INK])
    _limits(right, [plan.scenario.limits.posture_deg])
    right.set_ylim(bottom=0)
    _name(panels, ("posture angles (°)", "turn from level (°)"))
    for axes in panels:
        axes.set_xlabel("time (s)", fontsize=10, color=INK)
    heading(figure, f"{plan.scenario.name}: posture of the load")
    names = {f"α{subscript(i)}": color for i, color in enumerate(AXES.values(), start=1)}
    legend(figure, [*_samples(names), *_samples({"limit": PATH}, lw=1.2, ls=DASHES)])
    return figure


def ends(plan: Plan) -> Figure:
    """What moves the ends, per robot.

    Of arms the way of the end, the joint angles and its distance from the shoulder within the
    reach; of bases that roll their way and speed.
    """
    draw = _rolling if plan.rigging.rolls else _reaching
    return draw(plan, _instants(plan))


def _reaching(plan: Plan, times: np.ndarray) -> Figure:
    rigging, colors = plan.rigging, AXES.values()
    held = plan.ends_at(times)
    joints = np.rad2deg(rigging.joints_at(held))
    chains = rigging.chains_at(held)
    distance = np.linalg.norm(chains[:, :, 3] - chains[:, :, 1], axis=-1)
    _, upper, lower = rigging.links.T
    given = plan.scenario.limits.joint_limits_deg
    rows = ["end from its start (m)", "joint angles (°)", "end from shoulder (m)"]
    figure, grid = _per_cable(rigging.cables, "robot", rows)
    for k, (way, turns, reach) in enumerate(zip(*grid, strict=True)):
        _curves(way, times, held[:, k] - held[0, k], colors)
        _curves(turns, times, joints[:, k], colors)
        if given is not None:
            for color, bounds in zip(colors, given[k if len(given) > 1 else 0], strict=True):
                _limits(turns, bounds, color)
        _curves(reach, times, distance[:, k, None], [INK])
        _limits(reach, (abs(upper[k] - lower[k]), upper[k] + lower[k]))
    heading(figure, f"{plan.scenario.name}: ends that the arms move")
    names = {f"{axis}, φ{subscript(i)}": AXES[axis] for i, axis in enumerate(AXES, start=1)}
    legend(figure, [*_samples(names), *_samples({"limits": PATH}, lw=1.2, ls=DASHES)])
    return figure


def _rolling(plan: Plan, times: np.ndarray) -> Figure:
    feet = plan.rigging.bases_at(plan.ends_at(times))
    speed = np.linalg.norm(np.gradient(feet, times, axis=0), axis=-1)
    level = {axis: AXES[axis] for axis in "xy"}
    rows = ["base from its start (m)", "speed of the base (m/s)"]
    figure, grid = _per_cable(plan.rigging.cables, "robot", rows)
    for k, (way, rate) in enumerate(zip(*grid, strict=True)):
        _curves(way, times, (feet[:, k] - feet[0, k])[:, :2], level.values())
        _curves(rate, times, speed[:, k, None], [INK])
    heading(figure, f"{plan.scenario.name}: bases that carry the ends along")
    legend(figure, _samples(level))
    return figure


def _instants(plan: Plan) -> Float[np.ndarray, " times"]:
    return np.linspace(0, plan.law.duration, INSTANTS)


def _per_cable(
    count: int, what: str, rows: Sequence[str], width: float | None = None
) -> tuple[Figure, list[list[Axes]]]:
    """A column of panels per cable or robot, in blocks below each other where there are many.

    Returns:
        The figure, and for every row its panels; those of a row have the same scale.
    """
    blocks = -(-count // ACROSS)
    across = -(-count // blocks)
    high = 2.5 if width is None else 0.26 * width
    width = width or min(3.9 * across, 12.8)
    figure = picture(width, high * blocks * len(rows) + 1.0)
    cells = figure.add_gridspec(blocks * len(rows), across)
    grid: list[list[Axes]] = [[] for _ in rows]
    for k in range(count):
        block, column = divmod(k, across)
        for row, (panels, label) in enumerate(zip(grid, rows, strict=True)):
            first = panels[0] if panels else None
            axes = figure.add_subplot(
                cells[block * len(rows) + row, column], sharex=grid[0][0] if k + row else None,
                sharey=first,
            )  # fmt: skip
            axes.tick_params(labelleft=column == 0, labelbottom=row == len(rows) - 1)
            if column == 0:
                axes.set_ylabel(label, fontsize=10, color=INK)
            panels.append(axes)
    _name(grid[0], [f"{what} {k + 1}" for k in range(count)])
    for axes in grid[-1]:
        axes.set_xlabel("time (s)", fontsize=10, color=INK)
    return figure, grid


def _curves(axes: Axes, times: np.ndarray, values: np.ndarray, colors: Iterable[str]) -> None:
    """One curve per column over the whole time."""
    quiet(axes)
    for column, color in zip(values.T, colors, strict=True):
        axes.plot(times, column, color=color, lw=1.8)
    axes.set_xlim(0, times[-1])


def _limits(axes: Axes, bounds: Iterable[float], color: str = PATH) -> None:
    for bound in bounds:
        axes.axhline(bound, color=color, lw=1.2, ls=DASHES)


def _name(panels: Iterable[Axes], names: Iterable[str]) -> None:
    """Letter and title of every panel."""
    for i, (axes, name) in enumerate(zip(panels, names, strict=True)):
        axes.set_title(f"({'abcdefghijklmnopqrstuvwxyz'[i % 26]}) {name}", loc="left",
                       fontsize=10, color=INK)  # fmt: skip


def _samples(colors: Mapping[str, str], **look) -> list[Line2D]:
    """Legend entries of names with their colours."""
    return [
        Line2D([], [], color=color, label=name, **{"lw": 2, **look})
        for name, color in colors.items()
    ]
