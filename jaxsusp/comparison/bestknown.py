"""The best known fitness of a task: what a comparison measures its algorithms against.

Best known is not optimal: it is the lowest fitness of a trajectory without any collision or
violated limit that has been kept so far, and `experiments/best_known.py` keeps better ones. The
records are in `data/best_known.json`, one a line, with the waypoints that prove each value.
"""

import functools
import json
from pathlib import Path
from typing import Any

from jaxsusp.scenario.scenario import Named, Scenario, load_scenario

FILE = Path(__file__).parent / "data" / "best_known.json"


def best_known(scenario: Named | Scenario, waypoints: int = 5, samples: int = 40) -> float | None:
    """The lowest fitness known of a scenario, or None where none is known.

    Args:
        scenario: the scenario. Its whole content counts, weights and name included: a record holds
            for nothing that differs in any of it.
        waypoints: free waypoints m between start and goal.
        samples: trajectory samples n.
    """
    return value_of(load_scenario(scenario).digest, waypoints, samples)


def value_of(digest: str | None, waypoints: int | None, samples: int | None) -> float | None:
    """The same for a scenario of which there is only the digest; None stands for anything else."""
    record = _by_task(FILE).get((digest, waypoints, samples))
    return None if record is None else record["fitness"]


def records(file: Path = FILE) -> list[dict[str, Any]]:
    """What is known, a record per task.

    Each has `scenario` (name), `digest`, `waypoints`, `samples`, `fitness` (float64), `found` (how)
    and `waypoints_m`, the decision vector.
    """
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else []


@functools.cache
def _by_task(file: Path) -> dict[tuple, dict[str, Any]]:
    return {(each["digest"], each["waypoints"], each["samples"]): each for each in records(file)}
