"""A `Scenario`: a planning task that was looked at and is fit for use, from TOML and back."""

import hashlib
import json
import os
import tomllib
from pathlib import Path

from pydantic import ValidationError, model_validator

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.admissible import inadmissible
from jaxsusp.scenario.builtin import find, read
from jaxsusp.scenario.messages import translate
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.toml import dumps


class Scenario(Statement):
    """One planning task: load, robots, obstacles, start and goal.

    A scenario is admissible: at start and goal the load is in its workspace, below and between
    the ends, and clear of obstacles with all its cables; every end is in its robot's reach.
    Building one in Python raises pydantic's `ValidationError` instead of `ScenarioError`, and
    pydantic's `model_copy` checks nothing.
    """

    @model_validator(mode="after")
    def _is_admissible(self) -> "Scenario":
        try:
            problems = inadmissible(self)
        except ValueError as error:  # pydantic would take a fault of ours for a person's
            raise RuntimeError("the checks of a scenario failed") from error
        if problems:
            raise ScenarioError(*problems)
        return self

    @classmethod
    def from_toml(cls, text: str, source: str | os.PathLike[str] = "scenario.toml") -> "Scenario":
        """Read a scenario from TOML text.

        Args:
            text: the text.
            source: the file it stands for: its folder anchors the paths of meshes, its stem is
                the default name, and every line of an error begins with it. It is not opened.

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
            return cls.model_validate(document, context={"folder": source.parent})
        except ValidationError as error:
            lines = translate(error, cls, document)
            raise ScenarioError(*(f"{source}: {line}" for line in lines)) from None

    def to_toml(self) -> str:
        """The scenario as TOML text with every value stated; paths of meshes are absolute."""
        return dumps(self.model_dump(exclude_none=True))

    @property
    def digest(self) -> str:
        """SHA-256 of the content: all values and the bytes of meshes, wherever the files lie."""
        content = self.model_dump(exclude_none=True)  # a new key changes no digest until it is used
        content["limits"].setdefault("joint_limits_deg", None)  # was there before this rule
        for obstacle in content["obstacles"]:
            if obstacle["kind"] == "mesh":
                data = Path(obstacle["file"]).read_bytes()
                obstacle["file"] = hashlib.sha256(data).hexdigest()
        text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()


Named = str | os.PathLike[str]
"""A scenario's name or its file: what every public function takes in place of a scenario."""


def load_scenario(name_or_path: Named | Scenario) -> Scenario:
    """Load a built-in scenario or example by its name, or any scenario from its TOML file.

    A scenario is returned as it is.

    Raises:
        ScenarioError: no such scenario, an unreadable file, or one line per problem in it.
    """
    if isinstance(name_or_path, Scenario):
        return name_or_path
    path = find(name_or_path)
    return Scenario.from_toml(read(path), path)
