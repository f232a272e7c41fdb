"""From a task to a verified plan: search, smooth, check, and search again (Fig. 2; spec §10)."""

import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.batch import run_batch
from jaxsusp.coordination.ends import JointFitness, decode, joint_problem, place_ends
from jaxsusp.coordination.leastvariance import moving_ends
from jaxsusp.coordination.margins import MARGIN, with_ends_at, with_margins
from jaxsusp.errors import InputError, require, require_count, require_known, require_seed
from jaxsusp.feasibility import require_possible, static_tensions
from jaxsusp.fitness import fitness_terms
from jaxsusp.freespace.build import free_space
from jaxsusp.hanging import require_rule
from jaxsusp.mechanics.drives import moving
from jaxsusp.optim.base import Optimizer
from jaxsusp.optim.refine import refine
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.plans import Plan, plan_through, sample_path
from jaxsusp.problem import Problem, Suspension, stack_problems
from jaxsusp.scenario import Scenario, load_scenario
from jaxsusp.search import SEARCHES
from jaxsusp.trajectory.gentle import gently
from jaxsusp.vec3 import Vec3
from jaxsusp.verify.simulation import simulate
from jaxsusp.world import World, build_world, cast_world, rounded_counts

SEARCH = SEARCHES[0]
"""Rule that keeps waypoints inside unless another is asked for."""

ENDS = ("given", "placed")
COORDINATIONS = ("alternation", "joint")

GENTLE_TILT, GENTLE_TENSION = 0.3, 10.0
"""Degrees of tilt up to which, and N of tension from which on, a load is taken to follow its plan
without being simulated."""

ROUNDS = 2
"""Most alternations of placing the ends and planning the load."""

GAIN = 0.005
"""Relative improvement of the fitness below which alternation stops."""

MORE_WAYPOINTS = 2

MOST_LED = 4
"""Robots whose ends least variance leads: joint candidates grow with their number as a power."""


class Event(NamedTuple):
    """What a progress callback is told."""

    phase: str  # "mapping the free space", "searching", "placing ends", "checking"
    attempt: int  # from 0
    attempts: int  # at most


class _Settings(NamedTuple):
    """What a person asked for."""

    optimizer: Optimizer
    runs: int
    iterations: int
    population: int
    seed: int
    samples: int
    search: str
    told: Callable[[str], None]


