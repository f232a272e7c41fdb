"""What is what in a suspension: the paper's Fig. 1, with its letters."""

from itertools import pairwise
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jaxsusp.mechanics import arm
from jaxsusp.report.drawing.painting import paint_label, paint_solid
from jaxsusp.report.drawing.room import ground_of
from jaxsusp.report.drawing.scene import LOAD
from jaxsusp.report.drawing.solids import Camera, Solid, cylinder
from jaxsusp.report.drawing.style import CABLES, FAINT, INK, PATH, picture, subscript
from jaxsusp.scenario.world import attachments_of

LINK, FLOOR = "#AEB6C0", "#F6F6F4"
VIEW = Camera(np.deg2rad(43), np.deg2rad(18))


def configuration(scenario: Any, size: float = 1.0, width: float = 7.09) -> Figure:
    """The system without its obstacles, all parts with their letters.

    Args:
        scenario: a `Scenario`; its load hangs in the middle, about half-way up to the ends.
        size: how much larger than it is the load is drawn, with its attachments.
        width: of the figure, inches.
    """
    figure = picture(width, 0.72 * width)
    axes = figure.subplots()
    ends = np.array([robot.end for robot in scenario.robots], np.float64)
    bases = np.array([robot.base for robot in scenario.robots], np.float64)
    payload, floor = scenario.payload, ground_of(scenario)
    center = np.append(bases[:, :2].mean(axis=0), floor + 0.45 * (ends[:, 2].mean() - floor))
    lower = center + size * attachments_of(scenario)
    unit = scenario.units.length
    _floor(axes, bases, floor)
    chains = [_chain(robot) for robot in scenario.robots]
    paint_solid(
        axes, VIEW, cylinder(center, size * payload.radius, size * payload.height), LOAD, zorder=5.0
    )
    for k, (chain, end, foot) in enumerate(zip(chains, ends, lower, strict=True)):
        _robot(axes, scenario.robots[k], chain)
        axes.plot(*VIEW.project(np.stack([foot, end])).T, color=CABLES[k % len(CABLES)], lw=1.8,
                  zorder=6)  # fmt: skip
        _point(axes, end, "white")
        _point(axes, foot, INK)
        mark = subscript(k + 1)
        _beside(axes, end, f"P{mark}", (0.0, 0.32 * unit))
        _beside(axes, foot, f"B{mark}", (0.3 * unit * np.sign(_right(end - center)), 0.1 * unit))
        _beside(axes, (foot + end) / 2, f"L{mark}", (0.15 * unit, 0.25 * unit))
        _frame(axes, chain[0], f"O{mark}", 0.8 * unit)
    _arm_letters(axes, chains[0], unit)
    _frame(axes, np.array([0.0, 0.0, floor]), "O_E", 1.1 * unit)
    _frame(axes, center, "O_B", 1.5 * unit, zorder=7.0)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.03)
    for text in axes.texts:
        text.set_clip_on(False)
    return figure


def _chain(robot: Any) -> Float[np.ndarray, "points=4 xyz"]:
    """Foot, shoulder, elbow and end."""
    base, links, end = (jnp.asarray(v, float) for v in (robot.base, robot.links, robot.end))
    joints = arm.inverse(base, links, end).elbow_up
    shoulder = base + jnp.array([0.0, 0.0, robot.links[0]])
    return np.stack([base, shoulder, arm.elbow(base, links, joints), end]).astype(np.float64)


def _floor(axes: Axes, bases: np.ndarray, floor: float) -> None:
    """A disc that the robots stand on, with rings."""
    middle = bases[:, :2].mean(axis=0)
    angle = np.linspace(0, 2 * np.pi, 97)
    far = 1.25 * np.linalg.norm(bases[:, :2] - middle, axis=1).max()
    for share in (1.0, 0.75, 0.5, 0.25):
        ring = middle + share * far * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        flat = VIEW.project(np.column_stack([ring, np.full(len(ring), floor)])).T
        if share == 1.0:
            axes.fill(*flat, fc=FLOOR, ec=FAINT, lw=0.8, zorder=0.5)
        else:
            axes.plot(*flat, color=FAINT, lw=0.8, zorder=0.6)


def _robot(axes: Axes, robot: Any, chain: np.ndarray) -> None:
    """A column on a foot, and two links with their joints."""
    foot = cylinder(chain[0] + [0, 0, 0.1], 3 * robot.column_radius, 0.2)
    paint_solid(axes, VIEW, foot, LINK, zorder=2.0)
    for number, (start, stop) in enumerate(pairwise(chain)):
        thick = robot.column_radius if number == 0 else robot.link_radius
        paint_solid(axes, VIEW, _rod(start, stop, thick), LINK, zorder=2.2 + number / 10)
    flat = VIEW.project(chain[1:3]).T
    axes.plot(*flat, "o", ms=7, mfc="white", mec=INK, mew=1.0, zorder=3)


def _rod(start: np.ndarray, stop: np.ndarray, radius: float) -> Solid:
    along = stop - start
    length = float(np.linalg.norm(along))
    z = along / length
    x = np.linalg.svd(z[None])[2][1]
    turn = np.column_stack([x, np.cross(z, x), z])
    return cylinder((start + stop) / 2, radius, length, turn, sides=24)


def _arm_letters(axes: Axes, chain: np.ndarray, unit: float) -> None:
    """Lengths of the links and joint angles of the first robot."""
    middles = (chain[:-1] + chain[1:]) / 2
    for number, (middle, along) in enumerate(zip(middles, np.diff(chain, axis=0), strict=True)):
        flat = VIEW.project(along)
        aside = np.array([-flat[1], flat[0]]) / np.linalg.norm(flat) * 0.35 * unit
        _beside(axes, middle, rf"$a_{{1{number + 1}}}$", tuple(aside))
    for number, point in enumerate((chain[0] + [0, 0, 0.3 * unit], *chain[1:3])):
        _beside(axes, point, rf"$\varphi_{{1{number + 1}}}$", (-0.45 * unit, -0.05 * unit))


def _frame(axes: Axes, origin: np.ndarray, name: str, size: float, zorder: float = 4.0) -> None:
    """Three arrows along x, y and z."""
    at = tuple(VIEW.project(origin))
    look = {"arrowstyle": "-|>", "color": PATH, "lw": 1.0, "shrinkA": 0, "shrinkB": 0}
    for axis, way in zip("xyz", size * np.eye(3), strict=True):
        to = tuple(VIEW.project(origin + way))
        arrow = {**look, "mutation_scale": 6}
        axes.annotate("", to, at, arrowprops=arrow, zorder=zorder)
        _beside(axes, origin + 1.22 * way, axis, (0.0, 0.0), fontsize=7, color=PATH)
    text = rf"${name}$" if "_" in name else name
    _beside(axes, origin, text, (-0.3 * size, -0.3 * size), fontweight="bold")


def _point(axes: Axes, place: np.ndarray, face: str) -> None:
    axes.plot(*VIEW.project(place), "o", ms=5, mfc=face, mec=INK, mew=1.0, zorder=6.5)


def _beside(axes: Axes, point: np.ndarray, text: str, shift: tuple[float, float], **look) -> None:
    """Text next to a point, shifted to the right and up in the picture (m)."""
    place = point + np.array(shift) @ VIEW.frame
    paint_label(axes, VIEW, place, text, **{"fontsize": 9, **look})


def _right(way: np.ndarray) -> float:
    return float(VIEW.frame[0] @ way)
