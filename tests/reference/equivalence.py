"""Do two implementations of one algorithm find equally good minima?  A statistic and functions.

Compared are the medians of log10 of the final fitness over independent runs. Two implementations
count as equivalent if the 90 % confidence interval of the difference of medians lies within half
the interquartile range of the reference, on either side: two one-sided tests at 5 %. Within
that bound the median of one lies among the middle half of the other's runs, so that a single run
hardly tells which of the two made it. Too few runs widen the interval and fail.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

import jaxsusp as js

DIM = 10
POPULATION = 30
OUR_RUNS = 240  # cheap, so that mostly the scatter of the reference is left
RESAMPLES = 10_000


class Function(NamedTuple):
    """A classical function of DIM variables with minimum 0."""

    value: Callable  # (x, xp) -> fitness over the last axis, xp being numpy or jax.numpy
    bound: float  # search range -bound ... bound


@functools.cache  # one problem is one compiled program
def problem_of(function: Function) -> js.Problem:
    """A function as a problem of ours."""
    limit = np.full(DIM, function.bound)
    return js.Problem(lambda x: function.value(x, jnp), -limit, limit)


def our_fitness(function: Function, optimizer: js.Optimizer, iterations: int) -> np.ndarray:
    """Final fitness of our runs."""
    return js.minimize(
        problem_of(function),
        optimizer,
        runs=OUR_RUNS,
        iterations=iterations,
        population=POPULATION,
    ).fitness


def _rosenbrock(x, xp):
    del xp
    ahead, here = x[..., 1:], x[..., :-1]
    return (100 * (ahead - here**2) ** 2 + (1 - here) ** 2).sum(axis=-1)


FUNCTIONS = {
    "sphere": Function(lambda x, xp: (x**2).sum(axis=-1), 5.12),
    "Rosenbrock": Function(_rosenbrock, 2.048),
    "Rastrigin": Function(
        lambda x, xp: (10 + x**2 - 10 * xp.cos(2 * np.pi * x)).sum(axis=-1), 5.12
    ),
}


class Equivalence(NamedTuple):
    """How far apart two samples of log10 fitness are."""

    ours: float  # median
    theirs: float  # median
    low: float  # of the 90 % interval of the difference of medians
    high: float
    bound: float

    @property
    def holds(self) -> bool:
        """Whether the whole interval lies within the bound."""
        return -self.bound < self.low and self.high < self.bound

    def __str__(self) -> str:
        return (
            f"medians of log10 f: ours {self.ours:.3f}, theirs {self.theirs:.3f}, difference"
            f" {self.ours - self.theirs:+.3f} in [{self.low:+.3f}, {self.high:+.3f}],"
            f" bound {self.bound:.3f}"
        )


def compare(ours: np.ndarray, theirs: np.ndarray) -> Equivalence:
    """Compare final fitness values of two implementations, the second being the reference."""
    ours, theirs = np.log10(ours), np.log10(theirs)
    rng = np.random.default_rng(0)

    def medians(sample):
        return np.median(rng.choice(sample, (RESAMPLES, len(sample))), axis=1)

    low, high = np.quantile(medians(ours) - medians(theirs), [0.05, 0.95])
    lower, upper = np.quantile(theirs, [0.25, 0.75])
    return Equivalence(np.median(ours), np.median(theirs), low, high, (upper - lower) / 2)
