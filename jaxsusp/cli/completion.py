"""What a shell offers while a command is typed: scenarios, files, algorithms, choices.

Texts are completed by Typer, which asks the functions here; nothing heavy is loaded for them.
"""

from collections.abc import Callable, Iterable
from pathlib import Path

from jaxsusp.optim.choices import ALGORITHMS, installed
from jaxsusp.scenario.builtin import examples, scenarios


def scenario_names(incomplete: str) -> list[str]:
    """Built-in scenarios that begin so, and TOML files and folders that do."""
    named = [name for name in (*scenarios(), *examples()) if name.startswith(incomplete)]
    return named + files(incomplete, ".toml")


def algorithm_names(incomplete: str) -> list[str]:
    """Algorithms that begin so, and the libraries whose own names follow."""
    named = [*ALGORITHMS, *(f"{library}:" for library in installed())]
    return [name for name in named if name.startswith(incomplete)]


def files(incomplete: str, suffix: str) -> list[str]:
    """Files of a suffix, and folders, whose paths begin so."""
    folder, _, begun = incomplete.rpartition("/")
    place = Path(f"{folder}/" if "/" in incomplete else ".")
    try:
        there = sorted(each for each in place.iterdir() if each.name.startswith(begun))
    except OSError:
        return []
    before = f"{folder}/" if "/" in incomplete else ""
    visible = [each for each in there if begun.startswith(".") or not each.name.startswith(".")]
    return [
        f"{before}{each.name}{'/' if each.is_dir() else ''}"
        for each in visible
        if each.is_dir() or each.suffix == suffix
    ]


def one_of(choices: Iterable[str]) -> Callable[[str], list[str]]:
    """A completion from a few words."""

    def complete(incomplete: str) -> list[str]:
        return [each for each in choices if each.startswith(incomplete)]

    return complete


def some_of(names: Callable[[str], list[str]]) -> Callable[[str], list[str]]:
    """A completion of names separated by commas; none of them is offered twice."""

    def complete(incomplete: str) -> list[str]:
        before, comma, last = incomplete.rpartition(",")
        return [f"{before}{comma}{each}" for each in names(last) if each not in before.split(",")]

    return complete
