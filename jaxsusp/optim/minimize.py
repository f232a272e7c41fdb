"""Minimise any problem with any optimiser: several independent runs as one array program."""

from typing import Any, NamedTuple

import jax
import numpy as np

from jaxsusp._types import Float
from jaxsusp.errors import require_counts, require_seed
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.optim.polish import EVALUATIONS, polish_batch
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import Problem, stack_problems


class Result(NamedTuple):
    """What independent runs found; host arrays in the dtype of the problem's bounds."""

    x: Float[np.ndarray, "runs dim"]
    fitness: Float[np.ndarray, "runs"]
    history: Float[np.ndarray, "runs iterations"]  # best so far after each iteration
    evaluations: int  # fitness evaluations per run
    info: Any = ()  # what the optimiser tells of itself, averaged over iterations, each (runs,)

    def __repr__(self) -> str:
        runs, dim = self.x.shape
        return (
            f"<Result: {runs} run{'s' * (runs > 1)}, {dim} variables, {self.evaluations} "
            f"evaluations each; best fitness {self.fitness.min():.6g}>"
        )

    @property
    def best(self) -> Float[np.ndarray, "dim"]:
        """The decision vector of the best run."""
        return self.x[self.fitness.argmin()]


def minimize(
    problem: Problem,
    optimizer: AnyOptimizer | str,
    seed: int = 0,
    runs: int = 20,
    iterations: int = 500,
    population: int = 30,
    polish: bool = False,
) -> Result:
    """Minimise a problem, in the dtype of its bounds.

    Args:
        problem: what to minimise.
        optimizer: what minimises it, or its name.
        seed: root of all randomness; run i depends on seed, the optimiser's name and i alone.
        runs: number of independent runs.
        iterations: iterations per run.
        population: candidates per iteration.
        polish: whether the best of every run is improved along a gradient at the end, see
            `optim.polish`. `evaluations` counts it; `history` ends before it.

    Returns:
        A `Result` with runs on the leading axis.

    Raises:
        InputError: a count below 1, an unknown name, or a population too small for the algorithm.
    """
    require_counts(runs=runs, iterations=iterations, population=population)
    require_seed(seed)
    optimizer = algorithm(optimizer)
    stacked = stack_problems([problem])
    outcome = run_batch(stacked, optimizer, seed, range(runs), iterations, population)
    evaluations = count_evaluations(optimizer, problem, population).total(iterations)
    if polish:
        outcome, evaluations = polish_batch(stacked, outcome), evaluations + EVALUATIONS
    return Result(
        outcome.x[0],
        outcome.fitness[0],
        outcome.history[0],
        evaluations,
        jax.tree.map(lambda leaf: leaf[0], outcome.info),
    )
