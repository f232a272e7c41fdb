"""A search on the host: it steps about its best point, out of the bounds too."""

import numpy as np
from jax.tree_util import Partial

from jaxsusp.optim.base import HostOptimizer
from jaxsusp.optim.host import Aside

SIZES = {"iterations": 12, "population": 6}


def paraboloid(x):
    return ((x - 0.7) ** 2).sum()


class Walk:
    def __init__(self, length, seed, lower, upper, population, iterations):
        assert seed < 2**31
        assert lower.dtype == upper.dtype == np.float64
        self.rng, self.length = np.random.default_rng(seed), length
        self.lower, self.upper, self.population = lower, upper, population
        self.best, self.least, self.turns = None, np.inf, 0

    def ask(self):
        if self.best is None:
            count = self.population + 3
            return self.lower + (self.upper - self.lower) * self.rng.random(
                (count, len(self.lower))
            )
        return self.best + self.length * self.rng.normal(size=(self.population, len(self.lower)))

    def tell(self, x, fitness):
        assert x.dtype == fitness.dtype == np.float64
        assert ((self.lower <= x) & (x <= self.upper)).all(), "what is told is admissible"
        if self.best is None or fitness.min() < self.least:
            self.best, self.least = x[fitness.argmin()], fitness.min()


def walk(length=0.5, name="walk"):
    return HostOptimizer(name, Partial(Walk, length))


class Shared(Walk):
    """The same, with the generator that all share."""

    def __init__(self, *arguments):
        super().__init__(0.5, *arguments)
        self.rng = np.random.mtrand._rand  # what `numpy.random.random` draws from


def shared():
    def begin(seed, *arguments):
        return Aside(seed, lambda: Shared(seed, *arguments))

    return HostOptimizer("shared", begin)
