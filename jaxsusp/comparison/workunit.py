"""The unit of a comparison: one algorithm, some runs, all scenarios of one static shape.

A unit is one compiled program, and what is saved and resumed. The search runs in float32; every
number that is reported is re-evaluated in float64.
"""

import json
from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

from jaxsusp.comparison import dataset
from jaxsusp.comparison.bestknown import best_known
from jaxsusp.errors import InputError
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.batch import run_batch, time_iteration
from jaxsusp.optim.devices import instruction_set
from jaxsusp.optim.loop import Evaluations, count_evaluations, require_begun
from jaxsusp.optim.outcome import Outcome
from jaxsusp.optim.polish import EVALUATIONS, polish_batch
from jaxsusp.problem.fitness import FitnessTerms, curvature, trajectory
from jaxsusp.problem.problem import Problem, stack_problems
from jaxsusp.problem.suspension import Suspension
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import build_world, load_of, obstacle_counts
from jaxsusp.vec3 import Vec3


class Group(NamedTuple):
    """Scenarios of one static shape and their stacked problem (float32 bounds)."""

    scenarios: tuple[Scenario, ...]
    problems: Problem

    @property
    def names(self) -> list[str]:
        """Names of the scenarios."""
        return [scenario.name for scenario in self.scenarios]

    @property
    def first(self) -> Problem:
        """The problem of the first scenario alone."""
        return jax.tree.map(lambda leaf: np.asarray(leaf[0]), self.problems)


def stack_scenarios(
    scenarios: Sequence[Scenario],
    waypoints: int,
    samples: int,
    search: str,
    told: Callable[[Scenario], None] | None = None,
) -> list[Group]:
    """Group scenarios by static shape, pad obstacles and regions to common counts, and stack.

    Args:
        scenarios: what to group.
        waypoints: m of every problem.
        samples: n of every problem.
        search: rule that keeps waypoints inside; all but "box" need the free space, which takes
            seconds where it is not in the cache.
        told: called with a scenario before its problem is made.
    """
    groups: dict[tuple, list[Scenario]] = {}
    for scenario in scenarios:
        hook = scenario.payload.attachments == "hook"
        shape = (len(scenario.robots), hook, scenario.drive, load_of(scenario) is None)
        groups.setdefault(shape, []).append(scenario)

    def stack(members: list[Scenario]) -> Group:
        counts = obstacle_counts([member.own for member in members])
        with_stability = any(member.limits.stability > 0 for member in members)

        def problem(member: Scenario) -> Problem:
            if told is not None:
                told(member)
            return Problem.from_scenario(
                member,
                waypoints,
                samples,
                search,
                dtype=np.float32,
                world=build_world(member.own, counts),
                with_stability=with_stability,
            )

        problems = [problem(member) for member in members]
        return Group(tuple(members), stack_problems(problems))

    return [stack(members) for members in groups.values()]


