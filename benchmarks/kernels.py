"""Where a search spends its time: the kernels of its compiled program, as JAX's profiler sees them.

    python -m benchmarks.kernels sdbo

One that takes much longer for an element than its operations would is not vectorised. So far that
was because of a call of the C library (arctan2, cbrt, powers), because coefficients were looked up
within the kernel (`problem.flatbatch`), or because it joined arrays.
"""

import argparse
import math
import re
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp.comparison.workunit import stack_scenarios
from jaxsusp.optim import batch
from jaxsusp.optim.base import require_compiled
from jaxsusp.optim.devices import configure
from jaxsusp.optim.loop import run_key
from jaxsusp.optim.registry import algorithm
from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.scenario import load_scenario

RUNS, POPULATION, ITERATIONS, SHOWN = 10, 30, 20, 15  # runs of every device


class Kernel(NamedTuple):
    """What the compiled program says of a kernel."""

    elements: int
    origin: str  # functions that were traced, the innermost last


def kernels_of(program: str) -> dict[str, Kernel]:
    """The fused kernels of a program in XLA's text form, by name."""
    found = {}
    for name, shape, rest in re.findall(r"%(\S+) = \w+\[([\d,]*)\]\S* fusion\((.*)", program):
        origin = re.search(r'op_name="([^"]*)"', rest)
        steps = re.findall(r"jit\((\w+)\)", origin.group(1)) if origin else []
        last = origin.group(1).rpartition("/")[2] if origin else ""
        elements = math.prod(map(int, filter(None, shape.split(","))))
        found[name] = Kernel(elements, "/".join([*steps[1:], last]))
    return found


def traced(run) -> dict[str, list[float]]:
    """Seconds of every event on the threads that compute, by name."""
    seconds = defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        with jax.profiler.trace(folder):
            run()
        (file,) = Path(folder).rglob("*.xplane.pb")
        for plane in jax.profiler.ProfileData.from_file(str(file)).planes:
            for line in plane.lines:
                for event in line.events if "Eigen" in line.name else ():
                    seconds[event.name].append(event.duration_ns / 1e9)
    return seconds


def main() -> None:
    """Profile a search of all built-in scenarios and print its longest kernels."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.kernels", description=__doc__)
    parser.add_argument("algorithm", nargs="?", default="pso", help="which search (default pso)")
    optimizer = algorithm(parser.parse_args().algorithm)
    require_compiled(optimizer)
    configure(keep=False)
    six = [load_scenario(name) for name in scenarios()]
    (group,) = stack_scenarios(six, waypoints=5, samples=40, search="free-space")
    devices = tuple(jax.devices())
    keys = jax.vmap(lambda run: run_key(0, optimizer.name, run))(jnp.arange(RUNS * len(devices)))
    placed, start, go = batch._programs(devices, POPULATION, 2 * ITERATIONS, 0, False)
    arguments = placed(group.problems, optimizer, keys)
    begun = start(*arguments)
    program = go.lower(*arguments, begun, *batch._span(1, 1)).compile()

    def advanced(first: int, stop: int):
        return jax.block_until_ready(program(*arguments, begun, *batch._span(first, stop)))

    advanced(1, ITERATIONS)
    seconds = traced(lambda: advanced(1, ITERATIONS + 1))
    kernels = kernels_of(program.as_text())
    spent = {name: sum(seconds[name]) for name in kernels if name in seconds}
    total = sum(spent.values())
    print(
        f"{optimizer.name}, {ITERATIONS} iterations: {len(spent)} kernels, {total:.3f} s of cores"
    )
    print(f"{'share':>6} {'calls':>7} {'µs each':>9} {'ns/elem':>8}  of")
    for name in sorted(spent, key=spent.__getitem__, reverse=True)[:SHOWN]:
        each, kernel = spent[name] / len(seconds[name]), kernels[name]
        print(
            f"{spent[name] / total:6.1%} {len(seconds[name]):7} {1e6 * each:9.1f} "
            f"{1e9 * each / kernel.elements:8.2f}  {kernel.origin}"
        )


if __name__ == "__main__":
    main()
