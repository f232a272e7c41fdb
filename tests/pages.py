"""Examples in Markdown pages, the README among them: they run as they stand, only shorter."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]

SHORT = {
    "js.compare": "runs=4, iterations=40, population=30",  # with ga, as in other tests
    "js.plan(": "runs=2, iterations=60, population=20",
    "": "runs=2, iterations=6, population=8",
}
"""What takes the place of an example's number of runs, by what it calls."""


class Example(NamedTuple):
    """A fenced block of a page."""

    name: str  # the page and the number of the block
    text: str


def examples(page: Path, language: str) -> list[Example]:
    """The blocks of a page in a language."""
    text = page.read_text(encoding="utf-8")
    found = re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    name = page.relative_to(ROOT).as_posix()
    return [Example(f"{name}:{i}", text) for i, text in enumerate(found)]


def run(example: Example) -> None:
    """Run a program with few runs and iterations, and where it names none with two scenarios.

    The sizes are those of other tests, whose compiled programs it shares.
    """
    code = example.text
    few = next(short for call, short in SHORT.items() if call in code)
    code = re.sub(r"runs=\d+(, iterations=\d+)?", few, code).replace('["pso", ', '["ga", ')
    code = code.replace(
        "js.compare(algorithms", 'js.compare(["scenario-1", "scenario-3"], algorithms'
    )
    exec(compile(code, example.name, "exec"), {"__name__": "example"})
