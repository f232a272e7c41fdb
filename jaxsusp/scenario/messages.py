"""What is wrong with a scenario, in sentences for the person who wrote it.

Every problem is one line: the field, its value, what is wrong with it and what to do, as in
`obstacles[1] "tower".size[2] = -3.66 must be greater than 0; give the full size [x, y, z] in m`.
"""

import difflib
import re
from collections.abc import Iterable, Mapping
from types import NoneType, UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.toml import value_text


def sentence(path: str, value: object, wrong: str, remedy: str) -> str:
    """The one form of a line; a table is not shown, it would only hide the sentence."""
    shown = short(value)
    return f"{path}{f' = {shown}' if shown else ''} {wrong}; {remedy}"


def numbered(key: str, index: int, name: object = "") -> str:
    """One row of an array of tables: `obstacles[1] "tower"`."""
    label = f" {short(name)}" if isinstance(name, str) and name else ""
    return f"{key}[{index}]{label}"


def short(value: object, width: int = 60) -> str:
    """A plain value or a list of them as written in TOML, cut to `width`; of tables nothing."""
    rows = value if isinstance(value, list | tuple) else [value]
    if any(isinstance(row, Mapping | list | tuple) for row in rows):
        return ""
    text = value_text(value)
    return text if len(text) <= width else f"{text[:width]}…"


def suggestion(given: object, known: Iterable[str]) -> str:
    """Name the nearest of the known words, or else all of them."""
    known = list(known)
    near = difflib.get_close_matches(str(given), known, n=1, cutoff=0.5)
    return f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"


def translate(error: ValidationError, schema: type[BaseModel], document: Mapping) -> list[str]:
    """One line per problem for all that pydantic found in a document."""
    lines: list[str] = []
    short_of: set[tuple[int | str, ...]] = set()
    for details in error.errors(include_url=False):
        cause, loc = details.get("ctx", {}).get("error"), details["loc"]
        if details["type"] == "missing" and isinstance(loc[-1], int):
            if loc[:-1] in short_of:
                continue  # one line for a list, however many of its entries are missing
            short_of.add(loc[:-1])
        if isinstance(cause, ScenarioError):
            lines += cause.problems
        else:
            lines.append(_line(details, _locate(schema, document, loc)))
    return lines


_WRONG = {
    "float_type": "must be a number",
    "finite_number": "must be finite",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:g}",
    "less_than_equal": "must be at most {le:g}",
    "string_type": "must be text in quotes",
    "string_too_short": "must not be empty",
    "literal_error": "is not one of the choices",
    "tuple_type": "must be a list",
    "too_long": "has {actual_length} entries, more than {max_length}",
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "value_error": "{error}",
}


class RefusalError(ValueError):
    """What is wrong with a value, and what to do where the description of its field is no help."""

    def __init__(self, wrong: str, remedy: str = ""):
        super().__init__(wrong)
        self.remedy = remedy


class _Place(NamedTuple):
    """Where in a document an error is."""

    path: str  # as the person would say it
    section: type[BaseModel]  # the table of the innermost named field
    key: str  # that field

    @property
    def remedy(self) -> str:
        field = self.section.model_fields.get(self.key)
        return f"give {field.description}" if field else "give a scenario"


def _line(error: ErrorDetails, place: _Place) -> str:
    path, value, context = place.path, error["input"], error.get("ctx", {})
    match error["type"]:
        case "missing":
            return f"{path} is missing; {place.remedy}"
        case "extra_forbidden":
            known = suggestion(place.key, place.section.model_fields)
            return sentence(path, value, "is not a known key", known)
        case "union_tag_not_found":
            return f"{path}.kind is missing; {place.remedy}"
        case "union_tag_invalid":
            kinds = context["expected_tags"].replace("'", "").split(", ")
            known = suggestion(context["tag"], kinds)
            return sentence(f"{path}.kind", value["kind"], "is not a known kind", known)
        case "float_type" if type(value) is int:
            return sentence(path, value, "is too large", place.remedy)
        case kind:
            wrong = _WRONG.get(kind, "cannot be used").format(**context)
            remedy = getattr(context.get("error"), "remedy", "") or place.remedy
            return sentence(path or "the scenario", value, wrong, remedy)


def _locate(schema: Any, document: Any, steps: Iterable[int | str]) -> _Place:
    """Follow pydantic's steps through the schema and the document at once.

    Behind a tagged union pydantic adds a step of its own, the tag of the chosen member
    (`obstacles, 1, box, size`); it is not part of the path.
    """
    path, section, key = "", schema, ""
    for step in steps:
        schema = _bare(schema)
        if get_origin(schema) in (Union, UnionType):
            schema = _member(schema, step)
        elif isinstance(step, int):
            document = _inside(document, step)
            path = numbered(path, step, document.get("name") if _is_table(document) else "")
            schema = next(iter(get_args(schema)), None)
        else:
            document = _inside(document, step)
            path, section, key = f"{path}.{_word(step)}".lstrip("."), schema, step
            field = schema.model_fields.get(step)
            schema = field and field.annotation
    return _Place(path, section, key)


def _bare(annotation: Any) -> Any:
    """`Annotated[X, …]` → X and `X | None` → X."""
    if get_origin(annotation) is Annotated:
        return _bare(get_args(annotation)[0])
    if NoneType in get_args(annotation):
        return _bare(get_args(annotation)[0])
    return annotation


def _member(union: Any, tag: int | str) -> Any:
    """The model that carries the tag, or None where the tag means no model."""
    models = [(member, _bare(member)) for member in get_args(union)]
    tagged = {_tag(member, model): model for member, model in models if _is_model(model)}
    return tagged.get(str(tag))


def _tag(member: Any, model: Any) -> str:
    """What tells a member of a union: its `Tag`, or else the default of its kind."""
    given = [each.tag for each in get_args(member)[1:] if isinstance(each, Tag)]
    return given[0] if given else model.model_fields["kind"].default


def _is_model(annotation: Any) -> bool:
    return hasattr(annotation, "model_fields")


def _inside(document: Any, step: int | str) -> Any:
    try:
        return document[step]
    except (LookupError, TypeError):
        return None


def _word(key: str) -> str:
    """A key as TOML wants it: in quotes unless it is made of plain letters."""
    return key if re.fullmatch(r"[\w-]+", key, re.ASCII) else short(key)


def _is_table(document: Any) -> bool:
    return isinstance(document, Mapping)
