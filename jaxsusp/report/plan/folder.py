"""Everything that is written about a plan: file, samples, tables and figures in one folder."""

import os
from collections.abc import Callable
from pathlib import Path

from matplotlib.figure import Figure

from jaxsusp._files import write_text
from jaxsusp.planning.document import stem
from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.style import save
from jaxsusp.report.plan import figures as planfigures
from jaxsusp.report.plan.pace import pace
from jaxsusp.report.plan.scene import scene
from jaxsusp.report.plan.tables import ends_table, limits_table
from jaxsusp.report.plan.words import is_paced, summary
from jaxsusp.report.render import to_markdown

FIGURES: dict[str, Callable[[Plan], Figure]] = {
    "kinematics": planfigures.kinematics,
    "scene": scene,
    "cables": planfigures.cables,
    "posture": planfigures.posture,
    "ends": planfigures.ends,
    "pace": pace,
}

_APPLIES: dict[str, Callable[[Plan], bool]] = {
    "posture": lambda plan: plan.scenario.payload.attachments != "hook",
    "ends": lambda plan: plan.rigging.moves,
    "pace": is_paced,
}
"""Figures that not every plan has, and of which plans they show something."""


def write_plan(plan: Plan, folder: str | os.PathLike[str]) -> list[Path]:
    """Write a plan, its samples, what is said of it with its constraint report, and its figures.

    Args:
        plan: feasible or not.
        folder: created where missing.

    Returns:
        The files written, the plan itself first.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    name = stem(plan.scenario.name)
    files = [folder / f"{name}.plan.json", folder / f"{name}.plan.csv", folder / f"{name}.plan.md"]
    plan.save(files[0])
    plan.save_csv(files[1])
    write_text(files[2], _told(plan))
    for kind, draw in figures_of(plan).items():
        files.append(folder / f"{name}.{kind}.png")
        save(draw(plan), files[-1])
    return files


def _told(plan: Plan) -> str:
    """The report that is passed on: what is said of the plan, and its tables."""
    said = "\n\n".join((f"# {plan.scenario.name}", *summary(plan)))
    tables = (limits_table(plan.report), ends_table(plan))
    return "\n".join((f"{said}\n", *(f"## {t.attrs['title']}\n\n{to_markdown(t)}" for t in tables)))


def figures_of(plan: Plan) -> dict[str, Callable[[Plan], Figure]]:
    """The figures that show something of a plan, by name."""
    return {
        name: draw for name, draw in FIGURES.items() if _APPLIES.get(name, lambda _: True)(plan)
    }
