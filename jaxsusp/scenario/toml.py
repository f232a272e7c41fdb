"""Write TOML: as much of it as a scenario needs, which `tomllib` (a reader only) does not offer."""

import json
from collections.abc import Mapping, Sequence


def dumps(document: Mapping[str, object]) -> str:
    """A document of plain values, tables and arrays of tables, one level deep, as TOML text."""
    plain = {key: value for key, value in document.items() if not _tables(value)}
    lines = _assignments(plain)
    for key, value in document.items():
        header = f"[{key}]" if isinstance(value, Mapping) else f"[[{key}]]"
        for table in _tables(value):
            lines += ["", header, *_assignments(table)]
    return "\n".join(lines) + "\n"


def value_text(value: object) -> str:
    """One value as it stands in a TOML file."""
    match value:
        case bool():
            return "true" if value else "false"
        case int() if value.bit_length() > 64:
            return hex(value)  # Python refuses to write very long integers in decimal
        case str():
            # A JSON string is a TOML basic string, but for DEL, which only TOML wants escaped.
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case list() | tuple():
            return f"[{', '.join(map(value_text, value))}]"
        case _:
            return str(value)


def _assignments(table: Mapping[str, object]) -> list[str]:
    return [f"{key} = {value_text(value)}" for key, value in table.items()]


def _tables(value: object) -> Sequence[Mapping[str, object]]:
    """The tables a value consists of; none for a plain value."""
    if isinstance(value, Mapping):
        return [value]
    if isinstance(value, list | tuple) and all(isinstance(row, Mapping) for row in value):
        return value
    return []
