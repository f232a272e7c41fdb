"""Runs × scenarios as one array program. Nothing else knows about devices.

Runs are sharded over the devices, and within a device `vmap` adds scenarios and runs as axes of
the same program. A run's numbers do not depend on how many others share it.
"""

import functools
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxsusp._types import Array
from jaxsusp.optim.base import AnyOptimizer, HostOptimizer, Optimizer
from jaxsusp.optim.devices import accelerated
from jaxsusp.optim.host import Evaluate, HostBatch, run_on_host, time_on_host
from jaxsusp.optim.loop import Progress, advance, begin, run_key
from jaxsusp.optim.outcome import Outcome
from jaxsusp.optim.programs import at_hand, kept_in
from jaxsusp.problem.problem import Problem

ONCE = {"xla_backend_optimization_level": 1}
"""How a program is compiled that runs but once: in two thirds of the time."""

BRIEF, LONG = {"xla_backend_optimization_level": 2}, {"xla_backend_optimization_level": 3}
"""How one is that iterates, on a CPU: BRIEF takes two thirds of the time to compile and a tenth
more in every iteration. What they compute differs in the last place of a number here and there."""

MANY = 10_000_000
"""Candidates in one batch from which on `LONG` is the quicker; elsewhere it always is taken."""

CHUNKS = 20
"""Parts in which a run is advanced, each reported to the progress callback."""


LEAST = 2
"""Runs of a device at least, if need be one of them twice: XLA rounds the arithmetic of a single
run in its own way, and a run is the same in whatever batch it is computed. (`routed` on one device
still differs in the last digits from `routed` on two.)"""


def run_batch(
    problems: Problem,
    optimizer: AnyOptimizer,
    seed: int,
    runs: Sequence[int],
    iterations: int,
    population: int,
    report: Callable[[int], None] | None = None,
    room: int = 0,
    lanes: int = 0,
) -> Outcome:
    """Minimise stacked problems, several independent runs each, in one compiled program.

    Args:
        problems: problems of one static shape stacked along a leading axis of every leaf.
        optimizer: what minimises them; one on the host is advanced beside the program, which then
            holds the fitness alone.
        seed: root of all randomness.
        runs: indices of the runs; run i is the same in whatever batch it is computed.
        iterations: number T of iterations.
        population: number N of candidates.
        report: called with the number of finished iterations after every chunk.
        room: iterations that the program has room for, at least those that are made: runs of
            different lengths with equal room share what takes long to compile.
        lanes: runs that the program has room for, at least those that are made: likewise.

    Returns:
        An `Outcome`; compilation (none if the program is at hand) and computation timed apart.
    """
    if isinstance(optimizer, HostOptimizer):
        batch = _on_host(problems, optimizer, seed, runs, population, iterations)
        return run_on_host(batch, _stops(iterations), report)
    clock = time.perf_counter()
    sizes = population, iterations, max(iterations, room)
    with _launched(problems, optimizer, seed, runs, *sizes, lanes) as (go, progress):
        seconds_compile = time.perf_counter() - clock
        clock = time.perf_counter()
        for first, stop in itertools.pairwise(_stops(iterations)):
            progress = go(progress, first, stop)
            if report is not None:
                report(stop - 1)
        seconds_run = time.perf_counter() - clock
        return _collect(progress, len(runs), iterations, seconds_compile, seconds_run)


def time_iteration(
    problems: Problem,
    optimizer: AnyOptimizer,
    seed: int,
    runs: Sequence[int],
    iterations: int,
    population: int,
    room: int = 0,
    lanes: int = 0,
) -> float:
    """Seconds that one iteration of a batch takes on this machine, compilation not included.

    The first three of the chunks of `run_batch` are run and the quickest counts: whatever else the
    machine does can only delay. Arguments are those of `run_batch`.
    """
    if isinstance(optimizer, HostOptimizer):
        batch = _on_host(problems, optimizer, seed, runs, population, iterations)
        return time_on_host(batch, _stops(iterations)[:4])
    sizes = population, iterations, max(iterations, room)
    with _launched(problems, optimizer, seed, runs, *sizes, lanes) as (go, progress):
        seconds = []
        for first, stop in itertools.pairwise(_stops(iterations)[:4]):
            clock = time.perf_counter()
            progress = go(progress, first, stop)
            seconds.append((time.perf_counter() - clock) / (stop - first))
        return min(seconds)


def _stops(iterations: int) -> list[int]:
    """First iterations of the chunks, counted from 1, and what follows the last one."""
    stops = np.linspace(1, iterations + 1, min(CHUNKS, iterations) + 1)
    return stops.round().astype(int).tolist()


def compile_batch(
    problems: Problem,
    optimizer: AnyOptimizer,
    seed: int,
    runs: Sequence[int],
    iterations: int,
    population: int,
) -> None:
    """Have what `run_batch` takes for such arguments at hand: a thread can, beside other work.

    `run_batch` waits for what is not finished. Where no compiled programs are kept (see
    `optim.programs`) nothing is done. Switches of JAX that a caller has set for his thread alone
    do not reach another; what is compiled there is then of no use, and does no harm.
    """
    if isinstance(optimizer, HostOptimizer) or kept_in() is None:
        return
    sizes = population, iterations, iterations
    with suppress(Exception), _launched(problems, optimizer, seed, runs, *sizes, 0):
        pass  # what is wrong shows in the search itself