class Unit(NamedTuple):
    """One algorithm on one group of scenarios."""

    group: Group
    optimizer: AnyOptimizer
    iterations: int
    population: int
    per_run: Evaluations
    polish: bool = False
    asked: int = 0  # iterations that were asked for; a budget of evaluations can leave fewer

    @classmethod
    def plan(
        cls,
        group: Group,
        optimizer: AnyOptimizer,
        iterations: int,
        population: int,
        budget: str,
        polish: bool = False,
    ) -> "Unit":
        """Decide the iterations: as asked, or as many as the common budget of evaluations allows.

        What polishing costs is equal for all and comes on top.

        Raises:
            InputError: the budget does not allow one iteration.
        """
        per_run, asked = count_evaluations(optimizer, group.first, population), iterations
        if budget == "evaluations":
            allowed = population * (iterations + 1)
            if per_run.total(1) > allowed:
                raise InputError(
                    f"iterations = {iterations}: {optimizer.name} needs {per_run.total(1)} "
                    f"evaluations for one iteration and the budget is {allowed}; give more "
                    'iterations or budget = "iterations"'
                )
            iterations = per_run.affordable(allowed)
        return cls(group, optimizer, iterations, population, per_run, polish, asked)

    def require_begun(self) -> None:
        """Refuse a unit that its algorithm would refuse only when its turn has come.

        Raises:
            InputError: too few iterations, or too small a population.
        """
        try:
            require_begun(self.optimizer, self.group.first, self.population, self.iterations)
        except InputError as error:
            if self.iterations >= self.asked:
                raise
            more = self.asked - self.iterations
            raise InputError(
                f"{error}; of the {self.asked} asked for, the common budget of evaluations "
                f"leaves {self.optimizer.name} {self.iterations}: ask for {more} more"
            ) from None

    @property
    def evaluations(self) -> int:
        """Fitness evaluations of a whole run."""
        return self.per_run.total(self.iterations) + self._after

    @property
    def _room(self) -> int:
        """Iterations asked for, or twice, four times, … as many: budgets share a program."""
        room = max(1, self.asked)
        while room < self.iterations:
            room *= 2
        return room

    @property
    def _after(self) -> int:
        return EVALUATIONS if self.polish else 0

    def cost(self, runs: int) -> int:
        """Fitness evaluations of so many runs on all scenarios of the group."""
        return runs * len(self.group.scenarios) * self.evaluations

    def missing(self, runs: int, finished: Sequence[xr.Dataset]) -> list[int]:
        """Which of the first so many runs are in none of the finished datasets."""
        there: set[int] = set()
        for ds in finished:
            labels = {"scenario": self.group.names, "algorithm": [self.optimizer.name]}
            found = ds["fitness"].reindex(labels).notnull().all(tuple(labels))
            there.update(ds["run"].values[found.values].tolist())
        return [run for run in range(runs) if run not in there]

    def time_iteration(self, seed: int, runs: int) -> float:
        """Seconds that one iteration of so many runs on all scenarios of the group takes."""
        return time_iteration(
            self.group.problems,
            self.optimizer,
            seed,
            range(runs),
            self.iterations,
            self.population,
            self._room,
        )

    def compute(
        self,
        seed: int,
        runs: Sequence[int],
        lanes: int = 0,
        most_kept: int | None = None,
        report: Callable[[int], None] | None = None,
    ) -> xr.Dataset:
        """Run it and describe the outcome.

        Args:
            seed: root of all randomness.
            runs: indices of the runs.
            lanes: see `run_batch`.
            most_kept: iterations of every history that are kept, evenly spaced; None: all.
            report: called with the number of finished iterations.
        """
        outcome = run_batch(
            self.group.problems,
            self.optimizer,
            seed,
            runs,
            self.iterations,
            self.population,
            report,
            self._room,
            lanes,
        )
        if self.polish:
            outcome = polish_batch(self.group.problems, outcome)
        found = self._describe(outcome, runs, dataset.thinned(self.iterations, most_kept))
        return found.assign_attrs({dataset.PROCESSORS: json.dumps([instruction_set()])})

    def _describe(self, outcome: Outcome, runs: Sequence[int], kept: Sequence[int]) -> xr.Dataset:
        suspension = self.group.problems.fitness
        assert isinstance(suspension, Suspension)
        found = evaluate_exactly(suspension, outcome.x)
        frames = [scenario.units for scenario in self.group.scenarios]
        nothing = np.full(outcome.fitness.shape, np.nan)
        size = outcome.x.shape[-1] // 3, suspension.samples
        known = [best_known(scenario, *size) for scenario in self.group.scenarios]
        per_run = {
            "fitness": found.fitness,
            "terms": np.stack(
                [_in_si(found.terms, name, frames) for name in dataset.TERMS], axis=-1
            ),
            "collisions": found.terms.collisions,
            "violations": found.terms.violations,
            "x": _places(outcome.x, frames),
            "history": outcome.history[..., np.asarray(kept) - 1],
            "history_best": outcome.history[range(len(frames)), found.fitness.argmin(axis=1)],
            "stability_acted": getattr(outcome.info, "acted", nothing),
            "stability_kept": getattr(outcome.info, "kept", nothing),
            "position": _places(found.position, frames),
            "curvature_radius": [
                frame.number(radius, "m")
                for frame, radius in zip(frames, found.curvature_radius, strict=True)
            ],
        }
        per_run |= {
            name: np.full(len(self.group.names), count)
            for name, count in (
                ("evaluations", self.evaluations),
                ("evaluations_initial", self.per_run.initial),
                ("evaluations_polish", self._after),
            )
        }
        values = {name: np.expand_dims(value, 1) for name, value in per_run.items()}
        values |= {
            "obstacles": np.array([len(each.obstacles) for each in self.group.scenarios]),
            "unit_length": np.array([frame.length for frame in frames]),
            "unit_mass": np.array([frame.mass for frame in frames]),
            "best_known": np.array(known, np.float64),
            "iterations": np.array([self.iterations]),
            "seconds_run": np.array([outcome.seconds_run]),
            "seconds_compile": np.array([outcome.seconds_compile]),
        }
        return dataset.assemble(
            {
                "scenario": self.group.names,
                "algorithm": [self.optimizer.name],
                "run": list(runs),
                "iteration": kept,
                "step": range(1, self.iterations + 1),
                "variable": range(outcome.x.shape[-1]),
                "sample": range(suspension.samples),
            },
            values,
        )


