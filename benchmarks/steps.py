"""What an optimiser's step costs beyond evaluating the fitness."""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array
from jaxsusp.optim.base import Best, NoInfo, Optimizer, best_of, better
from jaxsusp.optim.loop import evaluation_sizes
from jaxsusp.problem.problem import Problem


class Candidates(NamedTuple):
    """A population that is only evaluated."""

    x: Array
    best: Best


def evaluations_only(optimizer: Optimizer, problem: Problem, population: int) -> Optimizer:
    """An optimiser that evaluates as many candidates, in the same portions, and does nothing else.

    Its time is the share of the fitness in the time of `optimizer`.
    """
    sizes = evaluation_sizes(optimizer, problem, population).step

    def init(key, problem: Problem, population: int, iterations) -> Candidates:
        del iterations
        x = problem.sample(key, population)
        return Candidates(x, best_of(x, problem.evaluate(x)))

    def step(key, problem: Problem, state: Candidates):
        best = state.best
        for i, size in enumerate(sizes):
            x = state.x[:size] * (1 - 1e-6 * i)  # another population each time: none is shared
            best = better(best_of(x, problem.evaluate(x)), best)
        return Candidates(jnp.roll(state.x, 1, axis=1), best), NoInfo()

    return Optimizer(f"evaluations-only-{optimizer.name}", jax.tree_util.Partial(init), step)
