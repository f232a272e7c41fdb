"""Plans on disk: one JSON file that loads back exactly, and a CSV of the samples.

The names carry the units, the scenario is embedded as its TOML, and a digest over everything else
tells whether the file is as it was written. Numbers are written in full precision; infinities and
NaN, which JSON has no words for, are the texts "inf", "-inf" and "nan".
"""

import csv
import hashlib
import io
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from jaxsusp._files import write_text
from jaxsusp.errors import InputError
from jaxsusp.plans import Plan
from jaxsusp.scenario import Scenario, ScenarioError
from jaxsusp.verify.certificate import Certificate, Clearance, Contact
from jaxsusp.verify.limits import Check

FORMAT, SCHEMA = "jaxsusp plan", 2

ARRAYS = {
    "waypoints": ("waypoints_m", ("waypoints", 3)),
    "path": ("path_m", ("points", 3)),
    "end_path": ("end_path_m", ("rows", "cables", 3)),
    "times": ("times_s", ("samples",)),
    "position": ("position_m", ("samples", 3)),
    "velocity": ("velocity_m_per_s", ("samples", 3)),
    "acceleration": ("acceleration_m_per_s2", ("samples", 3)),
    "jerk": ("jerk_m_per_s3", ("samples", 3)),
    "lengths": ("lengths_m", ("samples", "cables")),
    "tensions": ("tensions_N", ("samples", "cables")),
    "angles": ("angles_rad", ("samples", 3)),
    "ends": ("ends_m", ("samples", "cables", 3)),  # without the samples where the ends stay
    "joints": ("joints_rad", ("samples", "cables", 3)),
}
"""Arrays of a plan: their names in the file and their shapes."""

_REMEDY = "give a file that `jaxsusp plan` wrote"


