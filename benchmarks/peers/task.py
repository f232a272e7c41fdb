"""What all optimisers are given, and what one of them found."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.comparison.workunit import evaluate_exactly
from jaxsusp.problem.problem import Problem, stack_problems
from jaxsusp.problem.suspension import Suspension
from jaxsusp.scenario.scenario import load_scenario


class Task(NamedTuple):
    """One problem, and how long it is searched."""

    problem: Problem  # float32 bounds, as comparisons search
    runs: int
    iterations: int
    population: int

    @classmethod
    def of(cls, scenario: str, runs: int, iterations: int, population: int) -> "Task":
        """The planning task of a scenario as `jaxsusp compare` states it."""
        problem = Problem.from_scenario(load_scenario(scenario), dtype=np.float32)
        return cls(jax.tree.map(jnp.asarray, problem), runs, iterations, population)


class Found(NamedTuple):
    """The best of every run, and how many candidates all of them evaluated."""

    x: np.ndarray  # (R, D)
    evaluations: int


@jax.jit
def fitness_of(problem: Problem, x: jax.Array) -> jax.Array:
    """The batch fitness that every peer minimises: of the admissible points in place of x."""
    return problem.evaluate(problem.repair(x))


class Objective:
    """The fitness for libraries that hold NumPy arrays: it counts, and remembers the best.

    Args:
        problem: what is minimised, with `lower` and `upper` as float64.
    """

    def __init__(self, problem: Problem):
        self._problem, self.evaluations = problem, 0
        self.lower, self.upper = (
            np.asarray(each, float) for each in (problem.lower, problem.upper)
        )
        self.x, self.best = self.lower, np.inf

    def many(self, x: np.ndarray) -> np.ndarray:
        """Fitness of a population, (N, D) to (N,), in one call."""
        value = np.asarray(fitness_of(self._problem, np.asarray(x, np.float32)), float)
        self.evaluations += len(x)
        if value.min() < self.best:
            self.best, self.x = value.min(), np.array(x[value.argmin()])
        return value

    def one(self, x: np.ndarray) -> float:
        """Fitness of one candidate, for libraries that ask for no more at a time."""
        return float(self.many(x[None])[0])


Search = Callable[[Objective, int, Task], None]
"""One run of a peer: minimises an objective from a seed."""


def run_by_run(search: Search) -> Callable[[Task], Found]:
    """All runs one after the other, as libraries of this kind are used."""

    def go(task: Task) -> Found:
        objectives = [Objective(task.problem) for _ in range(task.runs)]
        for seed, objective in enumerate(objectives):
            search(objective, seed, task)
        evaluations = sum(each.evaluations for each in objectives)
        return Found(np.array([each.x for each in objectives]), evaluations)

    return go


class Quality(NamedTuple):
    """What it is worth, by our own fitness in float64."""

    best: float
    mean: float
    clear: int  # runs without contacts and without a violated limit


def quality(task: Task, found: Found) -> Quality:
    """Evaluate what was found anew, whatever its library said of it."""
    inside = np.asarray(_repaired(task.problem, jnp.asarray(found.x, jnp.float32)))
    suspension = stack_problems([jax.tree.map(np.asarray, task.problem)]).fitness
    assert isinstance(suspension, Suspension)
    exact = evaluate_exactly(suspension, inside[None])
    clear = (exact.terms.collisions == 0) & (exact.terms.violations == 0)
    fitness = exact.fitness[0]
    return Quality(float(fitness.min()), float(fitness.mean()), int(clear.sum()))


@jax.jit
def _repaired(problem: Problem, x: jax.Array) -> jax.Array:
    return problem.repair(x)


class Peer(NamedTuple):
    """An optimiser of another library, and the one of ours that it is measured beside."""

    library: str  # as it is installed
    name: str
    ours: str
    go: Callable[[Task], Found]
    single: bool = False  # whether it evaluates one candidate at a time
    compiled: bool = False  # whether all of it is a program, that depends on the sizes