def plan(
    scenario: Scenario | str | os.PathLike[str],
    algorithm: str | Optimizer = "sdbo",
    ends: str = "given",
    runs: int = 4,
    iterations: int = 300,
    retries: int = 3,
    seed: int = 0,
    *,
    population: int = 30,
    waypoints: int = 5,
    samples: int = 40,
    search: str = SEARCH,
    coordination: str = "alternation",
    progress: Callable[[Event], None] = lambda event: None,
) -> Plan:
    """Plan a task, and verify it on the real curve.

    The winners of the search are refined locally, laid on a smooth path, driven from rest to rest
    and checked against all of Eq. 22 and in continuous time. Where none of them stands, the
    planner tries again: with further runs, then other ends (where they are placed), then more
    waypoints, each time with twice as many runs. A plan that breaks a limit is never returned as
    feasible. A feasible plan that a swinging load does not follow in simulation is only returned
    where nothing better was found (`settings["tracked"]` tells).

    Args:
        scenario: the task, or its name or file.
        algorithm: what searches, a name or an optimiser.
        ends: "given" keeps the scenario's ends, or moves them by the plain rule of its drive mode;
            "placed" optimises where they stay, or chooses their way by least variance (Eq. 20)
            around the plain rule so that the cables keep clear of what the load passes.
        runs: independent runs per batch.
        iterations: iterations per run.
        retries: further attempts where the first gives no feasible plan.
        seed: root of all randomness.
        population: candidates per iteration.
        waypoints: free waypoints m.
        samples: samples n of trajectory and plan.
        search: rule that keeps waypoints inside, see `jaxsusp.search`.
        coordination: of placed ends with the load: "alternation" or "joint" (D = 3m + 2K + 1).
        progress: called when something begins, see `Event`.

    Returns:
        A feasible `Plan`, or the best attempt marked infeasible with the reasons.

    Raises:
        ImpossibleTaskError: no tensions within limits can hold the load; told before any search.
        InputError: bad settings, or a system that planning does not cover.
    """
    if not isinstance(scenario, Scenario):
        scenario = load_scenario(scenario)
    require_rule(scenario)
    counts = (
        ("runs", runs, 1), ("iterations", iterations, 1), ("population", population, 1),
        ("waypoints", waypoints, 1), ("samples", samples, 3), ("retries", retries, 0),
    )  # fmt: skip
    for name, value, least in counts:
        require_count(name, value, least=least)
    require_seed(seed)
    require_known("ends", ends, ENDS)
    require_known("coordination", coordination, COORDINATIONS)
    require_known("search", search, SEARCHES)
    require(
        coordination == "alternation" or (ends == "placed" and not moving(scenario.drive)),
        'coordination = "joint" places ends that stay; give ends = "placed" and drive = "cable" '
        "with it",
    )
    require(
        ends == "given" or not moving(scenario.drive) or scenario.payload.attachments == "hook",
        'ends = "placed" leads moving ends of a hook alone: with separate payload.attachments '
        'they hold the load level; give ends = "given"',
    )
    require(
        ends == "given" or not moving(scenario.drive) or len(scenario.robots) <= MOST_LED,
        f'ends = "placed" leads the moving ends of at most {MOST_LED} robots, got '
        f'{len(scenario.robots)}; give ends = "given"',
    )
    optimizer = algorithm_of(algorithm)
    require_possible(scenario, ends)

    tally, made = _Tally(), 0
    for attempt in _attempts(retries, waypoints, ends):

        def told(phase: str, attempt=attempt) -> None:
            progress(Event(phase, attempt.number, retries + 1))

        settings = _Settings(optimizer, runs, iterations, population, seed, samples, search, told)
        made += 1
        for batch in range(attempt.batches):
            first = tally.take(runs)
            if ends == "given":
                tries = _given(scenario, settings, attempt.waypoints, first)
            elif moving(scenario.drive):
                tries = _led(scenario, settings, attempt, first)
            elif coordination == "joint":
                tries = _joint(scenario, settings, attempt.waypoints, first)
            else:
                tries = _alternating(scenario, settings, attempt, first + batch)
            for found in tries:
                tally.note(found)
            if tally.done:
                break
        if tally.done:
            break
    assert tally.best is not None
    return _with_settings(
        tally.best, algorithm=optimizer.name, ends=ends, runs=runs, iterations=iterations,
        population=population, retries=retries, seed=seed, samples=samples, search=search,
        coordination=coordination, attempts=made, runs_made=tally.runs,
    )  # fmt: skip


class _Attempt(NamedTuple):
    """One entry of the list of what to try."""

    number: int
    batches: int
    waypoints: int
    fresh_ends: bool


def _attempts(retries: int, waypoints: int, ends: str) -> Iterator[_Attempt]:
    """The task as asked; then other seeds, other ends, more waypoints, in turn."""
    for number in range(retries + 1):
        more = number // 3 * MORE_WAYPOINTS if number else 0
        fresh = ends == "placed" and number % 3 == 2
        yield _Attempt(number, 2**number, waypoints + more, fresh)


class _Tally:
    """The best plan so far, and how many runs have been used: no run is made twice."""

    def __init__(self):
        self.best: Plan | None = None
        self.runs = 0

    def take(self, runs: int) -> int:
        """First of so many further run indices."""
        first, self.runs = self.runs, self.runs + runs
        return first

    def note(self, found: Plan) -> None:
        """Keep a plan if it is better: feasible before infeasible, then by fitness."""
        if self.best is None or _rank(found) < _rank(self.best):
            self.best = found

    @property
    def done(self) -> bool:
        """Whether there is nothing left to wish for."""
        return self.best is not None and _good(self.best)


def _rank(plan: Plan) -> tuple:
    settings = plan.settings
    return not plan.feasible, len(plan.reasons), not settings["tracked"], settings["fitness"]


def _good(plan: Plan) -> bool:
    return plan.feasible and plan.settings["tracked"]


