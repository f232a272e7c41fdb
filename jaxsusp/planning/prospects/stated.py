"""What a scenario states and what it leaves to defaults, and whether those fit its size."""

from collections.abc import Iterator
from typing import NamedTuple

from pydantic import BaseModel

from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import UNITS, frame_of
from jaxsusp.scenario.toml import value_text

LIKE = 1.5
"""Ratio to the benchmark's size, or its mass, up to which its defaults are taken to fit."""


_UNLIMITED = ("speed", "acceleration", "jerk", "cable_speed")
"""Limits of motion, which a file may state."""

_IN_WORDS = {
    "ground": "at the lowest base", "joint_limits_deg": "none",
    "pieces": "16",
    "joint_speed_deg": "90 where arms move", **dict.fromkeys(_UNLIMITED, "none"),
}  # fmt: skip
"""What the absence of a value means."""


class Key(NamedTuple):
    """One key of a scenario file."""

    table: str  # "" at the top of the file; "robots[0]", "obstacles[2]"
    key: str
    value: str  # as it is written in TOML
    given: bool  # whether the file states it

    @property
    def path(self) -> str:
        """Its name with that of its table."""
        return f"{self.table}.{self.key}" if self.table else self.key


def keys_of(scenario: Statement) -> tuple[Key, ...]:
    """Every key of a scenario in the order of a file, tables that are left out included."""
    return tuple(_keys("", scenario))


def _keys(table: str, model: BaseModel) -> Iterator[Key]:
    for key in type(model).model_fields:
        value, given = getattr(model, key), key in model.model_fields_set
        path = f"{table}.{key}" if table else key
        if isinstance(value, BaseModel):
            yield from _keys(path, value)
        elif isinstance(value, tuple) and value and isinstance(value[0], BaseModel):
            for number, each in enumerate(value):
                yield from _keys(f"{path}[{number}]", each)
        else:
            if value is None and table == "payload":
                continue  # of loads of another shape
            if key == "pieces" and getattr(model, "shape", None) != "pieces":
                continue  # there are none
            yield Key(table, key, _IN_WORDS[key] if value is None else value_text(value), given)


def unfitting(scenario: Statement) -> tuple[str, ...]:
    """Keys left to defaults in metres, newtons or seconds that are the benchmark's.

    Nothing where the task is of about the benchmark's size and mass.
    """
    frame = frame_of(scenario)

    def alike(number: float) -> bool:
        return 1 / LIKE <= number <= LIKE

    sized = {key for table in UNITS.values() for key in table} - {"tension"}
    heavy = set() if alike(frame.mass) else {"tension"}
    unlike = heavy if alike(frame.length) else sized | heavy
    unlike -= {
        "center_of_mass",
        "scale",
        "attachments",
        "joint_speed_deg",
        *_UNLIMITED,
    }  # none in any size
    return tuple(key.path for key in keys_of(scenario) if not key.given and key.key in unlike)
