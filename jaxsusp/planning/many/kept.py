"""A folder of plans: a file for each, and a list of what was asked and what became of it."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from jaxsusp._files import write_text
from jaxsusp.errors import InputError
from jaxsusp.planning.document import plain, stem
from jaxsusp.planning.loading import load_plan
from jaxsusp.planning.plan import Plan
from jaxsusp.scenario.scenario import Named, Scenario

LIST = "plans.json"


class Task(NamedTuple):
    """A scenario that is to be planned, or why it cannot be."""

    name: str
    source: Scenario | Named
    scenario: Scenario | None  # None where it cannot be read
    failure: str = ""

    @property
    def digest(self) -> str:
        """Of its content; "" where there is none."""
        return self.scenario.digest if self.scenario is not None else ""


class Planned(NamedTuple):
    """What became of one of many scenarios."""

    name: str
    plan: Plan | None  # None where there is none at all
    failure: str  # why not; "" where there is a plan, feasible or not
    seconds: float
    file: Path | None = None

    @property
    def feasible(self) -> bool:
        """Whether there is a plan that stands."""
        return self.plan is not None and self.plan.feasible

    @property
    def reason(self) -> str:
        """Why there is no plan that stands; "" where there is."""
        if self.plan is None:
            return self.failure
        return "" if self.feasible else "; ".join(self.plan.reasons)


class Folder:
    """Where plans are kept; without a folder nothing is.

    Args:
        place: the folder, or None.
        settings: of all plans, plain values; what was made with others is not gone on from.
    """

    def __init__(self, place: str | os.PathLike[str] | None, settings: Mapping[str, Any]):
        self.place = None if place is None else Path(place)
        self._settings = json.loads(json.dumps(plain(dict(settings))))
        self._rows: dict[str, dict[str, Any]] = {}

    def finished(self, tasks: Sequence[Task]) -> dict[int, Planned]:
        """What is there already of these tasks, by their numbers.

        Raises:
            InputError: it was made with other settings, or the list is damaged.
        """
        rows, found = self._listed(), {}
        for number, task in enumerate(tasks):
            row = rows.get(task.name)
            if row is None or not task.digest or row["digest"] != task.digest:
                continue
            file = None if row["file"] is None else self._there / row["file"]
            if file is not None and not file.exists():
                continue
            plan = None if file is None else load_plan(file)
            self._rows[task.name] = row
            found[number] = Planned(task.name, plan, row["failure"], row["seconds"], file)
        return found

    def keep(self, task: Task, found: Planned) -> Planned:
        """Write a plan, and that it is there."""
        if self.place is None:
            return found
        self.place.mkdir(parents=True, exist_ok=True)
        if found.plan is not None:
            file = self.place / f"{stem(task.name)}.plan.json"
            found.plan.save(file)
            found = found._replace(file=file)
        self._rows[task.name] = {
            "digest": task.digest,
            "feasible": found.feasible,
            "failure": found.failure,
            "seconds": found.seconds,
            "file": found.file and found.file.name,
        }
        content = {"settings": self._settings, "plans": self._rows}
        write_text(self.place / LIST, json.dumps(content, indent=2) + "\n")
        return found

    @property
    def _there(self) -> Path:
        assert self.place is not None
        return self.place

    def _listed(self) -> dict[str, dict[str, Any]]:
        path = self._there / LIST
        if not path.exists():
            return {}
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            known, rows = content["settings"], content["plans"]
        except (ValueError, KeyError, TypeError):
            raise InputError(
                f"{path}: is no list of plans; remove it, or choose another folder"
            ) from None
        for name, value in self._settings.items():
            if known.get(name) != value:
                raise InputError(
                    f"{path}: its plans were made with {name} = {known.get(name)!r}, not {value!r};"
                    " resume with the same, or choose another folder"
                )
        return rows
