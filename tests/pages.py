"""Examples in Markdown pages, the README among them: they run as they stand, only shorter."""

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]

SHORTER = {
    r'js\.plan\("scenario-1"': r'\g<0>, "pso", runs=2, iterations=60, population=20, seed=1',
    r'(js\.compare\(\["scenario-1"\].*?), runs=20': (
        r'\1, runs=2, iterations=6, population=8, search="box"'
    ),
    r'(js\.compare\()(algorithms=\[)"pso"(.*), runs=20': (
        r'\1["scenario-1", "scenario-3"], \2"ga"\3, runs=4, iterations=40, population=30'
    ),
    r"runs=20": "runs=2, iterations=6, population=8",
}
"""What an example says, and what it says in a test: sizes that other tests compile as well."""


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
    """Run a program with few runs and iterations."""
    code = example.text
    for said, shorter in SHORTER.items():
        code = re.sub(said, shorter, code)
    exec(compile(code, example.name, "exec"), {"__name__": "example"})
