"""One plan seen in its room: the load's way with its poses, cables, ends and arms (Fig. 9)."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, MultipleLocator

from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.painting import (
    freest,
    hidden,
    paint_curve,
    paint_label,
    paint_solid,
    refine,
)
from jaxsusp.report.drawing.room import ground_of, paint_room
from jaxsusp.report.drawing.scales import count_from
from jaxsusp.report.drawing.scene import LOAD, STONE, best_view
from jaxsusp.report.drawing.solids import Camera, Solid, of_load, of_obstacles
from jaxsusp.report.drawing.style import (
    CABLES,
    INK,
    PATH,
    QUIET,
    heading,
    legend,
    picture,
    quiet,
    subscript,
)
from jaxsusp.scenario.world import attachments_of
from jaxsusp.verify.constraints import INSTANTS

POSES = 9
ARM, PAST_ARM = "#AEB6C0", "#DADEE3"
"""Of arms that stand still or at the goal, and at the start of those that move."""


class Stills(NamedTuple):
    """The whole system at a few instants of a plan (m)."""

    center: Float[np.ndarray, "poses xyz"]
    posture: Float[np.ndarray, "poses xyz 3"]
    lower: Float[np.ndarray, "poses cables xyz"]  # where the cables are attached to the load
    ends: Float[np.ndarray, "poses cables xyz"]
    chains: Float[np.ndarray, "poses cables points=4 xyz"]  # foot, shoulder, elbow, end

    @classmethod
    def of(cls, plan: Plan) -> "Stills":
        """At equal distances along the path, where equal times would crowd at both ends."""
        path, rigging = plan.law.path, plan.rigging
        u = path.parameter(np.linspace(0, path.length, POSES))
        center, ends = path.curve(u), rigging.ends_at(u)
        posture = _postures(plan, u)
        hung = attachments_of(plan.scenario) @ np.swapaxes(posture, -1, -2)
        return cls(center, posture, center[:, None] + hung, ends, rigging.chains_at(ends))


def _finish_top(axes: Axes) -> None:
    """True to scale, with the same grid in both directions."""
    quiet(axes)
    axes.set_aspect("equal")
    limits = axes.get_xlim(), axes.get_ylim()
    step = np.diff(
        MaxNLocator(10, steps=[1, 2, 5, 10]).tick_values(0, np.ptp(limits, axis=1).max())
    )
    for axis, (scale, ends) in enumerate(zip((axes.xaxis, axes.yaxis), limits, strict=True)):
        scale.set_major_locator(MultipleLocator(step[0]))
        count_from(scale, axis, *ends)


def plan_view(plan: Plan, stills: Stills | None = None) -> Camera:
    """From where the load's way is seen best, with no arm before it and no cable end on."""
    stills = Stills.of(plan) if stills is None else stills
    solids = of_obstacles(plan.scenario.obstacles)
    curve = plan.at(np.linspace(0, plan.law.duration, 200)).position
    held = [*zip(stills.lower[0], stills.ends[0], strict=True)]
    held += [*zip(stills.lower[-1], stills.ends[-1], strict=True)]
    posts = [*stills.chains[0], *stills.chains[-1]]
    return best_view(solids, [curve], posts, held, plan.scenario.units.length)


def _postures(plan: Plan, u: np.ndarray) -> np.ndarray:
    """R of the load at parameters of the path."""
    if plan.scenario.payload.attachments == "hook":
        return np.tile(np.eye(3), (len(u), 1, 1))
    # As many instants as the constraint report has, whose compiled program serves here as well.
    times = np.pad(plan.law.time_of(u), (0, INSTANTS - len(u)), mode="edge")
    return plan.loads_at(times).posture[: len(u)]


