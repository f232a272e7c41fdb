"""The same task stated otherwise: turned by quarter turns, mirrored, and (`restated`) moved."""

from typing import Any

import numpy as np

import jaxsusp as js
from jaxsusp.scenario.ownunits import PLACE, UNITS

DIRECTIONS = {"attachments", "center_of_mass"}
"""Vectors that are no places, and turn like them."""


def turned(scenario: js.Scenario, quarters: int, mirror: bool = False) -> js.Scenario:
    """A scenario turned about the vertical axis by quarter turns, and then x and y swapped.

    Workspace corners are put in order again; joint limits are as they were.
    """

    def turn(vector: Any) -> tuple[float, float, float]:
        x, y, z = vector
        for _ in range(quarters % 4):
            x, y = -y, x
        return (y, x, z) if mirror else (x, y, z)

    def changed(section: Any, units: dict[str, str]) -> Any:
        if section is None or isinstance(section, str):
            return section
        if isinstance(section, tuple):
            return tuple(changed(each, units) for each in section)
        update = {}
        for key, unit in units.items():
            if key not in type(section).model_fields:
                continue
            value = getattr(section, key)
            if unit == PLACE or key == "center_of_mass":
                update[key] = turn(value)
            elif key == "attachments" and not isinstance(value, str):
                update[key] = tuple(map(turn, value))
        if getattr(section, "yaw_deg", None) is not None:
            yaw = section.yaw_deg + 90 * quarters
            update["yaw_deg"] = 90 - yaw if mirror else yaw
        return section.model_copy(update=update)

    found = {name: changed(getattr(scenario, name), units) for name, units in UNITS.items()}
    box = found["workspace"]
    corners = [*zip(box.lower, box.upper, strict=True)]
    found["workspace"] = box.model_copy(
        update={"lower": tuple(map(min, corners)), "upper": tuple(map(max, corners))}
    )
    return js.Scenario.model_validate(
        scenario.model_copy(update=found).model_dump(), context={"folder": "."}
    )


def turned_points(points, quarters: int, mirror: bool = False):
    """Places turned as `turned` turns a scenario, (…, 3)."""
    x, y, z = (points[..., i] for i in range(3))
    for _ in range(quarters % 4):
        x, y = -y, x
    return np.stack([y, x, z] if mirror else [x, y, z], axis=-1)
