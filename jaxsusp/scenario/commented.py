"""A scenario as a file that explains itself: every key with its meaning, unit and default.

Keys that have their default stand behind a "#", which is all that has to go to change one. Texts
are the descriptions of `models`, which error messages give as well.
"""

import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from jaxsusp.scenario.models import Box, Cylinder, Ground, Mesh, Obstacle, Sphere, Statement
from jaxsusp.scenario.ownunits import frame_of, restated
from jaxsusp.scenario.toml import value_text

COLUMN, WIDTH = 36, 100
"""Where remarks begin, and where lines end."""

PREFACE = """\
Metres, kilograms, newtons, seconds; degrees where a name ends in _deg. World frame, z up.
A key behind a "#" has its default: take the "#" away and change the value. All other keys are
stated here; those whose remark names no default have to be."""

_TABLES = ("payload", "limits", "workspace", "ground", "task", "fitness")

_KINDS = '"box", "cylinder", "sphere" or "mesh"'

_INSTEAD = {
    "joint_limits_deg": ("[[[-180.0, 180.0], [-90.0, 90.0], [-170.0, 170.0]]]", "no limits"),
    "speed": ("0.5", "no limit"),
    "acceleration": ("0.5", "no limit"),
    "jerk": ("1.0", "no limit"),
    "cable_speed": ("0.5", "no limit"),
    "joint_speed_deg": ("90.0", "90 for arms that move"),
    "pieces": ("16", "16"),
    "size": ("[0.4, 0.3, 0.3]", "a cylinder"),
    "file": ('"part.stl"', "a cylinder"),
    "scale": ("1.0", "1"),
    "yaw_deg": ("0.0", "0"),
}
"""Of keys whose default cannot be written: an example, and what the default is in words."""


def commented(statement: Statement, origin: str) -> str:
    """A statement as TOML text with every key that there is, explained.

    Args:
        statement: its numbers are written as they are.
        origin: a sentence about where it comes from, for the first line.
    """
    lines = [f"# {line}" for line in [origin, *PREFACE.splitlines()]]
    fields = type(statement).model_fields
    plain = ["name", "drive", *["ground"] * (statement.ground == "none")]
    lines += ["", *_rows({key: fields[key] for key in plain}, statement)]
    for key in _TABLES:
        table = getattr(statement, key)
        if isinstance(table, BaseModel):
            lines += ["", *_table(f"[{key}]", table)]
        elif table is None:  # the ground
            lines += ["", *_behind(_default_ground(statement))]
    for number, robot in enumerate(statement.robots):
        lines += ["", *_table("[[robots]]", robot, explained=number == 0)]
    lines += _obstacles(statement)
    return "\n".join(lines) + "\n"


def _default_ground(statement: Statement) -> list[str]:
    lowest = min(robot.base[2] for robot in statement.robots)
    rows = _table("[ground]", Ground(height=lowest))
    instead = 'default: the lowest base; or no ground, by ground = "none" at the top of this file'
    return [*rows, *_remark("", instead)]


def _obstacles(statement: Statement) -> Iterator[str]:
    """All obstacles, the first of each kind explained; kinds that do not occur as examples."""
    told = set()
    for obstacle in statement.obstacles:
        yield from ("", *_table("[[obstacles]]", obstacle, explained=type(obstacle) not in told))
        told.add(type(obstacle))
    for example in _examples(statement):
        if type(example) not in told:
            yield from ("", *_behind(_table("[[obstacles]]", example)))


def _examples(statement: Statement) -> tuple[Obstacle, ...]:
    """One obstacle of each kind, in the size and place of a task."""
    center = (2.0, -2.0, 0.5)
    kinds = (
        Box(name="box", center=center, size=(0.6, 0.4, 1.0)),
        Cylinder(name="pillar", center=center, radius=0.2, height=1.0),
        Sphere(name="ball", center=center, radius=0.3),
        Mesh.model_construct(name="part", center=center, file="part.stl"),
    )
    alone = statement.model_copy(update={"obstacles": kinds})
    placed = restated(alone, frame_of(statement)).obstacles
    return tuple(type(each).model_construct(**plain_numbers(dict(each))) for each in placed)


def _table(header: str, table: BaseModel, explained: bool = True) -> list[str]:
    """One table; where it is not explained, the keys that differ from their default."""
    fields = type(table).model_fields
    if not explained:
        stated = {key: info for key, info in fields.items() if not _is_default(table, key, info)}
        return [header, *(_assigned(table, key) for key in stated)]
    about = (type(table).__doc__ or "").splitlines()[0].rstrip(".")
    return [*_remark(header, about), *_rows(fields, table)]


def _rows(fields: Mapping[str, FieldInfo], table: BaseModel) -> list[str]:
    """Every key with its remark; the kind of an obstacle is always stated."""
    lines = []
    for key, info in fields.items():
        text, remark = _assigned(table, key), info.description or _KINDS
        example, instead = _INSTEAD.get(key, ("", "")) if info.default is None else ("", "")
        if _is_default(table, key, info):
            text = f"# {key} = {example}" if example else f"# {text}"
            remark += f"; default: {instead}" if instead else ""
        elif not info.is_required() and info.default not in ("", None) and key != "kind":
            remark += f"; default {instead or value_text(info.default)}"
        lines += _remark(text, remark)
    return lines


def _is_default(table: BaseModel, key: str, info: FieldInfo) -> bool:
    return key != "kind" and not info.is_required() and getattr(table, key) == info.default


def _assigned(table: BaseModel, key: str) -> str:
    return f"{key} = {value_text(getattr(table, key))}"


def _remark(text: str, remark: str) -> list[str]:
    """A line with a remark behind it, in as many lines as the remark takes."""
    first, *others = textwrap.wrap(remark, WIDTH - COLUMN - 2)
    lines = [f"{'':{COLUMN}}# {each}" for each in others]
    if len(text) < COLUMN:
        return [f"{text:{COLUMN}}# {first}", *lines]
    return [text, f"{'':{COLUMN}}# {first}", *lines]


def _behind(lines: list[str]) -> list[str]:
    """Lines of a table that is not stated: all behind a "#", remarks in the same column."""
    return [line if line.startswith("# ") else f"# {line.replace('  #', '#', 1)}" for line in lines]


def plain_numbers(value: Any, digits: int = 10) -> Any:
    """A document with its numbers as a person would write them, without the last of rounding."""
    match value:
        case bool() | str() | None:
            return value
        case dict():
            return {key: plain_numbers(each, digits) for key, each in value.items()}
        case list() | tuple():
            return [plain_numbers(each, digits) for each in value]
        case _:
            return float(f"{value:.{digits}g}")
