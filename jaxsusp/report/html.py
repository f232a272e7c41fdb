"""What objects show of themselves in a notebook: a small table and one picture."""

import base64
import html
import io
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jaxsusp.comparison.overview import Overview
from jaxsusp.freespace.polyhedra import corners_of
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.prospects.examination import Examination
from jaxsusp.report import examination
from jaxsusp.report.comparison import figures, gaps, targets
from jaxsusp.report.comparison.folder import MOST_DRAWN
from jaxsusp.report.drawing.scales import decimals, frame_plane
from jaxsusp.report.drawing.scene import paint_task
from jaxsusp.report.drawing.style import panels, picture
from jaxsusp.report.freespace import FREE as FREE
from jaxsusp.report.freespace import ROUTE, SHADOW, section
from jaxsusp.report.plan import scene as planscene
from jaxsusp.report.render import percent, significant, to_html
from jaxsusp.scenario.ownunits import frame_of, in_words
from jaxsusp.scenario.scenario import Scenario

WIDTH = 640
"""Pixels of a picture."""

Rows = Iterable[tuple[str, str]]


def shown(thing: Any) -> str | None:
    """HTML of a thing of ours, or nothing where there is none."""
    for kind, show in _SHOW.items():
        if isinstance(thing, kind):
            return f"<div>{show(thing)}</div>"
    return None


def _table(title: str, rows: Rows) -> str:
    """Two columns under a title; all texts are escaped."""
    left = 'style="text-align:left"'
    lines = "".join(
        f"<tr><td {left}>{html.escape(name)}</td><td {left}>{html.escape(text)}</td></tr>"
        for name, text in rows
    )
    return f"<table><caption {left}><b>{html.escape(title)}</b></caption>{lines}</table>"


def _image(figure: Figure, alt: str) -> str:
    """A figure as a PNG inside of the page."""
    buffer, dpi = io.BytesIO(), WIDTH / figure.get_figwidth()
    figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    data = base64.b64encode(buffer.getvalue()).decode()
    return f'<img alt="{html.escape(alt)}" width="{WIDTH}" src="data:image/png;base64,{data}">'


def _scenario(scenario: Scenario) -> str:
    payload, frame = scenario.payload, frame_of(scenario)
    hung = "one hook" if payload.attachments == "hook" else "one point per cable"
    rows = [
        ("robots", f"{len(scenario.robots)}, drive mode {scenario.drive}"),
        ("load", f"{payload.mass:g} kg, {payload.words}, at {hung}"),
        ("obstacles", str(len(scenario.obstacles))),
        ("from", f"{in_words(scenario.task.start)} m"),
        ("to", f"{in_words(scenario.task.goal)} m, in {scenario.task.duration:g} s"),
        ("own units", f"{frame.length:.4g} m, {frame.mass:.4g} kg"),
        *[("start or goal", line) for line in scenario.troubles],
    ]
    figure = picture(8.0, 6.5)
    paint_task(figure.add_subplot(), scenario)
    return _table(scenario.name, rows) + _image(figure, f"scenario {scenario.name}")


def _free_space(space: FreeSpace) -> str:
    rows = [
        ("regions", f"{len(space.d)}, among {len(space.bodies)} convex bodies"),
        ("free space covered", percent(space.coverage)),
        ("shortest way", f"{significant(space.length)} m" if space.connected else space.reason),
        ("distinct ways", str(len(space.routes))),
    ]
    return _table("free space", rows) + _image(_sections(space), "level sections of a free space")


def _sections(space: FreeSpace) -> Figure:
    """The regions and what they avoid, cut at three heights of the way or of all regions."""
    corners = [corners_of(region.polytope, region.ellipsoid.d) for region in space.regions]
    around = np.concatenate([*corners, space.polyline]) if corners else np.eye(3)
    low, high = around.min(axis=0), around.max(axis=0)
    way = space.polyline[:, 2] if space.connected else np.array([low[2], high[2]])
    heights = np.quantile(way, [0.0, 0.5, 1.0])
    figure = picture(10.0, 4.2)
    for axes, height in zip(panels(figure, 3, sharey=True), heights, strict=True):
        _cut(axes, space, float(height), low, high)
    return figure


def _cut(axes: Axes, space: FreeSpace, height: float, low: np.ndarray, high: np.ndarray) -> None:
    avoided = [(body, {"facecolor": SHADOW, "alpha": 0.55, "lw": 0}) for body in space.bodies]
    kept = [(each.polytope, {"facecolor": "none", "ec": FREE, "lw": 1}) for each in space.regions]
    for body, look in (*avoided, *kept):
        polygon = section(body, height, low[:2], high[:2])
        if len(polygon):
            axes.fill(*polygon.T, **look)
    axes.plot(*space.polyline[:, :2].T, color=ROUTE, lw=1.6)
    digits = decimals(space.frame.length)
    axes.set_title(f"z = {height:.{digits}f} m", loc="left", fontsize=10, fontweight="bold")
    axes.set_aspect("equal")
    axes.grid(False)
    box = type("Box", (), {"lower": low, "upper": high})
    frame_plane(axes, (0, 1), box, fontsize=9)


def _plan(plan: Plan) -> str:
    said = plan.settings
    rows = [
        ("verdict", "feasible" if plan.feasible else "infeasible"),
        *[("because", reason) for reason in plan.reasons],
        ("path", f"{plan.law.path.length:.4g} m in {plan.law.duration:.4g} s"),
        *[("fitness", f"{said[key]:.2f}") for key in ("fitness",) if key in said],
        ("clear at every instant", "proved" if plan.certificate.proved else "not proved"),
        ("least distance to obstacles", f"{significant(plan.clearance, 3)} m"),
        ("tensions", f"{significant(plan.tensions.min(), 3)} to "
         f"{significant(plan.tensions.max(), 3)} N"),
        ("limits", f"{sum(each.ok for each in plan.report)} of {len(plan.report)} kept"),
        ("followed by a swinging load", "yes" if said.get("simulated") else "not played"),
    ]  # fmt: skip
    name = plan.scenario.name
    return _table(f"plan of {name}", rows) + _image(planscene.glance(plan), f"plan of {name}")


def _comparison(overview: Overview) -> str:
    ds = overview.ds
    few = ds.sizes["scenario"] <= MOST_DRAWN
    figure = figures.convergence(ds) if few else targets.running_times(ds)
    frame = gaps.gap_summary(ds)
    table = to_html(frame) if len(frame) else ""
    return table + ("" if figure is None else _image(figure, "convergence of a comparison"))


def _examination(found: Examination) -> str:
    said = [*examination.about(found.scenario), *examination.prospects(found)]
    paragraphs = "".join(f"<p>{html.escape(each)}</p>" for each in said)
    alt = f"where the load of {found.scenario.name} can be held"
    return (
        paragraphs + to_html(examination.robot_table(found)) + _image(examination.sheet(found), alt)
    )


_SHOW: dict[type, Callable[[Any], str]] = {
    Scenario: _scenario,
    FreeSpace: _free_space,
    Plan: _plan,
    Overview: _comparison,
    Examination: _examination,
}
