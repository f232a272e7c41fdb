"""Searches on the host, all of a batch side by side: the driver of the second kind of optimiser.

Libraries that keep a search in NumPy cannot be part of a compiled program, but what costs time, the
fitness, can: what all runs on all scenarios ask for in one turn is repaired and evaluated by one
call of one program. Seeds derive from (seed, name, run) as the keys of `optim.loop` do, and a run
meets no other, so that it is the same in whatever batch it is computed.
"""

import itertools
import random
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.optim.base import HostOptimizer, HostSearch, NoInfo
from jaxsusp.optim.loop import begin_on_host, evaluation_sizes, run_key
from jaxsusp.optim.outcome import Outcome
from jaxsusp.problem.problem import Problem

Evaluate = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Candidates (S, M, D) to the admissible points in their place, and their fitness (S, M)."""


class HostBatch:
    """Runs × scenarios of a search on the host, advanced turn by turn.

    Args:
        optimizer: what searches.
        problems: stacked problems.
        evaluate: their fitness; every call is of one shape, so that it is compiled once.
        seed: root of all randomness.
        runs: indices of the runs.
        population: number N of candidates.
        iterations: number T of iterations that will be made.
    """

    def __init__(
        self,
        optimizer: HostOptimizer,
        problems: Problem,
        evaluate: Evaluate,
        seed: int,
        runs: Sequence[int],
        population: int,
        iterations: int,
    ):
        (scenarios, dim), dtype = problems.lower.shape, problems.lower.dtype
        each = [jax.tree.map(lambda leaf, s=s: leaf[s], problems) for s in range(scenarios)]
        seeds = [seed_of(seed, optimizer.name, run) for run in runs]
        self.name = optimizer.name
        self._searches: list[list[HostSearch]] = [
            [begin_on_host(optimizer, problem, seed, population, iterations) for seed in seeds]
            for problem in each
        ]
        (self._first,), (self._further,) = evaluation_sizes(optimizer, each[0], population)
        self._shape = scenarios, len(runs), max(self._first, self._further)
        self._evaluate = evaluate
        self.x = np.zeros((scenarios, len(runs), dim), dtype)
        self.fitness = np.full(self.x.shape[:2], np.inf, dtype)
        self.history = np.full((*self.x.shape[:2], iterations), np.inf, dtype)

    def compile(self) -> None:
        """Evaluate something, so that the program is there."""
        scenarios, runs, rows = self._shape
        self._evaluate(np.zeros((scenarios, runs * rows, self.x.shape[-1])))

    def begin(self) -> None:
        """Evaluate the initial populations."""
        self._turn(self._first)

    def advance(self, first: int, stop: int) -> None:
        """Iterations first … stop-1, counted from 1."""
        for t in range(first, stop):
            self._turn(self._further)
            self.history[..., t - 1] = self.fitness

    def _turn(self, count: int) -> None:
        """Let every run ask for so many, and tell it; rows that only fill the shape count not."""
        scenarios, runs, rows = self._shape
        asked = np.zeros((scenarios, runs, rows, self.x.shape[-1]))
        for s, r in np.ndindex(scenarios, runs):
            candidates = np.asarray(self._searches[s][r].ask(), np.float64)
            if candidates.shape != (count, asked.shape[-1]):
                raise InputError(
                    f"{self.name}: asks for candidates of shape {candidates.shape} where it has to "
                    f"ask for {(count, asked.shape[-1])}; a search on the host asks for equally "
                    "many in every turn but the first"
                )
            asked[s, r, :count] = candidates
        points, fitness = self._evaluate(asked.reshape(scenarios, runs * rows, -1))
        points, fitness = points.reshape(asked.shape), fitness.reshape(asked.shape[:3])
        points, fitness = points[:, :, :count], fitness[:, :, :count]
        for s, r in np.ndindex(scenarios, runs):
            self._note(s, r, points[s, r], fitness[s, r])
            told = points[s, r].astype(np.float64), fitness[s, r].astype(np.float64)
            self._searches[s][r].tell(*told)

    def _note(self, s: int, r: int, x: np.ndarray, fitness: np.ndarray) -> None:
        i = fitness.argmin()
        if fitness[i] < self.fitness[s, r] or np.isposinf(self.fitness[s, r]):  # always some point
            self.x[s, r], self.fitness[s, r] = x[i], fitness[i]


def run_on_host(
    batch: HostBatch, stops: Sequence[int], report: Callable[[int], None] | None
) -> Outcome:
    """Make all iterations of a batch, in parts; seconds as `optim.batch.run_batch` counts them."""
    clock = time.perf_counter()
    batch.compile()
    seconds_compile, clock = time.perf_counter() - clock, time.perf_counter()
    batch.begin()
    for first, stop in itertools.pairwise(stops):
        batch.advance(first, stop)
        if report is not None:
            report(stop - 1)
    seconds_run = time.perf_counter() - clock
    return Outcome(batch.x, batch.fitness, batch.history, NoInfo(), seconds_compile, seconds_run)


def time_on_host(batch: HostBatch, stops: Sequence[int]) -> float:
    """Seconds of an iteration, the quickest of the parts."""
    batch.compile()
    batch.begin()
    seconds = []
    for first, stop in itertools.pairwise(stops):
        clock = time.perf_counter()
        batch.advance(first, stop)
        seconds.append((time.perf_counter() - clock) / (stop - first))
    return min(seconds)


def seed_of(seed: int, name: str, run: int) -> int:
    """The number below 2**31 that one run begins from."""
    return int(jax.random.bits(run_key(seed, name, run), dtype=jnp.uint32)) >> 1


class Aside:
    """A search with generators of its own in place of those that a whole process shares.

    Some libraries draw from `numpy.random` or `random`. Each turn of such a search finds them as
    its last one left them, and everybody else finds them untouched.

    Args:
        seed: of both generators.
        begin: begins the search, with its generators in place.
    """

    def __init__(self, seed: int, begin: Callable[[], HostSearch]):
        self._state = np.random.RandomState(seed).get_state(), random.Random(seed).getstate()
        with self._in_place():
            self._search = begin()

    def ask(self) -> Float[np.ndarray, "pop dim"]:
        """The next candidates."""
        with self._in_place():
            return self._search.ask()

    def tell(self, x: Float[np.ndarray, "pop dim"], fitness: Float[np.ndarray, "pop"]) -> None:
        """Their fitness."""
        with self._in_place():
            self._search.tell(x, fitness)

    @contextmanager
    def _in_place(self) -> Iterator[None]:
        everybodys = np.random.get_state(), random.getstate()  # noqa: NPY002  theirs
        try:
            _put(self._state)
            yield
            self._state = np.random.get_state(), random.getstate()  # noqa: NPY002
        finally:
            _put(everybodys)


def _put(state: tuple) -> None:
    np.random.set_state(state[0])  # noqa: NPY002
    random.setstate(state[1])