def scene(plan: Plan, width: float = 13.0) -> Figure:
    """The load's way with its poses, and the cables in every pose (Fig. 9).

    Where ends move, their ways are drawn as well, and the arms at the start (pale) and the goal.

    Args:
        plan: any plan.
        width: of the figure, inches.
    """
    scenario = plan.scenario
    stills = Stills.of(plan)
    camera = plan_view(plan, stills)
    figure = picture(width, 7.4 / 13.0 * width + 0.3 * (width < 13.0))
    view, top = figure.subplots(1, 2, width_ratios=[1.15, 1])
    paint_room(
        view, camera, scenario.workspace.lower, scenario.workspace.upper, ground_of(scenario)
    )
    for axes, eye in ((view, camera), (top, Camera.above())):
        _system(axes, eye, plan, stills)
    _finish_view(view)
    _finish_top(top)
    heading(figure, f"{scenario.name}: the plan" + ("" if plan.feasible else " (infeasible)"))
    legend(figure, _samples(plan))
    return figure


def glance(plan: Plan) -> Figure:
    """The view of `scene` alone, small."""
    stills, scenario = Stills.of(plan), plan.scenario
    camera, figure = plan_view(plan, stills), picture(8.0, 6.5)
    view = figure.add_subplot()
    paint_room(
        view, camera, scenario.workspace.lower, scenario.workspace.upper, ground_of(scenario)
    )
    _system(view, camera, plan, stills)
    _finish_view(view)
    legend(figure, _samples(plan))
    return figure


def _system(axes: Axes, eye: Camera, plan: Plan, stills: Stills) -> None:
    """All of a plan but the room it is in."""
    solids = of_obstacles(plan.scenario.obstacles)
    times = np.linspace(0, plan.law.duration, 200)
    _bodies(axes, eye, plan, solids, stills)
    _arms(axes, eye, plan, solids, stills)
    _cables(axes, eye, solids, stills)
    _ends(axes, eye, plan, solids, times)
    _name_ends(axes, eye, plan, stills)
    curve = plan.at(times).position
    paint_curve(axes, eye, solids, curve, zorder=5.0, color=PATH, linewidth=2.2)


def _finish_view(axes: Axes) -> None:
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.margins(0.04)
    for text in axes.texts:
        text.set_clip_on(False)


def _bodies(axes: Axes, camera: Camera, plan: Plan, solids: list[Solid], stills: Stills) -> None:
    """Obstacles and the load's poses, from back to front."""
    payload, unit = plan.scenario.payload, plan.scenario.units.length
    loads = [
        of_load(payload, center, turn)
        for center, turn in zip(stills.center, stills.posture, strict=True)
    ]
    bodies = [*solids, *loads]
    for rank, i in enumerate(camera.back_to_front(bodies)):
        color = STONE if i < len(solids) else LOAD
        paint_solid(axes, camera, bodies[i], color, zorder=2 + rank / len(bodies))
    way = camera.project(plan.at(np.linspace(0, plan.law.duration, 200)).position)
    for name, place in (("start", stills.center[0]), ("goal", stills.center[-1])):
        away = max(0.2 * unit, 1.2 * payload.radius)
        sides = (("left", away), ("right", -away))
        middles = camera.project(place) + np.array([[3 * step, 0.0] for _, step in sides])
        align, step = sides[freest(middles, way, enough=0.4 * unit)]
        beside = place + step * camera.frame[0]
        paint_label(axes, camera, beside, name, ha=align, fontsize=9, fontweight="bold")


def _arms(axes: Axes, camera: Camera, plan: Plan, solids: list[Solid], stills: Stills) -> None:
    """Robots where they stand, or at start and goal; before or behind the obstacles."""
    looks = ((0, PAST_ARM), (-1, ARM)) if plan.rigging.moves else ((0, ARM),)
    for layer, (pose, color) in enumerate(looks):
        for chain in stills.chains[pose]:
            fine = refine(chain, 20)
            behind = hidden((fine[:-1] + fine[1:]) / 2, solids, camera)
            flat = camera.project(fine)
            for part in np.split(np.arange(len(behind)), np.flatnonzero(np.diff(behind)) + 1):
                axes.plot(
                    *flat[part[0] : part[-1] + 2].T, color=color, lw=4, solid_joinstyle="round",
                    solid_capstyle="round", zorder=(1.5 if behind[part[0]] else 3.5) + layer / 100,
                )  # fmt: skip


