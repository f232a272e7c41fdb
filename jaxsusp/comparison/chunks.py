"""A comparison in chunks: some runs of a unit, computed at a time, here or by workers.

The size of a chunk belongs to the study: who computes it changes nothing.
"""

import math
import resource
import shutil
import sys
from collections.abc import Callable, Generator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from jaxsusp.cluster.jobs import Job
from jaxsusp.comparison.choices import CHUNK, CHUNKS, CURVE, LONG
from jaxsusp.comparison.dataset import VARIABLES, thinned
from jaxsusp.comparison.workunit import Unit
from jaxsusp.errors import InputError
from jaxsusp.problem.problem import Suspension

if TYPE_CHECKING:
    from jaxsusp.cluster.client import Cluster


class Chunk(NamedTuple):
    """What is computed, and kept, at a time."""

    unit: Unit
    runs: tuple[int, ...]
    lanes: int  # runs that the program has room for: equal for all chunks of a unit
    most_kept: int | None  # iterations of every history that are kept

    def compute(self, seed: int, report: Callable[[int], None] | None = None) -> xr.Dataset:
        """The chunk's dataset; `report` is told finished iterations."""
        return self.unit.compute(seed, self.runs, self.lanes, self.most_kept, report)

    @property
    def cost(self) -> int:
        """Fitness evaluations."""
        return self.unit.cost(len(self.runs))


