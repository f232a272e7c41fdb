"""The contract of a population optimiser.

An optimiser is a pair of pure functions:

    init(key, problem, population, iterations) -> state
    step(key, problem, state)                  -> state, info

`state` is what the next step needs and carries at least `best`; `info` is what a reader of the run
needs: a NamedTuple of scalars that the driver averages over the iterations (empty if there is
nothing to tell). All fitness values go through `problem.evaluate`, which ranks NaN as +inf, and
every candidate through `problem.repair` first.

A search that cannot be part of a compiled program, because a library keeps it in NumPy, is the
second kind, `HostOptimizer`: it asks for the fitness of candidates, and is told.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol, TypeVar, runtime_checkable

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxsusp._types import Array, Float, Int
from jaxsusp.errors import require, require_known


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
    origin: str = field(default="", metadata={"static": True})
    """Of an algorithm of another library: what it is from, with the version."""

    def __post_init__(self):
        _hold_partials(self, "init", "step")


@runtime_checkable
class HostSearch(Protocol):
    """One run of a search on the host. It asks, is told, and asks again."""

    def ask(self) -> Float[np.ndarray, "pop dim"]:
        """The next candidates, anywhere, as many as in every earlier turn but the first."""
        ...

    def tell(self, x: Float[np.ndarray, "pop dim"], fitness: Float[np.ndarray, "pop"]) -> None:
        """Their fitness, at the admissible points that were evaluated in their place."""
        ...


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class HostOptimizer:
    """A named search that lives in NumPy: ask and tell in place of init and step.

    `begin(seed, lower, upper, population, iterations)` begins one run, a `HostSearch`. Its first
    candidates are the initial population, those of every further turn an iteration; `seed` is a
    number below 2**31, `lower` and `upper` are float64. Runs are advanced side by side: one that
    draws from a generator that all share gives it back as it was, see `optim.host.Aside`.
    Coefficients are leaves of `Partial`.
    """

    name: str = field(metadata={"static": True})
    begin: Callable[..., HostSearch]
    thorough: bool = field(default=False, metadata={"static": True})
    origin: str = field(default="", metadata={"static": True})

    def __post_init__(self):
        _hold_partials(self, "begin")


AnyOptimizer = Optimizer | HostOptimizer
"""What a batch, and all that is made of batches, takes."""


def require_compiled(optimizer: AnyOptimizer) -> None:
    """Refuse a search on the host where a whole run has to be one compiled program.

    Raises:
        InputError: names it.
    """
    require(
        isinstance(optimizer, Optimizer),
        f'algorithm = "{optimizer.name}" is advanced on the host, here runs are compiled whole; '
        "give one of ours or of evosax",
    )


def _hold_partials(optimizer: AnyOptimizer, *parts: str) -> None:
    """Make pytrees of its plain functions."""
    for part in parts:
        function = getattr(optimizer, part)
        if callable(function) and jax.tree_util.all_leaves([function]):
            object.__setattr__(optimizer, part, Partial(function))


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
