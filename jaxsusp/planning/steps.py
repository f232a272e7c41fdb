"""The steps of Fig. 2, each a function; `strategies` is the third of them.

1. `map_space`: the system and its obstacles give the collision-free space (Sect. 4.1).
2. `plan_load`: the objective (Eq. 21, 22), and the load's trajectory by a population search.
3. `strategies.coordinate`: load and ends in the order in which they go together (Sect. 3.3).
4. `plan_ends`: where the cables' ends go along the load's trajectory.
5. `verify`: what was found, on the real curve, in continuous time and in simulation.
"""

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.coordination.ends import place_ends
from jaxsusp.coordination.leastvariance import moving_ends
from jaxsusp.errors import InputError
from jaxsusp.freespace.build import FINER, free_space
from jaxsusp.freespace.rounding import rounded_ways
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.mechanics.drives import moving
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.batch import compile_batch, run_batch
from jaxsusp.optim.refine import refine
from jaxsusp.planning.choices import AHEAD
from jaxsusp.planning.margins import MARGIN, with_margins
from jaxsusp.planning.motion.drive import followed
from jaxsusp.planning.motion.wanted import Wanted
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.ranking import fitness_of, seen_in, simulated, with_settings
from jaxsusp.planning.waypoints import laid, sample_path
from jaxsusp.problem.hardturns import PRICE, gently
from jaxsusp.problem.problem import Problem, stack_problems
from jaxsusp.problem.suspension import Suspension
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import build_world, rounded_counts, rounded_up
from jaxsusp.suspension.rigging import ends_beside

LEAST_FOR_ENDS = 30
"""Iterations of a search for ends at least; a third of those for the load if that is more."""

FORESEEN = 32
"""Obstacles up to which the search is compiled before the free space is known, see `foresee`."""

SEARCHED = "searched"
"""The way of a plan that a search found, in its settings; beside `TAUT`."""

Candidate = tuple[np.ndarray, np.ndarray | None]
"""Waypoints (dim,) or (waypoints, xyz) and the ends that go with them; None: the plain rule's."""


class Settings(NamedTuple):
    """What a person asked for."""

    optimizer: AnyOptimizer | None  # None: taut ways alone
    ends: str  # "given" or "placed"
    coordination: str  # "alternation" or "joint"
    runs: int
    iterations: int
    population: int
    seed: int
    samples: int
    search: str
    simulate: bool = True  # whether plans are played, and have to follow
    wanted: Wanted = Wanted()  # how paths are driven
    told: Callable[[str], None] = lambda phase: None
    price: float = PRICE  # on hard turns


def map_space(searched: Scenario, settings: Settings) -> FreeSpace | None:
    """Step 1: the free space in which the load is searched; None where it is the whole workspace.

    A free space in which start and goal are not connected proves nothing, and every plan is
    verified anyway: the search then takes the whole workspace.
    """
    if settings.search == "box":
        return None
    settings.told("mapping the free space")
    with suppress(InputError):  # with its margin, a warning area can reach the end of a cable
        space = free_space(searched)
        if not (space.connected or settings.optimizer):  # taut ways have nothing else
            space = free_space(searched, **FINER)
        return space if space.connected else None
    return None


def taut_ways(
    space: FreeSpace | None, settings: Settings
) -> Iterator[Float[np.ndarray, "waypoints xyz"]]:
    """Step 2 without luck: curves along the distinct taut ways, rounded within their regions.

    As waypoints, one per sample between start and goal: the path goes through them and nowhere
    else. What the regions do not know of (tensions, arms, ends that move) is left to the checks.
    """
    for curve in () if space is None else rounded_ways(space, settings.samples):
        yield curve[1:-1]


def load_problem(
    searched: Scenario,
    space: FreeSpace | None,
    settings: Settings,
    waypoints: int,
    with_cables: bool = True,
) -> Problem:
    """What step 2 searches: waypoints of the load, at a price on hard turns.

    Args:
        searched: the task, with the margins that the search keeps.
        space: where waypoints are kept, see `map_space`.
        settings: what searches, and for how long.
        waypoints: number m of them.
        with_cables: whether contacts of cables and arms count, or the load's alone.
    """
    search = settings.search if space is not None else "box"
    # Obstacles and regions are padded, so that other scenarios and other ends share the program.
    world = build_world(searched, rounded_counts(searched))
    problem = Problem.from_scenario(
        searched, waypoints, settings.samples, search, np.float32, world, space=space
    )
    if problem.regions is not None:
        count, rows, _ = problem.regions.table.shape
        problem = problem.with_padded_regions(rounded_up(count, 64), rounded_up(rows, 32))
    if not with_cables:
        suspension = problem.fitness
        assert isinstance(suspension, Suspension)
        problem = problem.with_fitness(replace(suspension, with_cables=False))
    return gently(problem, settings.price)


