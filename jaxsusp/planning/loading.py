"""Plans from disk, exactly as they were written; those of older versions are brought up to date."""

import os
from pathlib import Path
from typing import Any

import numpy as np

from jaxsusp.errors import InputError, ScenarioError
from jaxsusp.planning.document import REMEDY, numbers, read, restored
from jaxsusp.planning.plan import ARRAYS, Plan
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.verify.certificate import Certificate, Clearance, Contact
from jaxsusp.verify.constraints import Check


def load_plan(path: str | os.PathLike[str]) -> Plan:
    """Read a plan exactly as it was written.

    Raises:
        InputError: the file is missing, cut short, edited, written by a newer version, or no plan.
    """
    path = Path(path)
    document = read(path)
    try:
        return _plan(document, path)
    except ScenarioError as error:
        raise InputError(
            f"{path}: the scenario in it cannot be used: {error}; put back the files it names or "
            "plan again"
        ) from error
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: is not a complete plan ({error!r}); {REMEDY}") from error


def _plan(document: dict[str, Any], path: Path) -> Plan:
    scenario = Scenario.from_toml(document["scenario"], path)
    if scenario.digest != document["scenario_digest"]:
        changed = any(obstacle.kind == "mesh" for obstacle in scenario.obstacles)
        what = "a mesh that its scenario names" if changed else "what its scenario means"
        raise InputError(f"{path}: {what} has changed since; restore it or plan again")
    document = _brought_up(document, scenario.task.duration)
    arrays, sizes = {}, {"cables": len(scenario.robots)}
    for field, (name, shape) in ARRAYS.items():
        array = np.array(numbers(document[name]), np.float64)
        shape = shape[1:] if field == "ends" and sizes["rows"] == 1 else shape
        wanted = tuple(
            sizes.setdefault(size, length) if isinstance(size, str) else size
            for size, length in zip(shape, array.shape, strict=True)
        )
        if array.shape != wanted:
            raise ValueError(f"{name} has shape {array.shape}, not {wanted}")
        arrays[field] = array
    if sizes["rows"] not in (1, sizes["points"]) or sizes["points"] < 3:
        raise ValueError(f"{sizes['rows']} rows of end_path_m beside {sizes['points']} of path_m")
    times, arc = arrays["law_times"], arrays["law_arc"]
    if len(times) < 2 or times[0] != 0 or (np.diff(times) <= 0).any() or (np.diff(arc) < 0).any():
        raise ValueError("law_times_s or law_arc_m does not rise from 0")
    certificate = document["certificate"]
    return Plan(
        scenario,
        bool(document["feasible"]),
        tuple(map(str, document["reasons"])),
        **arrays,
        report=tuple(_line(each, certificate) for each in document["report"]),
        certificate=Certificate(
            bool(certificate["proved"]),
            tuple(Clearance(**_pair(each)) for each in certificate["clearances"]),
            tuple(Contact(**_pair(each)) for each in certificate["contacts"]),
            int(certificate["distances"]),
        ),
        settings=restored(document["settings"]),
    )


def _brought_up(document: dict[str, Any], duration: float) -> dict[str, Any]:
    """A document of an older schema as one of this.

    Plans of the first had still ends and hooks, those of the first two the minimum-jerk law.
    """
    if document["schema"] < 2:
        level = [[0.0] * 3 for _ in document["times_s"]]
        document = {**document, "end_path_m": [document["ends_m"]], "angles_rad": level}
    if document["schema"] < 3:
        length = SmoothPath(np.array(numbers(document["path_m"]), np.float64)).length
        rest = [0.0, 0.0]
        document = {
            **document, "law_times_s": [0.0, duration], "law_arc_m": [0.0, length],
            "law_speed_m_per_s": rest, "law_acceleration_m_per_s2": rest,
        }  # fmt: skip
    return document


def _line(table: dict[str, Any], certificate: dict[str, Any]) -> Check:
    """A line of the report; before the third version nothing but distances was proved."""
    found = Check(**restored(table))
    if "proved" in table:
        return found
    return found._replace(
        proved=found.ok and certificate["proved"] and found.name.startswith("distance of")
    )


def _pair(table: dict[str, Any]) -> dict[str, Any]:
    first, second = table["bodies"]
    return {**restored(table), "bodies": (str(first), str(second))}
