"""One point of the study of scaling, measured by a process of its own: times and memory.

`python -m experiments.studies.scaling_point '{"runs": 10, …}'` prints a JSON object.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]


class Point(NamedTuple):
    """What is computed."""

    runs: int = 100
    population: int = 30
    waypoints: int = 5
    samples: int = 40
    scenario: str = "scenario-5"  # name or file
    devices: int = 2
    workers: int = -1  # of a comparison: processes that share the cores; −1: no comparison
    chunk: int = 0  # runs that are computed at a time; 0: all
    iterations: int = 10
    repeats: int = 5
    longest: float = 10.0  # s, after which it is not repeated any more, but for a second time


def measured(point: Point) -> dict[str, Any]:
    """What a process of its own finds.

    Raises:
        RuntimeError: it failed.
    """
    command = [sys.executable, "-m", "experiments.studies.scaling_point"]
    path = [str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
    here = {"JAX_NUM_CPU_DEVICES": str(point.devices), "PYTHONPATH": os.pathsep.join(path)}
    done = subprocess.run(
        [*command, json.dumps(point._asdict())],
        env=os.environ | here, capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"{point} failed: {done.stderr.strip().splitlines()[-1]}")
    return json.loads(done.stdout.splitlines()[-1])


def times(work: Callable[[], Any], point: Point) -> list[float]:
    """Seconds of several calls."""
    found: list[float] = []
    while len(found) < point.repeats and (len(found) < 2 or sum(found) < point.longest):
        clock = time.perf_counter()
        work()
        found.append(time.perf_counter() - clock)
    return found


def in_this_process(point: Point) -> Callable[[], Any]:
    """All runs of PSO as one batch, or chunk by chunk."""
    from jaxsusp.comparison.workunit import stack_scenarios
    from jaxsusp.optim.batch import run_batch
    from jaxsusp.optim.registry import algorithm
    from jaxsusp.scenario.scenario import load_scenario

    scene = load_scenario(point.scenario)
    (group,) = stack_scenarios([scene], point.waypoints, point.samples, "box")
    size = point.chunk or point.runs

    def work() -> list:
        return [
            run_batch(
                group.problems, algorithm("pso"), 0, range(first, min(first + size, point.runs)),
                point.iterations, point.population, lanes=min(size, point.runs),
            )
            for first in range(0, point.runs, size)
        ]  # fmt: skip

    return work


def by_workers(point: Point, client: Any) -> Callable[[], Any]:
    """The same as a comparison, whose chunks are computed here (None) or by workers."""
    import jaxsusp as js

    return lambda: js.compare(
        [point.scenario], ["pso"], point.runs, point.iterations, point.population,
        search="box", waypoints=point.waypoints, samples=point.samples, chunk=point.chunk or None,
        workers=client,
    )  # fmt: skip


def forget_peak() -> None:
    """Let the system count the process's greatest memory from now on, where it can."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")


def peak() -> int:
    """Greatest memory of the process since then, in bytes."""
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text(encoding="utf-8").splitlines():
            if line.startswith("VmHWM:"):
                return 1024 * int(line.split()[1])
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most


def found_by(work: Callable[[], Any], point: Point) -> dict[str, Any]:
    """Compile, then measure."""
    clock = time.perf_counter()
    work()
    first = time.perf_counter() - clock
    forget_peak()
    seconds = times(work, point)
    return {
        "seconds": statistics.median(seconds), "least": min(seconds), "most": max(seconds),
        "repeats": len(seconds), "compiling": first - min(seconds), "memory": peak(),
    }  # fmt: skip


def main(asked: str) -> None:
    """Measure one point in this process."""
    from jaxsusp.optim import devices

    point = Point(**json.loads(asked))
    devices.configure(devices=point.devices)
    if point.workers == 0:
        found = found_by(by_workers(point, None), point)
    elif point.workers > 0:
        from jaxsusp.cluster.choices import Place
        from jaxsusp.cluster.client import connected

        with connected(Place(workers=point.workers)) as cluster:
            found = found_by(by_workers(point, cluster.client), point)
    else:
        found = found_by(in_this_process(point), point)
    print(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1])