def _places(rows: np.ndarray, frames: Sequence[Frame]) -> np.ndarray:
    """Numbers (x1, y1, z1, x2, …) of several scenarios as places in the world (m)."""
    each = zip(frames, np.asarray(rows, np.float64), strict=True)
    found = [frame.place(row.reshape(*row.shape[:-1], -1, 3)) for frame, row in each]
    return np.stack(found).reshape(rows.shape)


def _in_si(terms: FitnessTerms, name: str, frames: Sequence[Frame]) -> np.ndarray:
    """A term of runs on several scenarios, formed in their own units, in SI units (S, R)."""
    factors = np.array([frame.factor(FitnessTerms.unit(name)) for frame in frames])
    return getattr(terms, name) * factors[:, None]


class Exact(NamedTuple):
    """Re-evaluation in float64; host arrays."""

    fitness: np.ndarray  # (S, R), +inf where it is not finite
    terms: FitnessTerms  # each (S, R)
    position: np.ndarray  # (S, n, 3), best run
    curvature_radius: np.ndarray  # (S,), best run


def evaluate_exactly(suspension: Suspension, x: np.ndarray) -> Exact:
    """Evaluate decision vectors (S, R, D) of stacked scenarios in float64."""
    with jax.enable_x64(True):
        terms = jax.tree.map(np.asarray, _terms(suspension, jnp.asarray(x, jnp.float64)))
        fitness = np.where(np.isfinite(terms.total), terms.total, np.inf)
        best = x[np.arange(len(x)), fitness.argmin(axis=1)]
        position, bends = _best_trajectory(suspension, jnp.asarray(best, jnp.float64))
        radius = 1 / np.maximum(np.asarray(bends), np.finfo(np.float64).tiny)
        return Exact(fitness, terms, np.asarray(position), np.median(radius, axis=1))


TOGETHER = 8
"""Runs that are re-evaluated at a time: always so many, so that a run's last digits do not depend
on how many share its chunk."""


@jax.jit
def _terms(suspension: Suspension, x) -> FitnessTerms:
    """Terms (S, R) of decision vectors (S, R, D)."""
    runs = x.shape[1]
    padded = jnp.concatenate([x, jnp.repeat(x[:, -1:], -runs % TOGETHER, axis=1)], axis=1)
    blocks = jnp.moveaxis(padded.reshape(len(x), -1, TOGETHER, x.shape[2]), 1, 0)

    def one_block(block) -> FitnessTerms:
        return jax.vmap(lambda suspension, x: suspension.terms(x.T))(suspension, block)

    terms = jax.lax.map(one_block, blocks)  # (blocks, S, TOGETHER)
    return jax.tree.map(lambda leaf: jnp.moveaxis(leaf, 0, 1).reshape(len(x), -1)[:, :runs], terms)


@jax.jit
def _best_trajectory(suspension: Suspension, x):
    def one(suspension: Suspension, x):
        position = trajectory(suspension.world, x, suspension.samples)
        step = Vec3(*(component[1:] - component[:-1] for component in position))
        return position.to_array(), curvature(step)

    return jax.vmap(one)(suspension, x)
