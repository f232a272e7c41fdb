"""A task looked at before it is planned: what holds its load, what blocks it, what is narrow."""

from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._showing import Shown
from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.cells.passage import Passage, passage
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.mechanics.arm import reach, shoulder_distance
from jaxsusp.planning.feasibility import trouble
from jaxsusp.planning.refusal import Refusal, why_not
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.suspension.cableloads import cable_loads
from jaxsusp.suspension.misplaced import Misplaced, misplaced
from jaxsusp.suspension.workspace import Workspace, workspace

PROVED = "proved blocked"
"""The kind of refusal that is a proof, beside what cables cannot hold at start or goal."""


class Holding(NamedTuple):
    """How robots and cables hold the load at start and goal; SI units."""

    distance: Float[np.ndarray, "cables"]  # of ends from shoulders, as stated, m
    nearest: Float[np.ndarray, "cables"]  # that the arms reach, m
    farthest: Float[np.ndarray, "cables"]
    lengths: Float[np.ndarray, "places=2 cables"]  # of cables, m
    tensions: Float[np.ndarray, "places=2 cables"]  # at rest, N; NaN without an equilibrium


@dataclass(frozen=True, eq=False)
class Examination(Shown):
    """What is known of a task before it is planned; numbers in SI units.

    Attributes:
        scenario: the task.
        holding: reach, lengths and tensions at start and goal.
        workspace: where the load can be held.
        space: where load and cables are clear; None where an end of a cable is not.
        blocked: start and goal where the load must not be.
        passage: how narrow it gets; None where no way is known.
        refusal: what stands in the way, or None. A proof or a hint, as `possible` tells.
        possible: whether the task is not known to be impossible with the ends it states.
    """

    scenario: Scenario
    holding: Holding
    workspace: Workspace
    space: FreeSpace | None
    blocked: tuple[Misplaced, ...]
    passage: Passage | None
    refusal: Refusal | None
    possible: bool


def examine(scenario: Scenario | Named) -> Examination:
    """Look at a task before any plan, as `jaxsusp check` does.

    Args:
        scenario: the task; its start and goal may be inadmissible.

    Raises:
        ScenarioError: the file itself has mistakes, one line each.
        InputError: separate attachments whose ends no rule moves.
    """
    task = load_scenario(scenario, task_checked=False)
    held = workspace(task)
    try:
        space = free_space(task)
    except InputError as error:  # an end stands in a warning area
        return Examination(
            task, holding_of(task), held, None, misplaced(task, held), None,
            Refusal("ends", str(error)), possible=False,
        )  # fmt: skip
    blocked = misplaced(task, held) or misplaced(task, space)
    found = None if task.troubles else trouble(task.own)
    refusal = None if task.troubles else why_not(task, space=space)
    narrow = passage(task, space) if space.connected else None
    possible = not blocked and found is None and (refusal is None or refusal.kind != PROVED)
    if refusal is not None and refusal.kind == "unknown":
        refusal = None
    return Examination(task, holding_of(task), held, space, blocked, narrow, refusal, possible)


def holding_of(scenario: Scenario) -> Holding:
    """Reach, lengths and tensions of a task, whether they are within their limits or not."""
    own, units = scenario.own, scenario.units
    rows = [(robot.base, robot.links, robot.end) for robot in own.robots]
    with jax.enable_x64(True):
        base, links, end = map(jnp.array, zip(*rows, strict=True))
        arms = [np.asarray(each) for each in (shoulder_distance(base, links, end), *reach(links))]
    loads = cable_loads(own, np.array([own.task.start, own.task.goal], np.float64))
    distance, nearest, farthest, lengths = (
        units.number(each, "m") for each in (*arms, loads.lengths)
    )
    tensions = units.number(loads.static, "N")
    return Holding(distance, nearest, farthest, lengths, tensions)
