"""What the canaries took at every release: a small file for each, with machine and versions."""

import json
import platform
import statistics
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

import jaxsusp
from benchmarks.check.compared import median_interval
from jaxsusp._files import write_text
from jaxsusp.optim.devices import cores
from jaxsusp.report.render import Column

KEPT = Path(__file__).parents[1] / "history"

COMMAND = "python -m benchmarks.check --keep"

_PACKAGES = ("jax", "jaxlib", "numpy", "scipy", "cvxpy", "clarabel", "mujoco")


def processor() -> str:
    """What the processor calls itself."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def entry(seconds: dict[str, Sequence[float]], load: float) -> dict[str, Any]:
    """A release's file: medians over the turns, and their intervals.

    Args:
        seconds: of every canary, one per turn.
        load: of the machine before it began.
    """
    return {
        "release": jaxsusp.__version__,
        "made": datetime.now(UTC).date().isoformat(),
        "command": COMMAND,
        "machine": {"processor": processor(), "cores": cores(), "load": round(load, 1)},
        "versions": {"python": platform.python_version()}
        | {name: version(name) for name in _PACKAGES},
        "turns": len(next(iter(seconds.values()))),
        "seconds": {
            name: {
                "median": round(statistics.median(each), 5),
                "from": round(median_interval(each).low, 5),
                "to": round(median_interval(each).high, 5),
            }
            for name, each in seconds.items()
        },
    }


def keep(found: dict[str, Any], folder: Path = KEPT) -> Path:
    """Write a release's file."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{found['release']}.json"
    write_text(path, json.dumps(found, indent=2) + "\n")
    return path


def entries(folder: Path = KEPT) -> list[dict[str, Any]]:
    """All that is kept, the oldest release first."""
    kept = [json.loads(path.read_text(encoding="utf-8")) for path in folder.glob("*.json")]
    return sorted(kept, key=lambda each: [int(part) for part in each["release"].split(".")])


def table(kept: Sequence[dict[str, Any]]) -> pd.DataFrame:
    """A row per release, a column of medians per canary."""
    rows = [
        {
            "release": each["release"],
            **{name: times["median"] for name, times in each["seconds"].items()},
            "machine": f"{each['machine']['processor']}, {each['machine']['cores']} cores",
        }
        for each in kept
    ]
    frame = pd.DataFrame(rows)
    frame.attrs["title"] = "Seconds of the canaries by release"
    frame.attrs["columns"] = {
        name: Column(f"{name} (s)", "{:.4f}".format) for name in kept[-1]["seconds"]
    }
    return frame