def save(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a plan as JSON, atomically."""
    write_text(path, dumps(plan))


def dumps(plan: Plan) -> str:
    """A plan as JSON text, one array per line."""
    document = {
        "format": FORMAT,
        "schema": SCHEMA,
        "feasible": plan.feasible,
        "reasons": list(plan.reasons),
        **{name: _plain(getattr(plan, field)) for field, (name, _) in ARRAYS.items()},
        "report": [_plain(each._asdict()) for each in plan.report],
        "certificate": _certificate(plan.certificate),
        "settings": _plain(dict(plan.settings)),
        "scenario_digest": plan.scenario.digest,
        "scenario": plan.scenario.to_toml(),
    }
    document = {**document, "digest": digest(document)}
    lines = (f"  {json.dumps(key)}: {_text(value)}" for key, value in document.items())
    return "{\n" + ",\n".join(lines) + "\n}\n"


def digest(document: dict[str, Any]) -> str:
    """SHA-256 of a document's content without its digest."""
    content = {key: value for key, value in document.items() if key != "digest"}
    return hashlib.sha256(_text(content, sort_keys=True).encode()).hexdigest()


def load_plan(path: str | os.PathLike[str]) -> Plan:
    """Read a plan exactly as it was written.

    Raises:
        InputError: the file is missing, cut short, edited, written by a newer version, or no plan.
    """
    path = Path(path)
    document = _document(path)
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
        raise InputError(f"{path}: is not a complete plan ({error!r}); {_REMEDY}") from error


def _document(path: Path) -> dict[str, Any]:
    """The content of a file whose format, schema and digest are right."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; {_REMEDY}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text; {_REMEDY}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); {_REMEDY}") from error
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: is not complete JSON ({error.msg}, line {error.lineno}): it was cut short or "
            "damaged; copy it again or plan again"
        ) from None
    except (RecursionError, ValueError):
        raise InputError(f"{path}: is not a plan; {_REMEDY}") from None
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(f'{path}: is not a plan (no "format": "{FORMAT}"); {_REMEDY}')
    schema = document.get("schema")
    if not isinstance(schema, int) or isinstance(schema, bool) or schema < 1:
        raise InputError(f"{path}: schema = {schema!r} is not a version of plans; {_REMEDY}")
    if schema > SCHEMA:
        raise InputError(
            f"{path}: was written by a newer version of jaxsusp (schema {schema}, this one reads "
            f"up to {SCHEMA}); update jaxsusp"
        )
    try:
        known = digest(document)
    except (ValueError, RecursionError):  # NaN written as JSON does not know it
        known = ""
    if document.get("digest") != known:
        raise InputError(
            f"{path}: its digest does not match its content: it was edited by hand or damaged; "
            "restore the file, or change the task and plan again"
        )
    return document


def _plan(document: dict[str, Any], path: Path) -> Plan:
    document = _brought_up(document)
    scenario = Scenario.from_toml(document["scenario"], path)
    if scenario.digest != document["scenario_digest"]:
        raise InputError(
            f"{path}: a mesh that its scenario names has changed since; restore it or plan again"
        )
    arrays, sizes = {}, {"cables": len(scenario.robots)}
    for field, (name, shape) in ARRAYS.items():
        array = np.array(_numbers(document[name]), np.float64)
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
    certificate = document["certificate"]
    return Plan(
        scenario,
        bool(document["feasible"]),
        tuple(map(str, document["reasons"])),
        **arrays,
        report=tuple(Check(**_restored(each)) for each in document["report"]),
        certificate=Certificate(
            bool(certificate["proved"]),
            tuple(Clearance(**_pair(each)) for each in certificate["clearances"]),
            tuple(Contact(**_pair(each)) for each in certificate["contacts"]),
            int(certificate["distances"]),
        ),
        settings=_restored(document["settings"]),
    )


def _brought_up(document: dict[str, Any]) -> dict[str, Any]:
    """A document of an older schema as one of this: plans of the first had still ends and hooks."""
    if document["schema"] > 1:
        return document
    level = [[0.0] * 3 for _ in document["times_s"]]
    return {**document, "end_path_m": [document["ends_m"]], "angles_rad": level}


def save_csv(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write the samples of a plan, one row each, with the units in the column names."""
    cables = range(1, plan.lengths.shape[1] + 1)
    columns = {"time_s": plan.times}
    kinematics = (("position", "m"), ("velocity", "m_per_s"), ("acceleration", "m_per_s2"),
                  ("jerk", "m_per_s3"))  # fmt: skip
    for field, unit in kinematics:
        values = getattr(plan, field)
        columns |= {f"{axis}_{field}_{unit}": values[:, i] for i, axis in enumerate("xyz")}
    columns |= {f"alpha_{i + 1}_rad": plan.angles[:, i] + 0.0 for i in range(3)}
    columns |= {f"length_{k}_m": plan.lengths[:, k - 1] for k in cables}
    columns |= {f"tension_{k}_N": plan.tensions[:, k - 1] for k in cables}
    ends = np.broadcast_to(plan.ends, plan.joints.shape)
    for k in cables:
        end = ends[:, k - 1]
        columns |= {f"end_{k}_{axis}_m": end[:, i] for i, axis in enumerate("xyz")}
        columns |= {f"joint_{k}_{i + 1}_rad": plan.joints[:, k - 1, i] for i in range(3)}
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(values.tolist() for values in columns.values()), strict=True))
    write_text(path, buffer.getvalue())


def _certificate(certificate: Certificate) -> dict[str, Any]:
    return {
        "proved": certificate.proved,
        "distances": certificate.distances,
        "clearances": [_plain(each._asdict()) for each in certificate.clearances],
        "contacts": [_plain(each._asdict()) for each in certificate.contacts],
    }


def _plain(value: Any) -> Any:
    """Arrays and tuples as lists, numbers that JSON does not know as texts."""
    match value:
        case np.ndarray() | np.generic():
            return _plain(value.tolist())
        case float() if not math.isfinite(value):
            return str(value)
        case dict():
            return {key: _plain(each) for key, each in value.items()}
        case list() | tuple():
            return [_plain(each) for each in value]
        case _:
            return value


def _numbers(value: Any) -> Any:
    """Nested lists of numbers; texts other than the three special numbers are refused."""
    if isinstance(value, list):
        return [_numbers(each) for each in value]
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise TypeError(f"{value!r} is not a number")
    return float(value)


_SPECIAL = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}


def _restored(table: dict[str, Any]) -> dict[str, Any]:
    """A flat table with its special numbers put back."""
    return {
        key: _SPECIAL.get(value, value) if isinstance(value, str) else value
        for key, value in table.items()
    }


def _pair(table: dict[str, Any]) -> dict[str, Any]:
    first, second = table["bodies"]
    return {**_restored(table), "bodies": (str(first), str(second))}


def _text(value: Any, **options: Any) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False, **options)
