"""Print the timings that the README quotes: fitness, optimisers, the whole comparison."""

import argparse
import json
import platform
import tempfile
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec
from rich.console import Console
from rich.table import Table

from benchmarks.planning import planning_rows
from benchmarks.roofline import roofline
from benchmarks.steps import evaluations_only
from benchmarks.timing import least_seconds, run_process
from jaxsusp.comparison.workunit import Group, stack_scenarios
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.optim.devices import configure, cores
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import Problem
from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.scenario import load_scenario

RUNS, ITERATIONS, POPULATION = 20, 500, 30


def fitness_per_candidate(problem: Problem, candidates: int = RUNS * POPULATION) -> float:
    """Seconds per candidate of one population, sharded over all devices, single precision."""
    mesh = Mesh(np.asarray(jax.devices()), ("candidates",))
    rows = PartitionSpec("candidates")
    everywhere = PartitionSpec()
    evaluate = jax.jit(
        jax.shard_map(
            Problem.evaluate,
            mesh=mesh,
            in_specs=(everywhere, rows),
            out_specs=rows,
            check_vma=False,
        )
    )
    unit = jax.random.uniform(jax.random.key(0), (candidates, problem.dim), jnp.float32)
    x = problem.low + (problem.high - problem.low) * unit
    problem = jax.device_put(problem, NamedSharding(mesh, everywhere))  # once, not in every call
    x = jax.device_put(x, NamedSharding(mesh, rows))
    return least_seconds(lambda: evaluate(problem, x), inner=50) / candidates


def optimiser_rows(group: Group) -> list[dict]:
    """Per algorithm: compilation, the default comparison's runs, and the share beyond fitness."""
    rows = []
    for name in PUBLISHED:
        optimizer = algorithm(name)
        bare = evaluations_only(optimizer, group.first, POPULATION)
        timed = {}
        for key, chosen in (("whole", optimizer), ("fitness", bare)):
            outcomes = [
                run_batch(group.problems, chosen, 0, range(RUNS), ITERATIONS, POPULATION)
                for _ in range(3)
            ]
            timed[key] = min(outcome.seconds_run for outcome in outcomes)
            if key == "whole":
                compile_seconds = outcomes[0].seconds_compile
        evaluations = count_evaluations(optimizer, group.first, POPULATION).total(ITERATIONS)
        rows.append(
            {
                "algorithm": name,
                "compile_s": compile_seconds,
                "run_s": timed["whole"],
                "us_per_evaluation": 1e6
                * timed["whole"]
                / (evaluations * RUNS * len(group.scenarios)),
                "share_beyond_fitness": 1 - timed["fitness"] / timed["whole"],
            }
        )
    return rows


def main() -> None:
    """Measure, print a table, and write the numbers where asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--output", type=Path, help="write the numbers to this JSON file")
    parser.add_argument("--quick", action="store_true", help="leave out the cold start")
    arguments = parser.parse_args()
    configure(keep=False)
    console = Console()
    machine = f"{platform.machine()}, {cores()} cores, {len(jax.devices())} devices"
    console.print(f"jax {jax.__version__}, Python {platform.python_version()}, {machine}", "")

    chosen = [load_scenario(name) for name in scenarios()]
    (group,) = stack_scenarios(chosen, 5, 40, "box")
    largest = Problem.from_scenario(chosen[-1], dtype=np.float32)
    numbers: dict = {"fitness_us": 1e6 * fitness_per_candidate(jax.tree.map(jnp.asarray, largest))}
    console.print(
        f"fitness, population of {RUNS * POPULATION}, ten obstacles: "
        f"{numbers['fitness_us']:.2f} µs per candidate (target 2)"
    )
    limit = roofline(largest, RUNS * POPULATION, numbers["fitness_us"] / 1e6)
    numbers["roofline"] = limit._asdict() | {"bound_us": 1e6 * limit.bound}
    console.print(str(limit))

    numbers["optimisers"] = optimiser_rows(group)
    table = Table("algorithm", "compile", "run", "per evaluation", "beyond fitness", box=None)
    for row in numbers["optimisers"]:
        table.add_row(
            row["algorithm"],
            f"{row['compile_s']:.1f} s",
            f"{row['run_s']:.2f} s",
            f"{row['us_per_evaluation']:.2f} µs",
            f"{row['share_beyond_fitness']:.0%}",
        )
    console.print("", f"{len(chosen)} scenarios × {RUNS} runs × {ITERATIONS} iterations:", table)
    total = sum(row["run_s"] for row in numbers["optimisers"])
    console.print(f"all four after compilation: {total:.1f} s (target 35)")

    numbers["planning"] = planning_rows(console)

    if not arguments.quick:
        for command in (["plan", "scenario-1"], ["compare"]):
            with tempfile.TemporaryDirectory() as folder:
                cold, again = (run_process(*command, folder=Path(folder)) for _ in range(2))
            name = command[0]
            numbers[name] = {
                "cold_s": cold.seconds, "again_s": again.seconds, "peak_bytes": cold.peak_bytes,
            }  # fmt: skip
            console.print(
                f"jaxsusp {' '.join(command)}, nothing kept from before, tables, figures and free "
                f"spaces included: {cold.seconds:.0f} s, again {again.seconds:.0f} s, "
                f"{cold.peak_bytes / 2**30:.2f} GiB"
            )
    if arguments.output:
        arguments.output.write_text(json.dumps(numbers, indent=2))


if __name__ == "__main__":
    main()
