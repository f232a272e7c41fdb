"""A `Scenario`: a planning task that was looked at and is fit for use, from TOML and back."""

import hashlib
import json
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import PrivateAttr, ValidationError, model_validator

from jaxsusp._showing import Shown
from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.admissible import inadmissible
from jaxsusp.scenario.builtin import find, read
from jaxsusp.scenario.messages import translate
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import UNCHANGED, Frame, in_own_units
from jaxsusp.scenario.toml import dumps


class Scenario(Statement, Shown):
    """One planning task: load, robots, obstacles, start and goal.

    A scenario is admissible: at start and goal the load is in its workspace, below and between
    the ends, and clear of obstacles with all its cables; every end is in its robot's reach.
    Building one in Python raises pydantic's `ValidationError` instead of `ScenarioError`, and
    pydantic's `model_copy` checks nothing. One that was read with `task_checked=False` may be
    inadmissible at start and goal, as `troubles` tells: it can be mapped, not planned.

    What computes takes it in its own units (`own`), and gives back what it found in those of the
    scenario it was asked about, by `units`.
    """

    _frame: Frame | None = PrivateAttr(None)  # of a scenario in own units: whence it came
    _troubles: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="after")
    def _is_admissible(self, info: Any) -> "Scenario":
        try:
            problems, troubles = inadmissible(self)
        except ValueError as error:  # pydantic would take a fault of ours for a person's
            raise RuntimeError("the checks of a scenario failed") from error
        if (info.context or {}).get("task_checked", True):
            problems, troubles = problems + troubles, []
        if problems:
            raise ScenarioError(*problems)
        self._troubles = tuple(troubles)
        return self

    def __repr__(self) -> str:
        obstacles, robots = len(self.obstacles), len(self.robots)
        plural = "s" * (obstacles != 1)
        return (
            f"<Scenario {self.name!r}: {robots} robots, {obstacles} obstacle{plural}, "
            f"drive {self.drive!r}>"
        )

    __str__ = __repr__

    @classmethod
    def from_toml(
        cls,
        text: str,
        source: str | os.PathLike[str] = "scenario.toml",
        task_checked: bool = True,
    ) -> "Scenario":
        """Read a scenario from TOML text.

        Args:
            text: the text.
            source: the file it stands for: its folder anchors the paths of meshes, its stem is
                the default name, and every line of an error begins with it. It is not opened.
            task_checked: whether a start or goal that is inadmissible is an error; if not, it is
                one of the `troubles`.

        Raises:
            ScenarioError: one line per problem, with file, field, value and remedy.
        """
        source = Path(source)
        try:
            document = tomllib.loads(text)
        except RecursionError:
            raise ScenarioError(f"{source}: is nested too deeply; flatten it") from None
        except ValueError as error:
            raise ScenarioError(f"{source}: is not valid TOML: {error}; correct it") from None
        document.setdefault("name", source.stem)
        try:
            context = {"folder": source.parent, "task_checked": task_checked}
            return cls.model_validate(document, context=context)
        except ValidationError as error:
            lines = translate(error, cls, document)
            raise ScenarioError(*(f"{source}: {line}" for line in lines)) from None

    def to_toml(self) -> str:
        """The scenario as TOML text with every value stated; paths of meshes are absolute."""
        return dumps(self.model_dump(exclude_none=True))

    def model_copy(
        self, *, update: Mapping[str, Any] | None = None, deep: bool = False
    ) -> "Scenario":
        """A copy, unchecked where something is updated: it then knows of no troubles."""
        found = super().model_copy(update=update, deep=deep)
        if update:
            found._troubles = ()
        return found

    @property
    def troubles(self) -> tuple[str, ...]:
        """What is wrong with start and goal, a line each; empty unless they were not checked."""
        return self._troubles

    @property
    def own(self) -> "Scenario":
        """The task in its own units and frame, unchecked; itself where it is in them already."""
        if self._frame is not None:
            return self
        found, frame = in_own_units(self)
        assert isinstance(found, Scenario)
        if found is not self:
            found._frame, found._troubles = frame, self._troubles
        return found

    @property
    def frame(self) -> Frame:
        """How numbers of this scenario become SI units in the world's frame, for words."""
        return self._frame or UNCHANGED

    @property
    def units(self) -> Frame:
        """How numbers in own units become numbers of this scenario."""
        return UNCHANGED if self._frame is not None else self.own.frame

    @property
    def digest(self) -> str:
        """SHA-256 of the content: all values and the bytes of meshes, wherever the files lie."""
        content = self.model_dump(exclude_none=True)  # a new key changes no digest until it is used
        content["limits"].setdefault("joint_limits_deg", None)  # was there before this rule
        for obstacle in [content["payload"], *content["obstacles"]]:
            if "file" in obstacle:
                data = Path(obstacle["file"]).read_bytes()
                obstacle["file"] = hashlib.sha256(data).hexdigest()
        text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()


Named = str | os.PathLike[str]
"""A scenario's name or its file: what every public function takes in place of a scenario."""


def load_scenario(name_or_path: Named | Scenario, task_checked: bool = True) -> Scenario:
    """Load a built-in scenario or example by its name, or any scenario from its TOML file.

    A scenario is returned as it is.

    Args:
        name_or_path: which.
        task_checked: whether a start or goal that is inadmissible is an error; if not, it is one
            of the scenario's `troubles`, and everything but maps refuses that scenario.

    Raises:
        ScenarioError: no such scenario, an unreadable file, or one line per problem in it.
    """
    if isinstance(name_or_path, Scenario):
        if task_checked and name_or_path.troubles:
            raise ScenarioError(*name_or_path.troubles)
        return name_or_path
    path = find(name_or_path)
    return Scenario.from_toml(read(path), path, task_checked)
