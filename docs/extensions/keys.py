"""`{keys} TABLE` lists the keys of a table of a scenario file, from the models that read it."""

import json
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective


def rows(table: str) -> list[tuple[str, str, str]]:
    """Key, default and meaning of every key; `Statement` is the file's top level."""
    from jaxsusp.scenario import models

    found = []
    for name, field in getattr(models, table).model_fields.items():
        default = "required" if field.is_required() else f"`{_plain(field.default)}`"
        if name == "kind":
            default = "required"
        meaning = field.description or f"`{_plain(field.default)}`"
        found.append((f"`{name}`", default, meaning))
    return found


def _plain(value: Any) -> str:
    if hasattr(value, "model_dump"):
        return "as listed there"
    if value is None:
        return "none"
    return json.dumps(value)


class Keys(SphinxDirective):
    """`{keys} TABLE`."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """A table of three columns."""
        lines = ["| key | default | meaning |", "| :--- | :--- | :--- |"]
        lines += [f"| {' | '.join(row)} |" for row in rows(self.arguments[0])]
        return self.parse_text_to_nodes("\n".join(lines))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add `{keys}`."""
    app.add_directive("keys", Keys)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
