"""A task in its own units and frame: what everything inside the package computes with.

A task that is moved elsewhere, scaled or carried out with another mass is the same task. Inside,
its lengths count in ninths of the robots' mean total link length, its masses in tenths of the
payload's, its times so that g keeps its number, and its places from the centroid of the bases. The
benchmark's robots and loads have these units and this frame from the start, and their numbers stay
as they are. All others are rounded to `GRID`, so that a task moved to map coordinates or scaled is
nearly always the very same numbers wherever it is: float32 and random searches see no difference.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.scenario.models import Statement

DECIMALS = 7
GRID = 10.0**-DECIMALS
"""What numbers in own units are whole multiples of."""

TOUCH = 1e-6
"""Own units of length by which a distance may miss its limit and still keep it."""

LINKS, PAYLOAD = 9.0, 10.0
"""Own units per mean total link length, and per payload: those of the benchmark in m and kg."""

DIMENSIONS = {
    "m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1),
    "1/m": (-1, 0, 0), "m³": (3, 0, 0),
    "m/s": (1, 0, -1), "m/s²": (1, 0, -2), "m/s³": (1, 0, -3),
    "N": (1, 1, -2), "N m": (2, 1, -2), "N/m": (0, 1, -2), "N s/m": (0, 1, -1),
    "N m/s²": (2, 1, -4),
    "1": (0, 0, 0), "": (0, 0, 0), "rad": (0, 0, 0), "°": (0, 0, 0), "%": (0, 0, 0),
    "rad/s": (0, 0, -1), "°/s": (0, 0, -1),
}  # fmt: skip
"""Exponents of length, mass and time of every unit that numbers are given in."""

PLACE, HEIGHT, SCALE = "place", "height", "scale"
"""What is no plain number in a unit: coordinates in the world's frame and a z alone, which move
with the frame (m), and a factor from the unit of a file (m per such unit)."""

UNITS: dict[str, dict[str, str]] = {
    "payload": {
        "mass": "kg", "radius": "m", "height": "m", "attachments": "m", "center_of_mass": "m",
        "size": "m", "scale": SCALE,
    },
    "limits": {
        "tension": "N", "cable_length": "m", "clearance": "m", "cable_radius": "m",
        "separation": "m", "speed": "m/s", "acceleration": "m/s²", "jerk": "m/s³",
        "cable_speed": "m/s", "joint_speed_deg": "°/s",
    },
    "workspace": {"lower": PLACE, "upper": PLACE},
    "ground": {"height": HEIGHT},
    "task": {"start": PLACE, "goal": PLACE, "duration": "s"},
    "robots": {
        "base": PLACE, "links": "m", "end": PLACE, "link_radius": "m", "column_radius": "m",
    },
    "obstacles": {
        "center": PLACE, "size": "m", "radius": "m", "height": "m", "scale": SCALE,
    },
}  # fmt: skip
"""Units of the keys of a scenario file; keys that are not here have none."""


class Frame(NamedTuple):
    """How numbers in own units become those of a statement: SI units in the world's frame.

    Without arguments, the frame in which nothing changes.
    """

    length: float = 1.0  # m per unit of length
    mass: float = 1.0  # kg per unit of mass
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m

    @property
    def inverse(self) -> "Frame":
        """The frame that undoes this one."""
        x, y, z = (-c / self.length + 0.0 for c in self.origin)
        return Frame(1 / self.length, 1 / self.mass, (x, y, z))

    def factor(self, unit: str) -> float:
        """What a number in own units is multiplied by to be one in a unit of `DIMENSIONS`."""
        length, mass, time = DIMENSIONS[unit]
        return self.length ** (length + time / 2) * self.mass**mass

    def place(self, points: Any) -> Float[np.ndarray, "*batch xyz"]:
        """Places (m) of places in own units."""
        if self == UNCHANGED:
            return np.asarray(points, np.float64)
        return self.length * np.asarray(points, np.float64) + self.origin

    def inside(self, places: Any) -> Float[np.ndarray, "*batch xyz"]:
        """Places in own units of places (m)."""
        return (np.asarray(places, np.float64) - self.origin) / self.length

    def number(self, value: Any, unit: str) -> Any:
        """A number or an array of numbers in a unit of `DIMENSIONS`."""
        return value * self.factor(unit)

    def thousandths(self, length: float) -> str:
        """A length in m for people, to a thousandth of the own unit or finer."""
        return f"{length:.{max(3, 3 - math.floor(math.log10(self.length)))}f}"

    def words(self, point: Any) -> str:
        """A place for people, (x, y, z) in m."""
        return in_words(self.place(point))


UNCHANGED = Frame()
"""The frame in which nothing changes."""


def in_words(point: Any) -> str:
    """A place for people, (x, y, z) in m: four digits, and a millimetre of those far away."""
    return f"({', '.join(_coordinate(float(c)) for c in point)})"


def _coordinate(c: float) -> str:
    return f"{c:.4g}" if abs(c) < 1000 else f"{c:.3f}".rstrip("0").rstrip(".")


def frame_of(statement: Statement) -> Frame:
    """The own units and frame of a task."""
    length = float(np.mean([sum(robot.links) for robot in statement.robots])) / LINKS
    centroid = np.mean([robot.base for robot in statement.robots], axis=0)
    x, y, z = np.where(np.abs(centroid) < 1e-9 * length, 0.0, centroid).tolist()  # but for rounding
    return Frame(length, statement.payload.mass / PAYLOAD, (x, y, z))


def in_own_units(statement: Statement) -> tuple[Statement, Frame]:
    """A statement in its own units, unchecked; the very same one where it is in them already."""
    frame = frame_of(statement)
    return (statement if frame == UNCHANGED else _converted(statement, frame, _owned)), frame


def restated(statement: Statement, frame: Frame) -> Statement:
    """The same task elsewhere, in another size and with another mass, unchecked.

    Args:
        statement: any, its numbers taken as those that the frame changes.
        frame: what becomes of them.
    """
    return _converted(statement, frame, _stated)


Rule = Callable[[Any, str, Frame], Any]
"""A number, or a place, in a unit, changed by a frame."""


def _converted(statement: Statement, frame: Frame, rule: Rule) -> Statement:
    """A statement with every number that has a unit changed."""
    update = {
        section: _section(getattr(statement, section), units, frame, rule)
        for section, units in UNITS.items()
    }
    return statement.model_copy(update=update)


def _section(section: Any, units: dict[str, str], frame: Frame, rule: Rule) -> Any:
    """A table of a statement, or several."""
    if section is None or isinstance(section, str):
        return section
    if isinstance(section, tuple):
        return tuple(_section(each, units, frame, rule) for each in section)
    there = {key: unit for key, unit in units.items() if key in type(section).model_fields}
    values = {key: _value(getattr(section, key), unit, frame, rule) for key, unit in there.items()}
    return section.model_copy(update=values)


def _value(value: Any, unit: str, frame: Frame, rule: Rule) -> Any:
    """A number, a place, or nested tuples of numbers; a word, or no limit, is kept."""
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, tuple) and unit != PLACE:
        return tuple(_value(each, unit, frame, rule) for each in value)
    return rule(value, unit, frame)


def _owned(value: Any, unit: str, frame: Frame) -> Any:
    """In own units, on the grid. A scale is a factor and no length: it keeps its digits."""
    if unit == PLACE:
        return tuple((frame.inside(value).round(DECIMALS) + 0.0).tolist())
    if unit == HEIGHT:
        return _owned((0.0, 0.0, value), PLACE, frame)[2]
    if unit == SCALE:
        return value / frame.length
    found = value / frame.factor(unit)
    rounded = round(found, DECIMALS) + 0.0
    return rounded or (GRID if found > GRID / 1000 else 0.0)  # a thin cable stays one


def _stated(value: Any, unit: str, frame: Frame) -> Any:
    if unit == PLACE:
        return tuple(frame.place(value).tolist())
    if unit == HEIGHT:
        return _stated((0.0, 0.0, value), PLACE, frame)[2]
    return frame.number(value, "m" if unit == SCALE else unit)
