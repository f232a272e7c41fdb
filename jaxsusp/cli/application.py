"""What all commands share: the application, options that mean the same everywhere, endings."""

import json
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console
from rich.table import Table

app = typer.Typer(
    name="jaxsusp",
    help="Obstacle-avoidance planning for multi-robot suspension systems.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _whole(text: str | int) -> int:  # defaults come as numbers
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r}; give a whole number.") from None


def count(meaning: str):
    """An option that takes a whole number."""
    return typer.Option(help=meaning, parser=_whole, metavar="<int>")


Output = Annotated[Path, typer.Option(help="Folder for what is written.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
Named = Annotated[str, typer.Argument(metavar="SCENARIO", help="A built-in name or a TOML file.")]


def names(listed: str) -> list[str]:
    """Names separated by commas."""
    return [name.strip() for name in listed.split(",") if name.strip()]


def note(message: str) -> None:
    """Tell a person something that is not the result."""
    print(message, file=sys.stderr)


def fail(message: str) -> NoReturn:
    """End because of bad input."""
    note(message)
    sys.exit(2)


def interrupted(message: str) -> NoReturn:
    """End because of Ctrl-C, saying what is kept."""
    note(f"Interrupted: {message}")
    raise typer.Exit(130)


@contextmanager
def interrupts() -> Iterator[Callable[[], None]]:
    """Let no Ctrl-C get lost; lends a function that raises those that came at a bad moment.

    JAX runs a callback in every garbage collection, where Python prints exceptions and goes on.
    """
    missed = False

    def handle(_, frame) -> None:
        nonlocal missed
        missed = frame is not None and frame.f_code.co_name == "_xla_gc_callback"
        if not missed:
            raise KeyboardInterrupt

    def raise_if_missed() -> None:
        if missed:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:  # as for a job in the background of a script
        signal.signal(signal.SIGINT, handle)
    try:
        yield raise_if_missed
    finally:
        signal.signal(signal.SIGINT, before)


def wide_console() -> Console:
    """Stdout for tables of seven columns: into a pipe they are not cut at 80 characters."""
    stdout = Console()
    return stdout if stdout.is_terminal else Console(width=max(stdout.width, 132))


def print_rows(rows: list[dict], as_json: bool) -> None:
    """A plain listing, for people or for machines."""
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in rows[0]:
        table.add_column(name)
    for row in rows:
        table.add_row(*(str(value) for value in row.values()))
    Console().print(table)
