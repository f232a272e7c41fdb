"""What people read and see of a task before it is planned: a table, sentences, one picture."""

from collections import Counter
from collections.abc import Iterator
from shlex import quote
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from jaxsusp.geometry.meshes import surface
from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.planning.prospects.examination import PROVED, Examination
from jaxsusp.planning.prospects.stated import Key, keys_of, unfitting
from jaxsusp.report.drawing.painting import misplaced_samples, paint_misplaced
from jaxsusp.report.drawing.scene import cable_samples, paint_task
from jaxsusp.report.drawing.style import heading, legend, picture, remarks
from jaxsusp.report.render import Column, percent, significant
from jaxsusp.report.workspace import paint_scale, paint_slice, slice_samples
from jaxsusp.scenario.messages import numbered
from jaxsusp.scenario.ownunits import frame_of, in_words
from jaxsusp.scenario.scenario import Scenario

_PLURALS = {"box": "boxes", "mesh": "meshes"}


def sheet(found: Examination) -> Figure:
    """The task with its robots, and level sections of where it can be held at start and goal.

    Where start and goal are at one height, the second section is upright and holds both, or is
    half-way between them.
    """
    scenario, space = found.scenario, found.workspace
    figure = picture(11.0, 7.4)
    grid = figure.add_gridspec(2, 2, width_ratios=[1.6, 1])
    view = figure.add_subplot(grid[:, 0])
    camera = paint_task(view, scenario)
    paint_misplaced(view, found.blocked, camera.project)
    start, goal = np.array([scenario.task.start, scenario.task.goal])
    cuts = [(2, start[2], (0, 1)), (2, goal[2], (0, 1))]
    if abs(goal[2] - start[2]) < 2 * np.diff(space.axes[2]).max():
        across = 1 if abs(goal - start)[0] >= abs(goal - start)[1] else 0
        cuts[1] = (across, float((start + goal)[across] / 2), (1 - across, 2))
    sections = [figure.add_subplot(grid[row, 1]) for row in range(2)]
    images = [paint_slice(axes, space, *cut) for axes, cut in zip(sections, cuts, strict=True)]
    for axes, (_, _, shown) in zip(sections, cuts, strict=True):
        paint_misplaced(axes, found.blocked, lambda place, shown=shown: place[list(shown)])
    paint_scale(figure, images[0], sections)
    legend(figure, [*cable_samples(), *slice_samples(), *misplaced_samples(found.blocked)])
    remarks(figure, [each.words for each in found.blocked])
    heading(figure, f"{scenario.name}: {_verdict(found)}")
    return figure


def robot_table(found: Examination) -> pd.DataFrame:
    """One row per robot: where its end is, what its arm reaches, and what its cable carries."""
    held, limits = found.holding, found.scenario.limits
    frame = pd.DataFrame(
        {
            "robot": [str(k + 1) for k in range(len(held.distance))],
            "distance": held.distance,
            "reach": [
                f"{significant(near, 3)} … {significant(far, 3)}"
                for near, far in zip(held.nearest, held.farthest, strict=True)
            ],
            "length_start": held.lengths[0],
            "length_goal": held.lengths[1],
            "tension_start": held.tensions[0],
            "tension_goal": held.tensions[1],
        }
    )
    frame.attrs["title"] = "Robots and their cables"
    frame.attrs["columns"] = {
        "distance": Column("end from shoulder (m)"),
        "reach": Column("arm reaches (m)"),
        "length_start": Column("length at start (m)"),
        "length_goal": Column("length at goal (m)"),
        "tension_start": Column("tension at start (N)"),
        "tension_goal": Column("tension at goal (N)"),
    }
    ranges = {"length": limits.cable_length, "tension": limits.tension}
    frame.attrs["bold"] = frozenset(
        (row, f"{what}_{place}")
        for what, (low, high) in ranges.items()
        for place in ("start", "goal")
        for row, value in enumerate(frame[f"{what}_{place}"])
        if not low <= value <= high
    )
    frame.attrs["caption"] = (
        f"Lengths may be {_range(limits.cable_length)} m, tensions {_range(limits.tension)} N; at "
        "rest."
    )
    return frame


def verdict(found: Examination, source: str) -> str:
    """What to do next, in one sentence.

    Args:
        found: the examination.
        source: the name or file of the scenario, as commands take it.
    """
    said = f"{found.scenario.name}: {_verdict(found)}"
    if found.possible:
        return f"{said}; next: jaxsusp plan {quote(source)}"
    return f"{said}; change {source} and check it again"


def _verdict(found: Examination) -> str:
    if not found.possible:
        return "this task cannot be carried out as it is stated"
    if found.refusal is not None:
        return "it is doubtful whether there is a plan"
    return "nothing is known that stands in the way of a plan"