def _cables(axes: Axes, camera: Camera, solids: list[Solid], stills: Stills) -> None:
    """The cables in every pose, thinner the more there are."""
    count = stills.ends.shape[1]
    for lower, ends in zip(stills.lower, stills.ends, strict=True):
        for k in range(count):
            line = np.linspace(lower[k], ends[k], 30)
            look = {"color": CABLES[k % len(CABLES)], "linewidth": 0.9 if count < 4 else 0.7}
            paint_curve(axes, camera, solids, line, zorder=4.0, **look)


def _ends(axes: Axes, camera: Camera, plan: Plan, solids: list[Solid], times: np.ndarray) -> None:
    """Where the ends are, or from where (hollow) to where (filled) they go; bases that roll."""
    ends = plan.ends_at(times)
    feet = plan.rigging.bases_at(ends)
    for k in range(plan.rigging.cables):
        way, color = ends[:, k], CABLES[k % len(CABLES)]
        dot = {"ms": 5, "mec": INK, "mew": 1.2, "zorder": 6.1}
        if plan.rigging.moves:
            paint_curve(axes, camera, solids, way, zorder=6.0, color=color, linewidth=1.6)
            axes.plot(*camera.project(way[-1]), "o", mfc=INK, **dot)
        axes.plot(*camera.project(way[0]), "o", mfc="white", **dot)
        if plan.rigging.rolls:
            paint_curve(axes, camera, solids, feet[:, k], zorder=3.6, color=INK, linewidth=1.2)
            for place, face in ((feet[0, k], "white"), (feet[-1, k], INK)):
                axes.plot(*camera.project(place), "s", mfc=face, **{**dot, "zorder": 3.7})


def _name_ends(axes: Axes, camera: Camera, plan: Plan, stills: Stills) -> None:
    """P₁, P₂, … beside the ends at the start, where there is room."""
    lines = [refine(chain, 20) for chain in stills.chains[[0, -1]].reshape(-1, 4, 3)]
    lines += [*np.moveaxis(stills.ends, 1, 0)]
    for lower, ends in zip(stills.lower, stills.ends, strict=True):
        lines += [np.linspace(*span, 60) for span in zip(lower, ends, strict=True)]
    drawn = camera.project(np.concatenate(lines))
    angle = np.deg2rad([90, 135, 45, 180, 0, 225, 315, 270])
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    unit = plan.scenario.units.length
    around = unit * np.concatenate([0.4 * ring, 0.6 * ring])
    for k, end in enumerate(stills.ends[0]):
        best = around[freest(camera.project(end) + around, drawn, enough=0.3 * unit)]
        place = end + best @ camera.frame
        paint_label(axes, camera, place, f"P{subscript(k + 1)}", fontsize=9, color=QUIET)


def _samples(plan: Plan) -> list[Line2D]:
    """Legend entries of all that is drawn."""
    rigging = plan.rigging
    entries = [Line2D([], [], color=PATH, lw=2.2, label="load")]
    entries += [
        Line2D([], [], color=CABLES[k % len(CABLES)], lw=1.2, label=f"cable {k + 1}")
        for k in range(rigging.cables)
    ]
    if not rigging.moves:
        return [*entries, Line2D([], [], color=ARM, lw=4, label="arm")]
    dot = {"ls": "", "marker": "s" if rigging.rolls else "o", "mec": INK, "ms": 5}
    what = "end, base" if rigging.rolls else "end"
    return [
        *entries,
        Line2D([], [], color=PAST_ARM, lw=4, label="arm at start"),
        Line2D([], [], color=ARM, lw=4, label="arm at goal"),
        Line2D([], [], mfc="white", label=f"{what} at start", **dot),
        Line2D([], [], mfc=INK, label=f"{what} at goal", **dot),
    ]
