"""Our optimisers and other libraries' side by side: the same fitness, bounds and budget."""

import argparse
import json
import os
import platform
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from benchmarks.peers.task import Peer

LIBRARIES = ("evosax", "pymoo", "mealpy", "pyswarms", "scipy", "cma", "pygmo")
QUICK = {"runs": 2, "iterations": 20, "repeats": 1}


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    add = parser.add_argument
    names = lambda text: text.split(",")  # noqa: E731
    add("--scenarios", type=names, default=["scenario-1"], help="names or files, by commas")
    add("--peers", type=names, default=list(LIBRARIES), help="libraries, or such as pymoo:GA")
    add("--runs", type=int, default=20, help="runs of every optimiser (default 20)")
    add("--iterations", type=int, default=500, help="iterations of a run (default 500)")
    add("--population", type=int, default=30, help="candidates of an iteration (default 30)")
    add("--repeats", type=int, default=5, help="turns of ours and the peer (default 5)")
    add("--cores", type=int, default=1, help="cores that everybody may use (default 1)")
    add("--quick", action="store_true", help="only see that everything runs: one short turn")
    add("--output", type=Path, default=Path("results"), help="folder of bench-peers.json and .md")
    add("--keep", action="store_true", help="keep the numbers for the page of the site, write it")
    add("--page", action="store_true", help="only write the page again, from the kept numbers")
    asked = parser.parse_args()
    if asked.quick:
        vars(asked).update(QUICK)
    return asked


def confined(cores: int) -> None:
    """Leave this process so many cores; libraries and JAX find no others."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-cores:])


def chosen(names: Sequence[str]) -> "list[Peer]":
    """The peers of these names; a library that is not installed is told in one line."""
    found = []
    for library in LIBRARIES:
        wanted = [name for name in names if name.partition(":")[0] == library]
        if not wanted:
            continue
        try:
            peers = import_module(f"benchmarks.peers.libraries.{library}").PEERS
        except ModuleNotFoundError as error:
            print(f"{library} is left out: {error}")
            continue
        found += [peer for peer in peers if {library, f"{library}:{peer.name}"} & {*wanted}]
    return found


def measured(asked: argparse.Namespace) -> dict[str, Any]:
    """Measure every peer on every scenario, with a line for each on the way."""
    import jax

    from benchmarks.peers.measure import beside, clock_of
    from benchmarks.peers.task import Task

    load, there = os.getloadavg()[0], os.cpu_count()
    peers = chosen(asked.peers)
    scenarios: dict[str, list[dict[str, Any]]] = {}
    for scenario in asked.scenarios:
        task = Task.of(scenario, asked.runs, asked.iterations, asked.population)
        for peer in peers:
            row = beside(peer, task, asked.repeats, clock_of(asked.cores))
            scenarios.setdefault(scenario, []).append(row)
            print(
                f"{scenario}, {peer.library}:{peer.name}: {row['peer']['seconds']:.2f} s, "
                f"{row['ratio']:.1f} of {peer.ours} ({row['ratio_least']:.1f} to "
                f"{row['ratio_most']:.1f})",
                flush=True,
            )
    packages = ["jax", "numpy", *dict.fromkeys(peer.library for peer in peers)]
    kept = ("runs", "iterations", "population", "repeats")
    return {
        "settings": {name: getattr(asked, name) for name in kept},
        "machine": {
            "processor": platform.machine(),
            "cores": asked.cores,
            "there": there,
            "load": round(load, 1),
            "devices": len(jax.devices()),
        },
        "versions": {"Python": platform.python_version()}
        | {name: version(name) for name in packages},
        "scenarios": scenarios,
    }


def main() -> None:
    """Measure, print tables, and write them."""
    asked = arguments()
    from benchmarks.peers import tables

    if asked.page:
        tables.write_page(json.loads(tables.KEPT.read_text(encoding="utf-8")))
        return
    confined(asked.cores)

    from rich.console import Console

    from jaxsusp._files import write_text
    from jaxsusp.optim.devices import configure
    from jaxsusp.report.render import to_rich

    configure(devices=asked.cores)
    numbers = measured(asked)
    console = Console()
    for frame in tables.frames(numbers):
        console.print("", to_rich(frame))
    asked.output.mkdir(parents=True, exist_ok=True)
    text = json.dumps(numbers, indent=2) + "\n"
    write_text(asked.output / "bench-peers.json", text)
    write_text(asked.output / "bench-peers.md", tables.markdown(numbers))
    if asked.keep:
        write_text(tables.KEPT, text)
        tables.write_page(numbers)


if __name__ == "__main__":
    main()
