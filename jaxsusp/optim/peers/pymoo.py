"""Single-objective algorithms of pymoo, advanced on the host.

They have pymoo's defaults but for the population, and for what keeps the number of candidates the
same in every turn: offspring that are duplicates stay, and CMA-ES goes on with a fresh start of
equal size where it has converged. pymoo is told the points that were evaluated in place of its
candidates; its CMA-ES learns from its own all the same.
"""

# pyright: reportMissingImports=false
import math
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np
from jax.tree_util import Partial
from pymoo.core.algorithm import Algorithm
from pymoo.core.problem import Problem
from pymoo.core.termination import NoTermination

from jaxsusp._types import Float
from jaxsusp.errors import require_count, require_known
from jaxsusp.optim.base import HostOptimizer, HostSearch
from jaxsusp.optim.host import Aside


class Row(NamedTuple):
    """An algorithm of pymoo, and what it is asked for."""

    module: str  # in pymoo.algorithms.soo.nonconvex
    what: str
    options: Callable[[int], dict[str, Any]]  # of the population
    least: int = 2  # population
    aside: bool = False  # whether it draws from generators that all share


def _plain(population: int) -> dict[str, Any]:
    return {"pop_size": population}


ALGORITHMS = {
    "CMAES": Row(
        "cmaes",
        "CMA-ES, pycma's",
        lambda population: {"pop_size": population, "restarts": _ALWAYS, "incpopsize": 1},
        aside=True,
    ),
    "DE": Row("de", "Differential evolution, best/1/bin", _plain, least=4),
    "ES": Row(
        "es",
        "Evolution strategy, one parent for seven offspring",
        lambda population: {"n_offsprings": population, "pop_size": math.ceil(population / 7)},
        least=14,
    ),
    "GA": Row(
        "ga",
        "Genetic algorithm, simulated binary crossover",
        lambda population: {"pop_size": population, "eliminate_duplicates": False},
    ),
    "PSO": Row("pso", "Particle swarm, fuzzy adaptive", _plain),
}
"""Those that search continuous variables and ask for equally many candidates in every turn."""

_ALWAYS = 10**9


def names() -> list[str]:
    """The names of those that are here."""
    return sorted(ALGORITHMS)


def describe(name: str) -> str:
    """One line about an algorithm."""
    return ALGORITHMS[name].what


def make(name: str, **options: Any) -> HostOptimizer:
    """An algorithm of pymoo.

    Args:
        name: its class there, such as "GA".
        **options: any numbers that the class takes.

    Returns:
        The optimiser named "pymoo:" and that.

    Raises:
        InputError: a name that is not in `ALGORITHMS`.
    """
    require_known("algorithm of pymoo", name, ALGORITHMS)
    begin = Partial(_begin, name, options)
    return HostOptimizer(f"pymoo:{name}", begin, origin=f"pymoo {version('pymoo')}")


class Search:
    """One run: pymoo's ask and tell.

    Args:
        algorithm: what searches.
        seed: of its generator.
        lower: lower bounds.
        upper: upper bounds.
    """

    def __init__(
        self,
        algorithm: Algorithm,
        seed: int,
        lower: Float[np.ndarray, "dim"],
        upper: Float[np.ndarray, "dim"],
    ):
        problem = Problem(n_var=len(lower), n_obj=1, xl=lower, xu=upper)
        self._algorithm = algorithm.setup(problem, seed=seed, termination=NoTermination())
        self._asked: Any = None

    def ask(self) -> Float[np.ndarray, "pop dim"]:
        """The next candidates."""
        self._asked = self._algorithm.ask()
        return self._asked.get("X").astype(np.float64)

    def tell(self, x: Float[np.ndarray, "pop dim"], fitness: Float[np.ndarray, "pop"]) -> None:
        """Their fitness."""
        self._asked.set("X", x)
        self._asked.set("F", fitness[:, None])
        self._algorithm.tell(infills=self._asked)


def _begin(
    name: str,
    options: dict[str, Any],
    seed: int,
    lower: Float[np.ndarray, "dim"],
    upper: Float[np.ndarray, "dim"],
    population: int,
    iterations: int,
) -> HostSearch:
    del iterations
    row = ALGORITHMS[name]
    require_count(f"population of pymoo:{name}", population, row.least)
    kind = getattr(import_module(f"pymoo.algorithms.soo.nonconvex.{row.module}"), name)

    def search() -> HostSearch:
        return Search(kind(**row.options(population) | options), seed, lower, upper)

    return Aside(seed, search) if row.aside else search()