def _with_settings(plan: Plan, **settings: Any) -> Plan:
    """The plan with more of the settings it was found with."""
    return replace(plan, settings={**plan.settings, **settings})


def _given(scenario: Scenario, settings: _Settings, waypoints: int, first: int) -> Iterator[Plan]:
    """Plans with the scenario's own ends, best first, until one is feasible."""
    candidates = _search(scenario, settings, waypoints, first)
    yield from _checked(scenario, settings, ((x, None) for x in candidates))


def _led(scenario: Scenario, settings: _Settings, attempt: _Attempt, first: int) -> Iterator[Plan]:
    """Plans whose ends move out of the way: the load's path first, then the ends along it.

    The load is planned as if its cables met nothing, straight to the goal if it can be, in every
    other attempt with cables that follow the plain rule; then its ends are led past what is left
    (Sect. 3.3).
    """
    with_cables = attempt.number % 2 == 1
    line = np.linspace(scenario.task.start, scenario.task.goal, attempt.waypoints + 2)[1:-1]
    candidates = _search(scenario, settings, attempt.waypoints, first, line, with_cables)
    settings.told("leading the ends")

    def pairs() -> Iterator[tuple[np.ndarray, np.ndarray | None]]:
        for x in candidates:
            waypoints = np.asarray(x, np.float64).reshape(-1, 3)
            path = sample_path(scenario, waypoints, settings.samples)
            found = moving_ends(scenario, path, margin=MARGIN)
            yield x, found.ends if found.feasible else None

    yield from _checked(scenario, settings, pairs())


def _joint(scenario: Scenario, settings: _Settings, waypoints: int, first: int) -> Iterator[Plan]:
    """Plans with ends and waypoints from one search."""
    settings.told("searching")
    problem = joint_problem(with_margins(scenario, moving_ends=True), waypoints, settings.samples)
    fitness = problem.fitness
    assert isinstance(fitness, JointFitness)
    pairs = []
    for x in _minimise(problem, settings, first):
        with jax.enable_x64(True):
            inner, placed = fitness.split(np.asarray(x, np.float64))
            ends = np.asarray(decode(fitness.world.robots, jnp.asarray(placed)))
        pairs.append((np.asarray(inner), ends))
    yield from _checked(scenario, settings, pairs)


