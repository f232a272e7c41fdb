"""A GPU beside the CPU of the same machine: the same terms, the same runs, and how much faster.

Run by somebody with a GPU: `python -m benchmarks.gpu`. Every device measures in a process of its
own, with the same package and the same random candidates.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import ks_2samp

from jaxsusp.errors import InputError
from jaxsusp.report.render import Column, duration, significant

TOLERANCE = 1e-5
"""Of a term: relative to its size, or to 1 where it is smaller."""

MARGIN = 1e-4
"""m by which every coordinate of a candidate is moved: where no such move changes its counts on the
CPU, they have to be the same on both."""

MOVES = 8

CHANCE = 0.001
"""Below such a probability (Kolmogorov, Smirnov) two samples of runs are told apart."""

TERMS = ("length", "height", "cable", "tension_rate", "curvature")
COUNTS = ("collisions", "violations")


def measured(
    candidates: int, runs: int, batches: Sequence[int], iterations: int, seed: int
) -> dict[str, Any]:
    """What this process finds on the devices of its JAX, plain values and arrays by name."""
    import jax

    import jaxsusp as js
    from jaxsusp.optim import devices

    found: dict[str, Any] = {"card": devices.said(), "platform": jax.default_backend()}
    for name in (js.scenarios()[0], js.scenarios()[-1]):
        for key, values in terms_of(name, candidates).items():
            found[f"{name}/{key}"] = values
        ended, _, _ = batch(name, "pso", runs, iterations, seed)
        found[f"{name}/runs"] = ended
    for algorithm in ("pso", "sdbo"):
        for many in batches:
            times = [batch(js.scenarios()[-1], algorithm, many, iterations, 0) for _ in range(3)]
            found[f"seconds/{algorithm}/{many}"] = min(seconds for _, seconds, _ in times)
            found[f"evaluations/{algorithm}/{many}"] = times[0][2]
    return found


def terms_of(name: str, candidates: int) -> dict[str, np.ndarray]:
    """Terms and counts of random candidates, single precision; counts of moved ones, too."""
    import jax
    import jax.numpy as jnp

    import jaxsusp as js

    problem = js.Problem.from_scenario(name, search="box", dtype=np.float32)
    random = np.random.default_rng(0)
    low, high = np.asarray(problem.lower), np.asarray(problem.upper)
    x = random.uniform(low, high, (candidates, problem.dim)).astype(np.float32)
    line = np.linspace(low, high, 3)[1] + 0.1 * (x - np.linspace(low, high, 3)[1])
    x[: candidates // 2] = line[: candidates // 2]  # near the middle there is less in the way
    evaluate = jax.jit(lambda problem, x: jax.vmap(problem.terms)(x))
    problem = jax.tree.map(jnp.asarray, problem)
    terms = evaluate(problem, jnp.asarray(x))
    found = {key: np.asarray(getattr(terms, key)) for key in (*TERMS, *COUNTS)}
    steady = np.ones(candidates, bool)
    for _ in range(MOVES):
        moved = x + random.choice([-MARGIN, MARGIN], x.shape).astype(np.float32)
        other = evaluate(problem, jnp.asarray(moved))
        for key in COUNTS:
            steady &= np.asarray(getattr(other, key)) == found[key]
    return {**found, "steady": steady}


def batch(
    name: str, algorithm: str, runs: int, iterations: int, seed: int
) -> tuple[np.ndarray, float, int]:
    """Final fitness of some runs, seconds after compilation, and evaluations of all of them."""
    from jaxsusp.comparison.workunit import Unit, stack_scenarios
    from jaxsusp.optim.batch import run_batch
    from jaxsusp.optim.registry import algorithm as named
    from jaxsusp.scenario.scenario import load_scenario

    (group,) = stack_scenarios([load_scenario(name)], 5, 40, "box")
    unit = Unit.plan(group, named(algorithm), iterations, 30, "iterations")
    done = run_batch(group.problems, unit.optimizer, seed, range(runs), iterations, 30)
    return done.fitness[0], done.seconds_run, unit.cost(runs)


def agreement(cpu: dict[str, Any], gpu: dict[str, Any]) -> pd.DataFrame:
    """A row per scenario: how far terms differ, how many counts, and whether runs are alike."""
    rows = []
    for name in sorted({key.partition("/")[0] for key in cpu if key.endswith("/steady")}):
        mine, theirs = ({k: each[f"{name}/{k}"] for k in (*TERMS, *COUNTS)} for each in (cpu, gpu))
        apart = {
            key: np.abs(theirs[key] - mine[key]) / np.maximum(np.abs(mine[key]), 1.0)
            for key in TERMS
        }
        worst = max(TERMS, key=lambda key: apart[key].max())
        differs = np.any([mine[key] != theirs[key] for key in COUNTS], axis=0)
        steady = cpu[f"{name}/steady"]
        test = ks_2samp(cpu[f"{name}/runs"], gpu[f"{name}/runs"])
        rows.append(
            {
                "scenario": name,
                "apart": float(apart[worst].max()),
                "term": worst,
                "counts": int((differs & steady).sum()),
                "steady": int(steady.sum()),
                "near": int((differs & ~steady).sum()),
                "p": float(test.pvalue),
                "ok": bool(
                    apart[worst].max() <= TOLERANCE
                    and not (differs & steady).any()
                    and test.pvalue >= CHANCE
                ),
            }
        )
    frame = pd.DataFrame(rows)
    frame.attrs["title"] = f"{gpu['card']} beside {cpu['card']}"
    frame.attrs["columns"] = {
        "apart": Column("terms differ by", "{:.1e}".format),
        "term": Column("most"),
        "counts": Column("other counts", out_of="steady"),
        "near": Column("within the margin"),
        "p": Column("p of runs", lambda p: significant(p, 2)),
        "ok": Column("agrees"),
    }
    return frame


def speed(cpu: dict[str, Any], gpu: dict[str, Any]) -> pd.DataFrame:
    """A row per algorithm and number of runs: seconds of both, evaluations per second."""
    rows = []
    for key in (key for key in gpu if key.startswith("seconds/")):
        _, algorithm, runs = key.split("/")
        count = gpu[f"evaluations/{algorithm}/{runs}"]
        rows.append(
            {
                "algorithm": algorithm,
                "runs": int(runs),
                "cpu": cpu[key],
                "gpu": gpu[key],
                "times": cpu[key] / gpu[key],
                "rate": count / gpu[key] / 1e6,
            }
        )
    frame = pd.DataFrame(rows)
    frame.attrs["title"] = "Seconds after compilation"
    frame.attrs["columns"] = {
        "cpu": Column(cpu["card"], duration),
        "gpu": Column(gpu["card"], duration),
        "times": Column("times as fast", lambda value: significant(value, 2)),
        "rate": Column("million evaluations/s", lambda value: significant(value, 3)),
    }
    return frame


def in_a_process(device: str, settings: dict[str, Any], folder: Path) -> dict[str, Any]:
    """`measured` by a process that computes on such a device."""
    file = folder / f"{device}.npz"
    command = [sys.executable, "-m", "benchmarks.gpu", "--measure", str(file)]
    command += ["--device", device, "--settings", json.dumps(settings)]
    done = subprocess.run(command, check=False)
    if done.returncode:
        sys.exit(done.returncode)  # it has said why
    with np.load(file) as kept:
        return {key: kept[key][()] for key in kept}


def main() -> int:
    """Measure on both and tell."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.gpu", description=__doc__)
    add = parser.add_argument
    add("--candidates", type=int, default=20_000, help="whose terms are compared")
    add("--runs", type=int, default=200, help="whose ends are compared, with other seeds")
    add("--batches", default="20,200,2000,20000", help="runs of the batches that are timed")
    add("--iterations", type=int, default=100, help="of every run")
    add("--output", type=Path, help="write the tables to this Markdown file")
    add("--measure", type=Path, help=argparse.SUPPRESS)
    add("--settings", type=json.loads, help=argparse.SUPPRESS)
    add("--device", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.measure:
        from jaxsusp.optim import devices

        devices.configure(keep=False, device=asked.device)
        np.savez(asked.measure, **measured(**asked.settings))
        return 0
    from rich.console import Console

    from jaxsusp.report.render import to_markdown, to_rich

    batches = [int(part) for part in asked.batches.split(",")]
    settings = {"candidates": asked.candidates, "runs": asked.runs, "batches": batches,
                "iterations": asked.iterations}  # fmt: skip
    clock = time.perf_counter()
    with tempfile.TemporaryDirectory() as scratch:
        gpu = in_a_process("gpu", {**settings, "seed": 0}, Path(scratch))
        cpu = in_a_process("cpu", {**settings, "seed": 1}, Path(scratch))
    tables = agreement(cpu, gpu), speed(cpu, gpu)
    console = Console()
    for table in tables:
        console.print(to_rich(table), "")
    console.print(f"measured in {time.perf_counter() - clock:.0f} s")
    if asked.output:
        asked.output.write_text("\n\n".join(map(to_markdown, tables)), encoding="utf-8")
    return 0 if tables[0]["ok"].all() else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