def about(scenario: Scenario) -> Iterator[str]:
    """What a scenario is and states, a paragraph each."""
    kinds = Counter(each.kind for each in scenario.obstacles)
    listed = ", ".join(
        f"{n} {kind if n == 1 else _PLURALS.get(kind, f'{kind}s')}" for kind, n in kinds.items()
    )
    payload, frame = scenario.payload, frame_of(scenario)
    hung = "at one hook" if payload.attachments == "hook" else "at one point per cable"
    yield (
        f'{len(scenario.robots)} robots, drive = "{scenario.drive}", carry {payload.mass:g} kg '
        f"({significant(payload.mass * GRAVITY, 3)} N) {hung} from {in_words(scenario.task.start)} "
        f"to {in_words(scenario.task.goal)} in {scenario.task.duration:g} s; obstacles: "
        f"{listed or 'none'}."
    )
    keys = keys_of(scenario)
    for each in mesh_records(scenario):
        yield _mesh_in_words(each)
    yield f"Given: {_listed([key for key in keys if key.given], values=False)}."
    yield f"Default: {_listed([key for key in keys if not key.given], values=True)}."
    yield (
        f"Own units: {frame.length:.4g} m (a ninth of the mean total link length) and "
        f"{frame.mass:.4g} kg (a tenth of the load), where the benchmark has 1 m and 1 kg; "
        f"places count from {in_words(frame.origin)}."
    )
    if wrong := unfitting(scenario):
        paths = dict.fromkeys(_without_number(path) for path in wrong)
        yield (
            "These defaults are metres, newtons and seconds of the benchmark's size, which this "
            f"task has not; state them: {', '.join(paths)}."
        )


def mesh_records(scenario: Scenario) -> list[dict[str, Any]]:
    """What is in the file of every mesh, and what stands for it, in SI units."""
    found = []
    for i, obstacle in enumerate(scenario.obstacles):
        if obstacle.kind != "mesh":
            continue
        inside, bodies = surface(obstacle.path), obstacle.bodies
        open_edges = inside.open_edges
        overlaps = not open_edges and inside.overlaps
        box = float(np.prod(obstacle.size))
        found.append(
            {
                "obstacle": numbered("obstacles", i, obstacle.name),
                "size_m": obstacle.size,
                "triangles": len(inside.faces),
                "open_edges": open_edges,
                "overlaps": overlaps,
                "volume_m3": (
                    None if open_edges or overlaps else inside.volume * obstacle.scale**3
                ),
                "shape": obstacle.shape,
                "bodies": len(bodies) or 1,
                "bodies_m3": sum(body.volume for body in bodies) if bodies else box,
            }
        )
    return found


def _mesh_in_words(mesh: dict[str, Any]) -> str:
    size = " × ".join(significant(side, 3) for side in mesh["size_m"])
    bodies, volume, own = mesh["bodies"], mesh["bodies_m3"], mesh["volume_m3"]
    shape = {"box": "its bounding box", "hull": "its convex hull"}.get(
        mesh["shape"], f"{bodies} convex piece{'s' * (bodies != 1)}"
    )
    text = (
        f"{mesh['obstacle']} is a mesh of {mesh['triangles']:,} triangles, {size} m, in place of "
        f"which {'is' if bodies == 1 else 'are'} {shape}, {significant(volume, 3)} m³"
    )
    if mesh["overlaps"]:
        return (
            f"{text}; it overlaps itself, or parts of it are turned inside out: its own volume is "
            "not told."
        )
    if own is None:
        return f"{text}; it is not closed ({mesh['open_edges']} open edges): it has no volume."
    return f"{text}, {significant(max(volume - own, 0.0), 3)} m³ more than it has itself."


def prospects(found: Examination) -> Iterator[str]:
    """What holds the load and what stands in its way, a sentence or two each."""
    space = found.workspace
    yield (
        f"Tensions and lengths are admissible in {percent(float(space.admissible.mean()))} of the "
        f"workspace box; there and clear of obstacles, {percent(float(space.usable.mean()))}: "
        f"{significant(space.volume(space.usable), 3)} m³."
    )
    for each in found.blocked:
        yield from (*each.reasons, each.remedy)
    if found.space is not None and found.space.connected:
        ways = len(found.space.routes)
        yield (
            f"{len(found.space.d)} convex regions cover "
            f"{percent(found.space.coverage)} of the free space; shortest way "
            f"{significant(found.space.length)} m, {ways} distinct way{'s' * (ways != 1)}."
        )
    if found.passage is not None:
        yield f"{found.passage.words[0].upper()}{found.passage.words[1:]}."
    if found.refusal is not None:
        kind = "" if found.refusal.kind == PROVED or not found.possible else "A hint, no proof: "
        yield f"{kind}{found.refusal.text}."


def _listed(keys: list[Key], values: bool) -> str:
    """Keys by the tables they are in, those of all robots or obstacles once."""
    tables: dict[str, dict[str, None]] = {}
    for key in keys:
        text = f"{key.key} = {key.value}" if values else key.key
        tables.setdefault(_without_number(key.table), {})[text] = None
    parts = (f"{table and f'[{table}] '}{', '.join(texts)}" for table, texts in tables.items())
    return "; ".join(parts) or "nothing"


def _without_number(path: str) -> str:
    """The path of a key in every row of an array of tables: robots[0].end → robots.end."""
    head, bracket, tail = path.partition("[")
    return f"{head}{tail.partition(']')[2]}" if bracket else path


def _range(pair: tuple[float, float]) -> str:
    return f"{pair[0]:g} to {pair[1]:g}"