@contextmanager
def _launched(
    problems: Problem,
    optimizer: Optimizer,
    seed: int,
    runs: Sequence[int],
    population: int,
    iterations: int,
    room: int,
    lanes: int,
) -> Iterator[tuple[Callable[[Progress, int, int], Progress], Progress]]:
    """Compile a batch and begin it: `go(progress, first, stop)` advances it, and waits."""
    dtype = problems.lower.dtype
    with jax.enable_x64(dtype == np.float64):
        wanted = max(lanes, len(runs))
        devices = jax.devices()[:wanted]
        each = max(LEAST, -(-wanted // len(devices)))
        padded = [*runs, *[runs[-1]] * (each * len(devices) - len(runs))]
        keys = jax.vmap(functools.partial(run_key, seed, optimizer.name))(jnp.asarray(padded))
        sizes = population, iterations, room
        candidates = len(problems.lower) * wanted * population * room  # on however many devices
        is_long = accelerated() or candidates >= MANY
        placed, start, advance_all = _programs(tuple(devices), *sizes, is_long)
        arguments = placed(problems, optimizer, keys)
        begun = at_hand(start, devices, *arguments, part="start", sizes=sizes)(*arguments)
        # All that it is made for shows in its arguments: runs of other lengths share it.
        known = {"part": "go", "long": is_long}
        advanced = at_hand(advance_all, devices, *arguments, begun, *_span(1, 1), **known)

        def go(progress: Progress, first: int, stop: int) -> Progress:
            return jax.block_until_ready(advanced(*arguments, progress, *_span(first, stop)))

        yield go, go(begun, 1, 1)  # runs nothing


def _span(first: int, stop: int) -> tuple[Array, Array]:
    """Iterations as arguments of a compiled program, whose values do not belong to it."""
    return jnp.int32(first), jnp.int32(stop)


@functools.lru_cache(maxsize=64)
def _programs(devices: tuple, population: int, iterations: int, room: int, is_long: bool):
    """(placed, start, go): a way to place arguments, and entry points that are compiled once.

    JAX keys them by the shapes of their arguments. Those that are not where a program wants them
    would be taken there in every call.
    """
    mesh = Mesh(np.asarray(devices), ("runs",))
    per_run, everywhere = PartitionSpec("runs"), PartitionSpec()
    stacked = PartitionSpec(None, "runs")

    def placed(problems: Problem, optimizer: Optimizer, keys: Array) -> tuple:
        common = jax.device_put((problems, optimizer), NamedSharding(mesh, everywhere))
        return *common, jax.device_put(keys, NamedSharding(mesh, per_run))

    def start(problems: Problem, optimizer: Optimizer, keys: Array) -> Progress:
        def one(problem, key):
            return begin(optimizer, problem, key, population, iterations, room)

        return jax.vmap(jax.vmap(one, in_axes=(None, 0)), in_axes=(0, None))(problems, keys)

    def go(problems, optimizer, keys, progress, first, stop) -> Progress:
        def one(problem, key, progress):
            return advance(optimizer, problem, key, progress, first, stop)

        over_runs = jax.vmap(one, in_axes=(None, 0, 0))
        return jax.vmap(over_runs, in_axes=(0, None, 0))(problems, keys, progress)

    shard = functools.partial(jax.shard_map, mesh=mesh, out_specs=stacked, check_vma=False)
    arguments = (everywhere, everywhere, per_run)
    return (
        placed,
        jax.jit(shard(start, in_specs=arguments), compiler_options=ONCE),
        jax.jit(
            shard(go, in_specs=(*arguments, stacked, everywhere, everywhere)),
            compiler_options=LONG if is_long else BRIEF,
        ),
    )


def _on_host(
    problems: Problem,
    optimizer: HostOptimizer,
    seed: int,
    runs: Sequence[int],
    population: int,
    iterations: int,
) -> HostBatch:
    evaluate = evaluator(problems)
    return HostBatch(optimizer, problems, evaluate, seed, runs, population, iterations)


def evaluator(problems: Problem) -> Evaluate:
    """Repair and fitness of candidates (S, M, D) of stacked problems, shared among the devices."""
    devices, dtype = tuple(jax.devices()), problems.lower.dtype
    program, everywhere = _evaluation(devices)
    with jax.enable_x64(dtype == np.float64):
        there = jax.device_put(problems, everywhere)  # once, not in every call

    def evaluate(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        count = x.shape[1]
        filled = np.pad(x, ((0, 0), (0, -count % len(devices)), (0, 0)), mode="edge")
        with jax.enable_x64(dtype == np.float64):
            found = program(there, filled.astype(dtype))
            points, fitness = jax.tree.map(np.asarray, found)
        return points[:, :count], fitness[:, :count]

    return evaluate


@functools.lru_cache(maxsize=4)
def _evaluation(devices: tuple):
    mesh = Mesh(np.asarray(devices), ("candidates",))
    stacked = PartitionSpec(None, "candidates")

    def one(problem: Problem, x: Array) -> tuple[Array, Array]:
        x = problem.repair(x)
        return x, problem.evaluate(x)

    specs = {"in_specs": (PartitionSpec(), stacked), "out_specs": stacked}
    program = jax.jit(jax.shard_map(jax.vmap(one), mesh=mesh, check_vma=False, **specs))
    return program, NamedSharding(mesh, PartitionSpec())


def _collect(progress: Progress, runs: int, iterations: int, compile_time, run_time) -> Outcome:
    def on_host(leaf: Array) -> np.ndarray:
        return np.asarray(leaf)[:, :runs]  # without the runs that only fill the devices

    best, history, info = jax.tree.map(on_host, progress._replace(state=progress.state.best))
    means = jax.tree.map(lambda total: total / iterations, info)
    history = history[..., :iterations]
    return Outcome(best.x, best.fitness, history, means, compile_time, run_time)