def _alternating(
    scenario: Scenario, settings: _Settings, attempt: _Attempt, first: int
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
        best = _first_good(_given(scenario, settings, attempt.waypoints, first))
        yield best
        position = best.path
    for number in range(ROUNDS):
        settings.told("placing ends")
        placement = place_ends(
            with_margins(scenario, moving_ends=True), position, settings.optimizer,
            (settings.seed + first + number) % 2**32, settings.runs,
            max(1, settings.iterations // 3), settings.population,
        )  # fmt: skip
        if best is not None and placement.faults:
            return
        moved = with_ends_at(scenario, placement.ends)
        known = None if best is None else best.waypoints
        candidates = _search(moved, settings, attempt.waypoints, first, known)
        pairs = ((x, placement.ends) for x in candidates)
        found = _first_good(_checked(scenario, settings, pairs))
        yield found
        gained = best is None or _gain(best, found) > GAIN
        if best is not None and best.feasible and not gained:
            return
        best, position = found, found.path


def _first_good(tries: Iterator[Plan]) -> Plan:
    """The first plan that leaves nothing to wish for, or the best of all."""
    kept: Plan | None = None
    for found in tries:
        if kept is None or _rank(found) < _rank(kept):
            kept = found
    assert kept is not None
    return kept


def _gain(before: Plan, after: Plan) -> float:
    """Relative improvement of the fitness; none where feasibility is lost."""
    if before.feasible and not after.feasible:
        return 0.0
    if after.feasible and not before.feasible:
        return 1.0
    return 1 - after.settings["fitness"] / before.settings["fitness"]


def _checked(scenario: Scenario, settings: _Settings, pairs) -> Iterator[Plan]:
    """Lay candidates on real curves and check them, until one is feasible."""
    settings.told("checking")
    for x, ends in pairs:
        waypoints = np.asarray(x, np.float64).reshape(-1, 3)
        found = plan_through(scenario, waypoints, ends, settings.samples)
        tracked = found.feasible and _tracks(found)
        found = _with_settings(found, fitness=_fitness(scenario, found), tracked=tracked)
        yield found
        if _good(found):
            return


def _tracks(plan: Plan) -> bool:
    """Whether a load that swings stays with the plan: simulated, unless it hardly accelerates."""
    values = {each.name: each.value for each in plan.report}
    gentle = values.get("tilt of the load", np.inf) <= GENTLE_TILT and not plan.rigging.moves
    taut = values["least tension"] >= GENTLE_TENSION
    return (gentle and taut) or not simulate(plan).problems(plan)


def _search(
    scenario: Scenario,
    settings: _Settings,
    waypoints: int,
    first: int,
    known: Float[np.ndarray, "waypoints xyz"] | None = None,
    with_cables: bool = True,
) -> Float[np.ndarray, "candidates dim"]:
    """Waypoints that the search found, refined, best first; `known` ones join the candidates."""
    problem = _problem(with_margins(scenario), settings, waypoints)
    if not with_cables:
        suspension = problem.fitness
        assert isinstance(suspension, Suspension)
        problem = problem.with_fitness(replace(suspension, with_cables=False))
    settings.told("searching")
    extra = None
    if known is not None and len(known) == waypoints:
        extra = known.reshape(1, -1)
    return _minimise(problem, settings, first, extra)


def _problem(searched: Scenario, settings: _Settings, waypoints: int) -> Problem:
    """The load's problem, in shapes that other scenarios and other ends share.

    A free space in which start and goal are not connected proves nothing, and every plan is
    certified anyway: the search then takes the whole workspace.
    """
    search, space = settings.search, None
    if search != "box":
        settings.told("mapping the free space")
        with suppress(InputError):  # with its margin, a warning area can reach the end of a cable
            space = free_space(searched)
        search = search if space and space.connected else "box"
    world = build_world(searched, rounded_counts(searched))
    problem = Problem.from_scenario(
        searched, waypoints, settings.samples, search, np.float32, world, space=space
    )
    if problem.regions is None:
        return problem
    count, rows, _ = problem.regions.table.shape
    return problem.with_padded_regions(32 * -(-count // 32), 16 * -(-rows // 16))


def _minimise(
    problem: Problem, settings: _Settings, first: int, extra: np.ndarray | None = None
) -> Float[np.ndarray, "candidates dim"]:
    """Search and refine in float32; the candidates in order of fitness."""
    outcome = run_batch(
        stack_problems([problem]), settings.optimizer, settings.seed,
        range(first, first + settings.runs), settings.iterations, settings.population,
    )  # fmt: skip
    found = outcome.x[0]
    if extra is not None:  # in place of the worst, so that no other program is needed
        found = found.copy()
        found[outcome.fitness[0].argmax()] = extra[0]
    problem = gently(problem)
    found = refine(problem, found, settings.seed)
    value = np.asarray(_evaluate(problem, found))
    return found[np.argsort(value, kind="stable")]


@jax.jit
def _evaluate(problem: Problem, x):
    return problem.evaluate(x)


def _fitness(scenario: Scenario, found: Plan) -> float:
    """Eq. 21 of a plan in float64, without any margin."""
    moved = scenario if found.rigging.moves else with_ends_at(scenario, found.ends)
    x = found.waypoints.reshape(-1, 1)
    with jax.enable_x64(True):
        world = cast_world(build_world(moved, rounded_counts(moved)), np.float64)
        packed = np.moveaxis(found.end_path, 1, 0)
        ends = Vec3.from_array(jnp.asarray(packed)) if found.rigging.moves else None
        with_stability = moved.limits.stability > 0
        structure = len(found.path), with_stability, moved.drive
        return float(_terms(world, jnp.asarray(x), *structure, ends).total[0])


@jax.jit(static_argnums=(2, 3, 4))
def _terms(world: World, x, samples: int, with_stability: bool, drive: str, ends: Vec3 | None):
    if ends is not None:
        ends = ends.each(lambda c: c[..., None])  # a batch of one candidate
    return fitness_terms(world, x, samples, with_stability, drive, ends=ends)
