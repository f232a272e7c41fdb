"""Print how fitness and free space take many obstacles: `python -m benchmarks.crowd`.

The more of them, the smaller they are, and between them the benchmark's load has its way. Drawn
scenes (`jaxsusp.random_scenario`) are proved to be solvable, which takes long for many obstacles;
here most stand on the ground, and a few are in the way or hang.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from pydantic import ValidationError
from rich.console import Console
from rich.table import Table

from jaxsusp.freespace.build import Growth, free_space
from jaxsusp.optim.devices import configure, cores
from jaxsusp.problem.problem import Problem
from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.scenario import Scenario, load_scenario

COUNTS = (10, 100, 300, 1000)
CANDIDATES = 600

NEAR = 0.5
"""m by which waypoints of candidates near the straight line stray from it, along every axis."""

CLEAR = 0.5
"""m that obstacles keep from start and goal, seen from above."""

FEW = 24
"""Obstacles at most that reach up to the load's way or hang above it."""


def crowd(count: int, seed: int = 0) -> Scenario:
    """The benchmark's first task among so many obstacles.

    They stand in squares of the workspace's floor, which are drawn, and leave gaps on all sides.
    """
    random = np.random.default_rng([seed, count])
    given = load_scenario(scenarios()[0])
    lower, upper = np.array(given.workspace.lower), np.array(given.workspace.upper)
    squares = int(np.ceil(np.sqrt(2 * count)))
    edge = (upper - lower)[:2] / squares
    places = lower[:2] + edge * (np.indices((squares, squares)).reshape(2, -1).T + 0.5)
    ends = np.array([given.task.start, given.task.goal])[:, None, :2]
    free = (np.linalg.norm(places - ends, axis=-1) > CLEAR + edge.max() / 2).all(axis=0)
    places = random.permutation(places[free])[:count]
    places[1] = ends.mean(axis=(0, 1))  # one of those that reach up blocks the straight way
    few = min(FEW, count // 2)
    rows: list[dict] = []
    for i, place in enumerate(places):
        wide, low = random.uniform(0.3, 0.6) * edge.min(), random.uniform(0.1, 0.9)
        chosen = _obstacle(i, place, wide, 0.0, low)
        if i < few:
            bottom, high = (0.0, 3.0) if i % 2 else (4.0, wide)
            reaching = _obstacle(i, place, wide, bottom, high)
            chosen = reaching if _clear(given, reaching) else chosen
        rows.append(chosen)
    return _with(given, f"crowd-{count}", rows)


def _with(given: Scenario, name: str, rows: list[dict]) -> Scenario:
    stated = given.model_dump(exclude={"obstacles", "name"})
    return Scenario.model_validate(stated | {"name": name, "obstacles": rows})


def _clear(given: Scenario, row: dict) -> bool:
    """Whether an obstacle leaves start and goal clear."""
    try:
        _with(given, "alone", [row])
    except ValidationError:
        return False
    return True


def _obstacle(number: int, place: np.ndarray, wide: float, bottom: float, high: float) -> dict:
    """A box, a cylinder or a ball in its turn, from a height upwards."""
    x, y = (float(each) for each in place)
    row = {
        "name": f"thing {number + 1}",
        "center": [round(x, 3), round(y, 3), round(bottom + high / 2, 3)],
    }
    match number % 3:
        case 0:
            size = [round(wide, 3), round(0.8 * wide, 3), round(high, 3)]
            return row | {"kind": "box", "size": size, "yaw_deg": float(number % 90)}
        case 1:
            size = {"radius": round(wide / 2, 3), "height": round(high, 3)}
            return row | {"kind": "cylinder"} | size
        case _:
            return row | {"kind": "sphere", "radius": round(wide / 2, 3)}


class Spent(NamedTuple):
    """Processor time and time by the clock (s)."""

    processor: float
    clock: float

    @classmethod
    def by(cls, work: Callable[[], Any]) -> "Spent":
        """What a call takes."""
        processor, clock = time.process_time(), time.perf_counter()
        jax.block_until_ready(work())
        return cls(time.process_time() - processor, time.perf_counter() - clock)


def evaluation(problem: Problem, spread: float | None, repeats: int = 7) -> float:
    """Processor seconds per candidate, least of several; the clock's are of no use when shared.

    Args:
        problem: what is evaluated, single precision, on one device.
        spread: how far waypoints stray from the straight line (m); None: anywhere.
        repeats: how often.
    """
    random = jax.random.uniform(jax.random.key(0), (CANDIDATES, problem.dim), jnp.float32)
    if spread is None:
        x = problem.low + (problem.high - problem.low) * random
    else:
        x = problem.reference + spread * (2 * random - 1)
    problem = jax.tree.map(jnp.asarray, problem)
    evaluate = jax.jit(Problem.evaluate)
    jax.block_until_ready(evaluate(problem, x))
    spent = [Spent.by(lambda: evaluate(problem, x)) for _ in range(repeats)]
    return min(each.processor for each in spent) / CANDIDATES


def measured(count: int, console: Console) -> dict:
    """All numbers of one scene."""
    scene = crowd(count)
    found: dict = {"obstacles": count}
    problem = Problem.from_scenario(scene, search="box", dtype=np.float32)
    for name, spread in (("anywhere", None), ("near the line", NEAR)):
        found[f"{name} (µs)"] = 1e6 * evaluation(problem, spread)
    spaces = []

    def told(growth: Growth) -> None:
        console.print(
            f"{count} obstacles: {growth.regions} regions, {growth.coverage:.1%}", end="\r"
        )

    spent = Spent.by(lambda: spaces.append(free_space(scene, cache=False, progress=told)))
    (space,) = spaces
    return found | {
        "free space, processor (s)": spent.processor,
        "clock (s)": spent.clock,
        "bodies": space.details["bodies"],
        "regions": len(space.d),
        "covered": space.coverage,
        "connected": space.connected,
    }


def main() -> None:
    """Measure, print, and write the numbers where asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.crowd", description=__doc__)
    parser.add_argument("--counts", type=int, nargs="+", default=COUNTS, help="obstacles")
    parser.add_argument("--output", type=Path, help="write the numbers to this JSON file")
    arguments = parser.parse_args()
    configure(keep=False)
    console = Console()
    rows = [measured(count, console) for count in arguments.counts]
    table = Table(*rows[0], box=None)
    for row in rows:
        table.add_row(*(f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.values()))
    console.print(f"processor time per candidate, {CANDIDATES} of them; {cores()} cores", table)
    if arguments.output:
        arguments.output.write_text(json.dumps(rows, indent=2))


if __name__ == "__main__":
    main()
