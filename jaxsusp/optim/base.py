"""The contract of a population optimiser.

An optimiser is a pair of pure functions:

    init(key, problem, population, iterations) -> state
    step(key, problem, state)                  -> state, info

`state` is what the next step needs and carries at least `best`; `info` is what a reader of the run
needs: a NamedTuple of scalars that the driver averages over the iterations (empty if there is
nothing to tell). All fitness values go through `problem.evaluate`, which ranks NaN as +inf, and
every candidate through `problem.repair` first.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, TypeVar

import jax
import jax.numpy as jnp
from jax.tree_util import Partial

from jaxsusp._types import Array, Float, Int
from jaxsusp.errors import require_known


class Best(NamedTuple):
    """The best candidate so far."""

    x: Float[Array, "dim"]
    fitness: Float[Array, ""]


class State(Protocol):
    """What the driver reads of an optimiser's state."""

    @property
    def best(self) -> Best:
        """The best candidate so far."""
        ...


class NoInfo(NamedTuple):
    """Nothing to tell beyond the state."""


class Clock(NamedTuple):
    """Which iteration is next, out of how many."""

    iteration: Int[Array, ""]  # t = 1 … T
    horizon: Int[Array, ""]  # T

    @classmethod
    def start(cls, iterations) -> "Clock":
        """T = 1."""
        return cls(jnp.asarray(1, jnp.int32), jnp.asarray(iterations, jnp.int32))

    def tick(self) -> "Clock":
        """The clock of the next iteration."""
        return self._replace(iteration=self.iteration + 1)

    def fraction(self, dtype) -> Float[Array, ""]:
        """T / T."""
        return self.iteration.astype(dtype) / self.horizon.astype(dtype)


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Optimizer:
    """A named pair (init, step).

    Coefficients given as leaves of `Partial` are arguments of the compiled program, so that
    changing one, or calling a factory twice, compiles nothing anew.
    """

    name: str = field(metadata={"static": True})
    init: Callable[..., State]
    step: Callable[..., tuple[State, Any]]
    thorough: bool = field(default=False, metadata={"static": True})
    """Whether it ends at an optimum of its own accord: nothing is left to refine then."""

    def __post_init__(self):
        for part in ("init", "step"):
            function = getattr(self, part)
            if callable(function) and jax.tree_util.all_leaves([function]):
                object.__setattr__(self, part, Partial(function))


_T = TypeVar("_T")


def chosen_of(algorithm: str, kind: type[_T], given: Mapping[str, Any]) -> _T:
    """Coefficients of an algorithm, the default of each that is not given.

    Args:
        algorithm: its name, for the message.
        kind: the named tuple of all of them.
        given: those that a person chose.

    Raises:
        InputError: one that there is not.
    """
    for name in given:
        require_known(f"coefficient of {algorithm}", name, getattr(kind, "_fields", ()))
    return kind(**given)


def best_of(x: Float[Array, "pop dim"], fitness: Float[Array, "pop"]) -> Best:
    """The fittest member of a population."""
    i = jnp.argmin(fitness)
    return Best(x[i], fitness[i])


def better(challenger: Best, champion: Best) -> Best:
    """The challenger if strictly better, else the champion."""
    wins = challenger.fitness < champion.fitness
    return Best(
        jnp.where(wins, challenger.x, champion.x),
        jnp.where(wins, challenger.fitness, champion.fitness),
    )