def foresee(scenario: Scenario, settings: Settings, waypoints: int) -> None:
    """Have the search with given ends compiled while it is still being found out what it is for."""
    small = len(scenario.obstacles) <= FORESEEN and settings.search != "box"
    if small and settings.ends == "given" and settings.optimizer is not None:
        with suppress(InputError):  # what cannot be searched is told where it is found out
            prepare(load_problem(scenario, _any_space(scenario), settings, waypoints), settings, 0)


def _any_space(scenario: Scenario) -> FreeSpace:
    """A free space of one region.

    Of nearly all scenarios the regions fit into the fewest places that `load_problem` makes for
    them, so that the program for this one is the program for theirs.
    """
    line = np.array([scenario.task.start, scenario.task.goal], np.float64)
    regions = np.zeros((1, 1, 3)), np.ones((1, 1)), np.eye(3)[None], line.mean(axis=0)[None]
    return FreeSpace(*regions, np.ones((1, 1), bool), np.zeros(1, int), line, 0.0, 0.0)


def prepare(problem: Problem, settings: Settings, first: int) -> None:
    """Have what `plan_load` will run compiled beside what comes before it."""
    assert settings.optimizer is not None
    arguments = _batch(problem, settings, first)
    threading.Thread(target=compile_batch, args=arguments, name=AHEAD).start()


def _batch(problem: Problem, settings: Settings, first: int) -> tuple[Any, ...]:
    runs = range(first, first + settings.runs)
    sizes = settings.iterations, settings.population
    return stack_problems([problem]), settings.optimizer, settings.seed, runs, *sizes


def plan_load(
    problem: Problem,
    settings: Settings,
    first: int,
    known: Float[np.ndarray, "1 dim"] | None = None,
) -> Float[np.ndarray, "candidates dim"]:
    """Step 2: what a population search found in float32, refined, best first.

    Args:
        problem: what is searched.
        settings: what searches, and for how long.
        first: index of the first run.
        known: a candidate that joins those that are found.
    """
    assert settings.optimizer is not None
    settings.told("searching")
    outcome = run_batch(*_batch(problem, settings, first))
    found, value = outcome.x[0], outcome.fitness[0]
    if known is not None:  # in place of the worst, so that no other program is needed
        found = found.copy()
        found[value.argmax()] = known[0]
    if known is not None or not settings.optimizer.thorough:
        found, value = refine(problem, found, settings.seed)
    return found[np.argsort(value, kind="stable")]


class Ends(NamedTuple):
    """Where the cables' ends go."""

    places: Float[np.ndarray, "*samples cables xyz"]  # m; with samples where they move
    fine: bool  # whether they keep what they have to


def plan_ends(
    scenario: Scenario, settings: Settings, path: Float[np.ndarray, "samples xyz"], first: int
) -> Ends:
    """Step 4: ends for a load's path, of least variance where they move, else placed once."""
    if moving(scenario.drive):
        settings.told("leading the ends")
        led = moving_ends(scenario, path, margin=MARGIN)
        return Ends(led.ends, led.feasible)
    assert settings.optimizer is not None
    settings.told("placing ends")
    placement = place_ends(
        with_margins(scenario, moving_ends=True), path, settings.optimizer,
        (settings.seed + first) % 2**32, settings.runs,
        max(LEAST_FOR_ENDS, settings.iterations // 3), settings.population,
    )  # fmt: skip
    return Ends(placement.ends, placement.faults == 0)


def verify(
    scenario: Scenario, settings: Settings, candidates: Iterable[Candidate], way: str = SEARCHED
) -> Iterator[Plan]:
    """Step 5: candidates on real curves, with all checks, until one leaves nothing to wish for."""
    for candidate in candidates:
        found = played(settings, checked(scenario, settings, candidate, way))
        yield found
        if found.feasible:
            return


def checked(
    scenario: Scenario, settings: Settings, candidate: Candidate, way: str = SEARCHED
) -> Plan:
    """A candidate on its real curve, with all checks but the simulation; and whence it came."""
    settings.told("checking")
    x, ends = candidate
    waypoints = np.asarray(x, np.float64).reshape(-1, 3)
    found = laid(scenario, waypoints, ends, settings.samples, settings.wanted)
    path = sample_path(scenario, waypoints, settings.samples)
    beside = ends_beside(scenario, path) if ends is None else ends.reshape(-1, *ends.shape[-2:])
    fitness = fitness_of(scenario, path, beside)
    return with_settings(found, fitness=fitness, way=way, simulated=False)


def played(settings: Settings, found: Plan) -> Plan:
    """The plan with what simulation says of it: a load that does not follow makes it infeasible."""
    if not (settings.simulate and found.feasible):
        return found
    settings.told("simulating")
    if settings.wanted.shortest:
        return followed(found, settings.wanted)
    seen, problems = simulated(found)
    found = replace(found, feasible=not problems, reasons=problems)
    return with_settings(found, **seen_in(seen, found.scenario.frame))
