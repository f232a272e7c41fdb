"""JSON files of plans: format, version and digest, and numbers in full precision.

Names carry the units, and a digest over everything else tells whether a file is as it was written.
Infinities and NaN, which JSON has no words for, are the texts "inf", "-inf" and "nan".
"""

import hashlib
import json
import math
import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from jaxsusp._files import write_text
from jaxsusp.errors import InputError

FORMAT, SCHEMA = "jaxsusp plan", 3

REMEDY = "give a file that `jaxsusp plan` wrote"


def stem(name: str) -> str:
    """What files of a scenario of this name are called."""
    return re.sub(r"[^\w.-]+", "-", name).strip("-.")[:60] or "plan"


def write(document: dict[str, Any], path: str | os.PathLike[str]) -> None:
    """Write a document with its digest, atomically, one entry per line."""
    document = {"format": FORMAT, "schema": SCHEMA, **document}
    document = {**document, "digest": digest(document)}
    lines = (f"  {json.dumps(key)}: {_text(value)}" for key, value in document.items())
    write_text(path, "{\n" + ",\n".join(lines) + "\n}\n")


def read(path: Path) -> dict[str, Any]:
    """The content of a file whose format, schema and digest are right.

    Raises:
        InputError: the file is missing, cut short, edited, written by a newer version, or no plan.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; {REMEDY}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not text; {REMEDY}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); {REMEDY}") from error
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: is not complete JSON ({error.msg}, line {error.lineno}): it was cut short or "
            "damaged; copy it again or plan again"
        ) from None
    except (RecursionError, ValueError):
        raise InputError(f"{path}: is not a plan; {REMEDY}") from None
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InputError(f'{path}: is not a plan (no "format": "{FORMAT}"); {REMEDY}')
    schema = document.get("schema")
    if not isinstance(schema, int) or isinstance(schema, bool) or schema < 1:
        raise InputError(f"{path}: schema = {schema!r} is not a version of plans; {REMEDY}")
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


def digest(document: dict[str, Any]) -> str:
    """SHA-256 of a document's content without its digest."""
    content = {key: value for key, value in document.items() if key != "digest"}
    return hashlib.sha256(_text(content, sort_keys=True).encode()).hexdigest()


def plain(value: Any) -> Any:
    """Arrays and tuples as lists, numbers that JSON does not know as texts."""
    match value:
        case np.ndarray() | np.generic():
            return plain(value.tolist())
        case float() if not math.isfinite(value):
            return str(value)
        case dict():
            return {key: plain(each) for key, each in value.items()}
        case list() | tuple():
            return [plain(each) for each in value]
        case _:
            return value


def numbers(value: Any) -> Any:
    """Nested lists of numbers; texts other than the three special numbers are refused."""
    if isinstance(value, list):
        return [numbers(each) for each in value]
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise TypeError(f"{value!r} is not a number")
    return float(value)


_SPECIAL = {"inf": math.inf, "-inf": -math.inf, "nan": math.nan}


def restored(table: dict[str, Any]) -> dict[str, Any]:
    """A flat table with its special numbers put back."""
    return {
        key: _SPECIAL.get(value, value) if isinstance(value, str) else value
        for key, value in table.items()
    }


def _text(value: Any, **options: Any) -> str:
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False, allow_nan=False, **options)
