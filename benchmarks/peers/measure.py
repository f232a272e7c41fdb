"""Ours and a peer in turns, so that other work on the machine falls on both alike."""

import statistics
import time
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import jax
import numpy as np

from benchmarks.peers.task import Found, Peer, Task, quality
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import stack_problems

WARM = 3
"""Iterations of the one run that a peer makes before it is measured."""


Clock = Callable[[], float]


def clock_of(cores: int) -> Clock:
    """The processor's time on one core, which other work does not lengthen; else the wall's."""
    return time.process_time if cores == 1 else time.perf_counter


def ours(name: str) -> Callable[[Task], Found]:
    """An algorithm of ours: all runs as one program."""
    optimizer = algorithm(name)

    def go(task: Task) -> Found:
        problems = stack_problems([jax.tree.map(np.asarray, task.problem)])
        sizes = task.iterations, task.population
        return Found(run_batch(problems, optimizer, 0, range(task.runs), *sizes).x[0], 0)

    return go


def counted(name: str, task: Task, found: Found) -> Found:
    """What ours found with its evaluations, which are counted by tracing it."""
    per_run = count_evaluations(algorithm(name), task.problem, task.population)
    return found._replace(evaluations=task.runs * per_run.total(task.iterations))


def beside(peer: Peer, task: Task, repeats: int, clock: Clock) -> dict[str, Any]:
    """One peer and ours, measured in turns: a row of numbers.

    Args:
        peer: whom.
        task: what is minimised, and for how long.
        repeats: how often each is timed, after both are compiled.
        clock: what tells seconds; those on the wall are kept beside them.
    """
    pair = {"ours": ours(peer.ours), "peer": peer.go}
    pair["ours"](task)
    short = task if peer.compiled else task._replace(runs=1, iterations=WARM)
    pair["peer"](short)
    seconds: dict[str, list[float]] = {who: [] for who in pair}
    wall: dict[str, list[float]] = {who: [] for who in pair}
    found: dict[str, Found] = {}
    for _ in range(repeats):
        for who, go in pair.items():
            begun = clock(), time.perf_counter()
            found[who] = go(task)
            seconds[who].append(clock() - begun[0])
            wall[who].append(time.perf_counter() - begun[1])
    found["ours"] = counted(peer.ours, task, found["ours"])
    ratios = [theirs / mine for mine, theirs in zip(*seconds.values(), strict=True)]
    work = {who: each.evaluations for who, each in found.items()}
    return {
        "library": peer.library,
        "version": version(peer.library),
        "name": peer.name,
        "beside": peer.ours,
        "single": peer.single,
        "ratio": statistics.median(ratios),
        "ratio_least": min(ratios),
        "ratio_most": max(ratios),
        "ratio_per_evaluation": statistics.median(ratios) * work["ours"] / work["peer"],
        **{
            who: {
                "seconds": statistics.median(seconds[who]),
                "wall_seconds": statistics.median(wall[who]),
                "evaluations": work[who] / task.runs,
                "microseconds": 1e6 * statistics.median(seconds[who]) / work[who],
                **quality(task, found[who])._asdict(),
            }
            for who in pair
        },
    }
