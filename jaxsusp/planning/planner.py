"""`js.plan`: the loop of Fig. 2, from a task to a verified plan.

The steps are in `steps`, the third of them in `strategies`. Where nothing stands that they give,
they are taken again: with further runs, then other ends, then more waypoints.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from jaxsusp.errors import (
    InputError,
    require,
    require_count,
    require_counts,
    require_known,
    require_seed,
)
from jaxsusp.mechanics.drives import moving
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.choices import require_algorithm
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.planning.choices import COORDINATIONS, ENDS, SHORTEST, TAUT
from jaxsusp.planning.feasibility import require_possible
from jaxsusp.planning.motion.wanted import as_wanted
from jaxsusp.planning.plan import Plan
from jaxsusp.planning.ranking import rank, with_settings
from jaxsusp.planning.refusal import explained, require_way, unhurried, why_not
from jaxsusp.planning.steps import Settings, foresee
from jaxsusp.planning.strategies import Attempt, coordinate
from jaxsusp.problem.choices import SEARCHES
from jaxsusp.problem.hardturns import PRICE
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario
from jaxsusp.scenario.scope import require_rule

MORE_WAYPOINTS = 2

DEARER = 4.0
"""By how much the price on hard turns grows with every attempt: calmer ways are followed better."""

MOST_LED = 4
"""Robots whose ends least variance leads: joint candidates grow with their number as a power."""


class Event(NamedTuple):
    """What a progress callback is told."""

    phase: str  # "mapping the free space", "searching", "placing ends", "checking", …
    attempt: int  # from 0
    attempts: int  # at most


def plan(
    scenario: Scenario | Named,
    algorithm: str | AnyOptimizer = "routed",
    ends: str = "given",
    runs: int = 4,
    iterations: int = 300,
    retries: int = 3,
    seed: int = 0,
    *,
    population: int = 90,
    waypoints: int = 5,
    samples: int = 40,
    search: str = SEARCHES[0],
    coordination: str = "alternation",
    simulate: bool = True,
    duration: str | int | float | None = None,
    calm: bool = False,
    progress: Callable[[Event], None] | None = None,
) -> Plan:
    """Plan a task, and verify it on the real curve.

    What the search finds, with a price on hard turns, is refined locally where the algorithm
    leaves something to refine, laid on a smooth path, driven from rest to rest and checked against
    all of Eq. 22 and in continuous time. Where none of it stands, the planner tries again: with
    further runs, then other ends (where they are placed), then more waypoints, each time with twice
    as many runs and dearer turns. A plan that breaks a limit, or that a swinging load does not
    follow in simulation, is never returned as feasible.

    Args:
        scenario: the task, or its name or file.
        algorithm: what searches, a name or an optimiser; "taut" takes the taut ways through the
            free space as they are, which are tried first in any case where ends are given.
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
        search: rule that keeps waypoints inside: "free-space", "ellipsoid" or "box".
        coordination: of placed ends with the load: "alternation" or "joint" (D = 3m + 2K + 1).
        simulate: whether plans are played in simulation and have to follow; where not,
            `settings["simulated"]` says so; of those that are, the settings hold how closely the
            load follows (`tracking_error_m`, `tension_error`).
        duration: seconds from rest to rest, default the scenario's; or "shortest": the law along
            the path is then as fast as limits allow, and as a swinging load follows where plans are
            played. The search is in the scenario's duration in any case.
        calm: whether the law is shaped so that the load does not swing on at the goal.
        progress: called when something begins, see `Event`.

    Returns:
        A feasible `Plan`, or the best attempt marked infeasible with the reasons; the first of
        them is what `why_not` says, or the limit that leaves no law on its path.

    Raises:
        ImpossibleTaskError: no tensions within limits can hold the load, or it is proved that no
            way exists; told before any search.
        InputError: bad settings, a system that planning does not cover, or no taut way where
            nothing else is to be tried.
    """
    stated, wanted = as_wanted(load_scenario(scenario), duration, calm, simulate)
    scenario = stated.own
    require_rule(scenario)
    if isinstance(algorithm, str):
        require_algorithm(algorithm, [TAUT])
    settings = Settings(
        None if algorithm == TAUT else algorithm_of(algorithm), ends, coordination, runs,
        iterations, population, seed, samples, search, simulate, wanted,
    )  # fmt: skip
    _require_sense(scenario, settings)
    require_count("waypoints", waypoints)
    require_count("retries", retries, least=0)
    retries = retries if settings.optimizer else 0  # there is no luck in taut ways
    foresee(scenario, settings, waypoints)
    require_possible(scenario, ends)
    require_way(scenario, ends)
    tally, made = _Tally(), 0
    for attempt in _attempts(retries, waypoints, ends):

        def told(phase: str, attempt=attempt) -> None:
            if progress is not None:
                progress(Event(phase, attempt.number, retries + 1))

        made += 1
        price = PRICE * DEARER**attempt.number
        this = settings._replace(told=told, price=price)
        for batch in range(attempt.batches):
            first = tally.take(runs)
            tally.note(coordinate(scenario, this, attempt, first, batch))
            if tally.done:
                break
        if tally.done:
            break
    if tally.best is None:
        raise InputError(
            f'{why_not(scenario, ends).text}; algorithm = "{TAUT}" finds no way through regions of '
            "the free space here; give one that searches"
        )
    asked = settings._asdict()
    del asked["told"], asked["price"], asked["simulate"], asked["wanted"]
    optimizer = asked.pop("optimizer")
    asked["algorithm"] = TAUT if optimizer is None else optimizer.name
    if wanted.shortest or wanted.calm:
        asked |= {"duration": SHORTEST if wanted.shortest else stated.task.duration, "calm": calm}
    best = tally.best if wanted.shortest else unhurried(tally.best)
    best = (explained(best, ends) if best is tally.best else best).stated(stated)
    return with_settings(best, **asked, retries=retries, attempts=made, runs_made=tally.runs)


def _require_sense(scenario: Scenario, settings: Settings) -> None:
    """Refuse settings that cannot be, or that do not go with the scenario."""
    require_counts(
        runs=settings.runs, iterations=settings.iterations, population=settings.population
    )
    require_count("samples", settings.samples, least=3)
    require_seed(settings.seed)
    require_known("ends", settings.ends, ENDS)
    require_known("coordination", settings.coordination, COORDINATIONS)
    require_known("search", settings.search, SEARCHES)
    given, moves = settings.ends == "given", moving(scenario.drive)
    require(
        settings.optimizer is not None or (given and settings.search != "box"),
        f'algorithm = "{TAUT}" goes through the free space below the ends that are there; give '
        'ends = "given" and search = "free-space" with it, or another algorithm',
    )
    require(
        settings.coordination == "alternation" or not (given or moves),
        'coordination = "joint" places ends that stay; give ends = "placed" and drive = "cable" '
        "with it",
    )
    require(
        given or not moves or scenario.payload.attachments == "hook",
        'ends = "placed" leads moving ends of a hook alone: with separate payload.attachments '
        'they hold the load level; give ends = "given"',
    )
    require(
        given or not moves or len(scenario.robots) <= MOST_LED,
        f'ends = "placed" leads the moving ends of at most {MOST_LED} robots, got '
        f"{len(scenario.robots)}: tensions couple the cables, and fans of 9 ends each are "
        f'9^{len(scenario.robots)} choices a step; give ends = "given"',
    )


def _attempts(retries: int, waypoints: int, ends: str) -> Iterator[Attempt]:
    """The task as asked; then other seeds, other ends, more waypoints, in turn."""
    for number in range(retries + 1):
        more = number // 3 * MORE_WAYPOINTS if number else 0
        fresh = ends == "placed" and number % 3 == 2
        yield Attempt(number, 2**number, waypoints + more, fresh)


class _Tally:
    """The best plan so far, and how many runs have been used: no run is made twice."""

    def __init__(self):
        self.best: Plan | None = None
        self.runs = 0

    def take(self, runs: int) -> int:
        """First of so many further run indices."""
        first, self.runs = self.runs, self.runs + runs
        return first

    def note(self, tries: Iterator[Plan]) -> None:
        """Keep the best: feasible before infeasible, then by fitness; the first of equals."""
        for found in tries:
            if self.best is None or rank(found) < rank(self.best):
                self.best = found

    @property
    def done(self) -> bool:
        """Whether there is nothing left to wish for."""
        return self.best is not None and self.best.feasible
