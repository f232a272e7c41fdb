"""Step 3 of Fig. 2: force and position together, that is, in which order load and ends are planned.

The tensions couple the cables to where the load is, so neither can be planned without the other
(Sect. 3.3). Ends that are given leave only the load; ends that move are led along its path; ends
that are placed once alternate with it, or are searched together with it.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.coordination.ends import JointFitness, decode, joint_problem
from jaxsusp.mechanics.drives import moving
from jaxsusp.planning.choices import TAUT
from jaxsusp.planning.feasibility import static_tensions
from jaxsusp.planning.margins import SNUG, with_ends_at, with_margins
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.ranking import rank
from jaxsusp.planning.steps import (
    Candidate,
    Settings,
    checked,
    load_problem,
    map_space,
    plan_ends,
    plan_load,
    played,
    prepare,
    taut_ways,
    verify,
)
from jaxsusp.planning.waypoints import sample_path
from jaxsusp.problem.hardturns import gently
from jaxsusp.scenario.scenario import Scenario

ROUNDS = 2
"""Most alternations of placing the ends and planning the load."""

GAIN = 0.005
"""Relative improvement of the fitness below which alternation stops."""


class Attempt(NamedTuple):
    """One entry of the list of what to try."""

    number: int
    batches: int
    waypoints: int
    fresh_ends: bool


def coordinate(
    scenario: Scenario, settings: Settings, attempt: Attempt, first: int, batch: int
) -> Iterator[Plan]:
    """Verified plans of one batch of runs, until one leaves nothing to wish for.

    Args:
        scenario: the task.
        settings: what was asked for.
        attempt: how many waypoints, and whether ends are placed before the load is planned.
        first: index of the first run.
        batch: of this attempt, from 0.
    """
    if settings.ends == "given":
        return _given(scenario, settings, attempt, first, batch)
    if moving(scenario.drive):
        return _led(scenario, settings, attempt, first)
    if settings.coordination == "joint":
        return _joint(scenario, settings, attempt.waypoints, first)
    return _alternating(scenario, settings, attempt, first + batch, batch)


def _given(
    scenario: Scenario, settings: Settings, attempt: Attempt, first: int, batch: int
) -> Iterator[Plan]:
    """Plans with the scenario's own ends, or those of its drive mode's plain rule.

    First of all along taut ways; what a search finds then has to be better.
    """
    first_of_all = attempt.number == batch == 0
    share = SNUG if first_of_all and not moving(scenario.drive) else 1.0
    searched = with_margins(scenario, share=share)
    space = map_space(searched, settings)
    ways = taut_ways(space, settings) if first_of_all else ()
    if settings.optimizer is None:
        yield from verify(scenario, settings, ((way, None) for way in ways), TAUT)
        return
    problem = load_problem(searched, space, settings, attempt.waypoints)
    prepare(problem, settings, first)
    taut = _first_fine(checked(scenario, settings, (way, None), TAUT) for way in ways)
    candidates = plan_load(problem, settings, first)
    for found in verify(scenario, settings, ((x, None) for x in candidates)):
        yield found
        if found.feasible and taut and found.settings["fitness"] <= taut.settings["fitness"]:
            return
    if taut:
        yield played(settings, taut)


def _first_fine(tries: Iterable[Plan]) -> Plan | None:
    """The first feasible plan; where there is none, the first that is clear at least."""
    clear = None
    for found in tries:
        if found.feasible:
            return found
        clear = clear or (found if found.certificate.proved else None)
    return clear


def _led(scenario: Scenario, settings: Settings, attempt: Attempt, first: int) -> Iterator[Plan]:
    """Plans whose ends move out of the way: the load's path first, then the ends along it.

    The load is planned as if its cables met nothing, straight to the goal if it can be, in every
    other attempt with cables that follow the plain rule; then its ends are led past what is left
    (Sect. 3.3).
    """
    with_cables = attempt.number % 2 == 1
    line = np.linspace(scenario.task.start, scenario.task.goal, attempt.waypoints + 2)[1:-1]
    candidates = _load_alone(scenario, settings, attempt.waypoints, first, line, with_cables)

    def led() -> Iterator[Candidate]:
        for x in candidates:
            waypoints = np.asarray(x, np.float64).reshape(-1, 3)
            path = sample_path(scenario, waypoints, settings.samples)
            ends = plan_ends(scenario, settings, path, first)
            yield x, ends.places if ends.fine else None

    yield from verify(scenario, settings, led())


def _joint(scenario: Scenario, settings: Settings, waypoints: int, first: int) -> Iterator[Plan]:
    """Plans with ends and waypoints from one search (D = 3m + 2K + 1)."""
    problem = joint_problem(with_margins(scenario, moving_ends=True), waypoints, settings.samples)
    fitness = problem.fitness
    assert isinstance(fitness, JointFitness)
    candidates = []
    for x in plan_load(gently(problem, settings.price), settings, first):
        with jax.enable_x64(True):
            inner, placed = fitness.split(np.asarray(x, np.float64))
            ends = np.asarray(decode(fitness.world.robots, jnp.asarray(placed)))
        candidates.append((np.asarray(inner), ends))
    yield from verify(scenario, settings, candidates)


def _alternating(
    scenario: Scenario, settings: Settings, attempt: Attempt, first: int, batch: int
) -> Iterator[Plan]:
    """Place ends, plan the load, place again, until the fitness stops improving."""
    low, high = scenario.limits.tension
    task = np.array([scenario.task.start, scenario.task.goal], np.float64)
    held = static_tensions(scenario, task)
    best: Plan | None = None
    if attempt.fresh_ends or not ((held >= low) & (held <= high)).all():
        # Ends for the straight line come first.
        position = np.linspace(task[0], task[1], settings.samples)
    else:
        best = _first_good(_given(scenario, settings, attempt, first, batch))
        yield best
        position = best.path
    for number in range(ROUNDS):
        ends = plan_ends(scenario, settings, position, first + number)
        if best is not None and not ends.fine:
            return
        moved = with_ends_at(scenario, ends.places)
        known = None if best is None else best.waypoints
        candidates = _load_alone(moved, settings, attempt.waypoints, first, known)
        placed: Iterable[Candidate] = ((x, ends.places) for x in candidates)
        found = _first_good(verify(scenario, settings, placed))
        yield found
        gained = best is None or _gain(best, found) > GAIN
        if best is not None and best.feasible and not gained:
            return
        best, position = found, found.path


def _load_alone(
    scenario: Scenario,
    settings: Settings,
    waypoints: int,
    first: int,
    known: Float[np.ndarray, "waypoints xyz"] | None = None,
    with_cables: bool = True,
) -> Float[np.ndarray, "candidates dim"]:
    """Steps 1 and 2 for ends that are known, with the margins that the real curve needs."""
    searched = with_margins(scenario)
    space = map_space(searched, settings)
    problem = load_problem(searched, space, settings, waypoints, with_cables)
    if known is None or len(known) != waypoints:
        return plan_load(problem, settings, first)
    return plan_load(problem, settings, first, known.reshape(1, -1))


def _first_good(tries: Iterator[Plan]) -> Plan:
    """The first plan that leaves nothing to wish for, or the best of all."""
    return min(tries, key=rank)


def _gain(before: Plan, after: Plan) -> float:
    """Relative improvement of the fitness; none where feasibility is lost."""
    if before.feasible and not after.feasible:
        return 0.0
    if after.feasible and not before.feasible:
        return 1.0
    return 1 - after.settings["fitness"] / before.settings["fitness"]
