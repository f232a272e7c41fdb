"""`{help} NAME` shows `jaxsusp NAME --help`; `{commands}` lists all commands there are.

The list names every command with its page, or with its help where nobody wrote a page.
"""

import importlib
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from .runs import execute, tidy


def help_of(name: str) -> str:
    """What `jaxsusp NAME --help` prints."""
    return tidy(execute(["bash", "-ec", " ".join(["jaxsusp", name, "--help"])]).stdout)


def all_commands() -> dict[str, str]:
    """Names of the commands, in their order, and what each is for."""
    importlib.import_module("jaxsusp.cli.run")
    app = importlib.import_module("jaxsusp.cli.application").app
    found = {}
    for each in app.registered_commands:
        words = (each.callback.__doc__ or "").strip().split("\n\n")[0]
        found[each.name or each.callback.__name__] = " ".join(words.split())
    return found


class Help(SphinxDirective):
    """`{help} NAME`."""

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The command and its help."""
        name = self.arguments[0] if self.arguments else ""
        typed = " ".join(["$ jaxsusp", *([name] if name else []), "--help"])
        blocks = [
            nodes.literal_block(text, text, language=language, classes=[kind])
            for text, language, kind in (
                (typed, "console", "typed"), (help_of(name), "text", "output")
            )
        ]  # fmt: skip
        return [nodes.container("", *blocks, classes=["run"])]


class Commands(SphinxDirective):
    """`{commands}`."""

    def run(self) -> list[nodes.Node]:
        """A table of all commands, and the help of those that have no page."""
        here = Path(self.env.doc2path(self.env.docname)).parent
        lines = ["| command | what it does |", "| :--- | :--- |"]
        unwritten = []
        for name, purpose in all_commands().items():
            if (here / f"{name}.md").exists():
                lines.append(f"| [`jaxsusp {name}`]({name}.md) | {purpose} |")
            else:
                lines.append(f"| [`jaxsusp {name}`](#jaxsusp-{name}) | {purpose} |")
                unwritten += [f"(jaxsusp-{name})=", f"## jaxsusp {name}", ""]
                unwritten += [f"```{{help}} {name}", "```", ""]
        return self.parse_text_to_nodes(
            "\n".join([*lines, "", *unwritten]), allow_section_headings=True
        )


def setup(app: Sphinx) -> dict[str, bool]:
    """Add `{help}` and `{commands}`."""
    app.add_directive("help", Help)
    app.add_directive("commands", Commands)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