def usual_size(runs: int, units: Sequence[Unit] = (), free: int | None = None) -> int:
    """Runs of a chunk where nothing else is asked for.

    Args:
        runs: of every unit.
        units: whose chunks are to fit into the memory of the devices.
        free: bytes that they have free (`optim.devices.free_memory`), of which half is used: a
            GPU is the faster the more it has to do at a time. None: that of the machine, which is
            kept low.
    """
    if free is None:
        return max(CHUNK, -(-runs // CHUNKS))
    most = max(map(bytes_of_run, units))
    return max(1, min(runs, free // (2 * most)))


ARRAYS = 16
"""Numbers that a candidate takes per sample, and as many again for every cable, two and a half
times what XLA says for a CPU: a GPU fuses less."""


def bytes_of_run(unit: Unit) -> int:
    """What a run takes of a device's memory while it computes, single precision."""
    problem = unit.group.problems
    assert isinstance(problem.fitness, Suspension)
    cables = len(unit.group.scenarios[0].robots)
    per_candidate = ARRAYS * (1 + cables) * problem.fitness.samples + 10 * problem.lower.shape[-1]
    per_scenario = unit.population * per_candidate + unit.iterations
    return 4 * len(unit.group.scenarios) * per_scenario


def cut(unit: Unit, missing: Sequence[int], size: int, is_long: bool) -> list[Chunk]:
    """Chunks of nearly equal size, at most `size`, with room for equally many runs each."""
    if not missing:
        return []
    parts = np.array_split(np.asarray(missing), -(-len(missing) // size))
    lanes = max(len(part) for part in parts)
    kept = CURVE if is_long else None
    return [Chunk(unit, tuple(part.tolist()), lanes, kept) for part in parts]


def computed(
    chunks: Sequence[Chunk],
    seed: int,
    cluster: "Cluster | None",
    report: Callable[[Chunk, int], None],
) -> Generator[tuple[Chunk, xr.Dataset], None, None]:
    """Every chunk with its dataset, in the order they finish.

    Args:
        chunks: what to compute.
        seed: root of all randomness.
        cluster: who computes it; None: this process.
        report: called with a chunk and its finished iterations; 0 when it begins.
    """
    if cluster is None:
        for chunk in chunks:
            report(chunk, 0)

            def told(iterations: int, chunk: Chunk = chunk) -> None:
                report(chunk, iterations)

            yield chunk, chunk.compute(seed, told)
        return
    jobs = [
        Job(f"{chunk.unit.optimizer.name}, runs {chunk.runs[0]} to {chunk.runs[-1]}", _by_worker,
            chunk.unit, (seed, chunk.runs, chunk.lanes, chunk.most_kept))
        for chunk in chunks
    ]  # fmt: skip
    for number, ds in cluster.run(jobs):
        yield chunks[number], ds


def _by_worker(unit: Unit, seed: int, runs, lanes: int, most_kept: int | None) -> xr.Dataset:
    return Chunk(unit, runs, lanes, most_kept).compute(seed)


def pace(unit: Unit, seed: int, runs: int, cluster: "Cluster | None") -> float:
    """Seconds of an iteration of one run on all scenarios, so many runs sharing a batch."""
    if cluster is None:
        found = _by_clock(unit, seed, runs)
    else:
        job = Job(f"timing {unit.optimizer.name}", _by_clock, unit, (seed, runs))
        ((_, found),) = cluster.run([job])
    return found / runs


def _by_clock(unit: Unit, seed: int, runs: int) -> float:
    return unit.time_iteration(seed, runs)


class Estimate(NamedTuple):
    """What a long study will take."""

    seconds: float
    memory: int  # bytes of this process at most
    disk: int  # bytes

    def __str__(self) -> str:
        return (
            f"about {_time(self.seconds)} once compiled, {_size(self.memory)} of memory and "
            f"{_size(self.disk)} on disk"
        )

    def require_room(self, folder: Path) -> None:
        """Refuse to begin what the disk cannot hold.

        Raises:
            InputError: with what is needed and what is free.
        """
        place = next(each for each in (folder, *folder.absolute().parents) if each.exists())
        free = shutil.disk_usage(place).free
        if self.disk > free:
            raise InputError(
                f"output = {folder}: the study needs {_size(self.disk)} on disk and "
                f"{_size(free)} are free; make room, choose another folder, or ask for fewer runs"
            )


def estimate(chunks: Sequence[Chunk], seed: int, cluster: "Cluster | None") -> Estimate:
    """Time by the pace of the first chunk, other algorithms by their evaluations."""
    first = chunks[0]
    per_run = pace(first.unit, seed, first.lanes, cluster) * first.unit.iterations
    per_evaluation = per_run / first.unit.cost(1)
    workers = 1 if cluster is None else max(1, len(cluster.workers))
    seconds = per_evaluation * sum(chunk.cost for chunk in chunks) / workers
    so_far = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    so_far *= 1 if sys.platform == "darwin" else 1024
    largest = max(_bytes(chunk, chunk.unit.iterations) for chunk in chunks)
    disk = sum(_bytes(chunk, CURVE) for chunk in chunks)
    return Estimate(seconds, so_far + 4 * largest, disk)


def _bytes(chunk: Chunk, kept: int) -> int:
    """What a chunk's dataset holds of its runs, and a file's own administration."""
    unit = chunk.unit
    cells = len(unit.group.scenarios) * len(chunk.runs)
    sizes = {
        "iteration": len(thinned(unit.iterations, kept)),
        "term": 6, "variable": unit.group.problems.lower.shape[-1],
    }  # fmt: skip
    per_run = sum(
        np.dtype(variable.dtype).itemsize * math.prod(sizes[dim] for dim in variable.dims[3:])
        for variable in VARIABLES.values()
        if "run" in variable.dims
    )
    return cells * per_run + 50_000


def _time(seconds: float) -> str:
    for unit, name in ((86400, "days"), (3600, "hours"), (60, "minutes")):
        if seconds >= 1.5 * unit:
            return f"{_few(seconds / unit)} {name}"
    return f"{_few(seconds)} seconds"


def _size(count: int) -> str:
    for unit, name in ((2**30, "GiB"), (2**20, "MiB")):
        if count >= unit:
            return f"{_few(count / unit)} {name}"
    return f"{_few(count / 1024)} KiB"


def _few(number: float) -> str:
    """Two digits, or whole where it has more before the point."""
    return f"{number:.2g}" if number < 10 else f"{number:.0f}"


def is_long(runs: int) -> bool:
    """Whether so many runs make a long study."""
    return runs > LONG
