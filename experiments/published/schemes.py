"""Flow charts of the scheme, of force and position together, and of a free region."""

import inspect
import re

from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.coordination import passes
from jaxsusp.errors import InputError
from jaxsusp.freespace.iris import iris
from jaxsusp.planning import planner, steps, strategies
from jaxsusp.report.drawing.flowchart import chart
from jaxsusp.report.drawing.sourceflow import (
    Choice,
    Element,
    Leave,
    Loop,
    Step,
    first_sentence,
    flow,
    reached,
    step,
)

TITLE = "How it goes: three flow charts"
PRINTED = "Figs. 2, 3, 6"
DIFFERS = (
    "The paper draws its charts by hand; these are read from the source of the functions that run, "
    "so they name the steps that there are. Ends that move are led by exact dynamic programming "
    "over fans of candidates, where the paper turns a cable by a small angle at a time."
)
MADE = READ = ()
MINUTES = 0.0
FULL = MINIATURE = None

WIDE = 4.6  # inches


def scheme() -> tuple[Element, ...]:
    """Fig. 2: the steps that the documentation of `planning.steps` numbers, in the planner's loop.

    Raises:
        InputError: a step that is named there does not exist, or planning never comes to it.
    """
    used = reached(planner.plan)
    numbered = re.findall(r"^(\d)\. `([\w.]+)`", steps.__doc__ or "", re.MULTILINE)
    body: list[Element] = []
    for number, name in numbered:
        room = strategies if name.startswith("strategies.") else steps
        function = getattr(room, name.rpartition(".")[2], None)
        if function is None or inspect.unwrap(function) not in used:
            raise InputError(f"step {number}, {name}: planning does not come to it; mend `steps`")
        said = step(function)
        says = re.sub(r"^Step \d.*?: ", "", said.says)
        body.append(Step(f"{number}  {said.name}", says[:1].upper() + says[1:]))
    asked = f"done: {first_sentence(planner._Tally.done).removeprefix('Whether ')}"
    body.append(Choice(asked, (Leave("the plan"),)))
    return Loop(first_sentence(planner._attempts), tuple(body)), Leave("the best of all, refused")


def draw(artefacts: Artefacts) -> Page:
    """The charts."""
    figures = {
        "scheme": chart(scheme(), "a task", WIDE),
        "scheme-orders": chart(flow(strategies.coordinate, {"moving"}), "coordinate"),
        "scheme-alternation": chart(
            flow(strategies._alternating, {"first_good"}), "coordinate: alternating", WIDE
        ),
        "scheme-least-variance": chart(
            flow(passes.move, {"from_array", "_thickness", "_load_contacts", "features"}),
            "moving_ends: least variance", WIDE,
        ),
        "scheme-region": chart(flow(iris), "iris: a region about a seed", WIDE),
    }  # fmt: skip
    captions = (
        "Fig. 2: the scheme of planning, its five steps and what is tried again; "
        "the third decides in which order the others are taken.",
        "Fig. 3: in which order load and ends are planned.",
        "Fig. 3: ends that are placed once alternate with the load.",
        "Fig. 3: ends that move are led by least variance (Eq. 20), over narrower and narrower "
        "fans.",
        "Fig. 6: a convex region of free space (Eq. 23).",
    )
    for figure, caption in zip(figures.values(), captions, strict=True):
        figure.set_label(caption)
    return Page(figures)
