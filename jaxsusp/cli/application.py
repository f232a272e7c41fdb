"""The application and what all commands share: what is said, and how they end.

Commands import what they need when they run: help and mistakes are answered at once.
"""

import functools
import sys
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from jaxsusp import __version__
from jaxsusp.cli.commandgroup import Commands

if TYPE_CHECKING:
    from rich.console import Console

    from jaxsusp.suspension.misplaced import Misplaced

app = typer.Typer(
    name="jaxsusp",
    cls=Commands,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _print_version(asked: bool | None) -> None:
    if asked:
        print(f"jaxsusp {__version__}")
        raise typer.Exit


@app.callback()
def jaxsusp(
    version: Annotated[
        bool | None,
        typer.Option(
            "--version",
            callback=_print_version,
            is_eager=True,
            metavar="",
            help="Print the version and exit.",
        ),
    ] = None,
) -> None:
    """Obstacle-avoidance planning for multi-robot suspension systems."""


def command(epilog: str) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Make a function a command of its name, which Ctrl-C ends with one line and status 130."""

    def register(function: Callable[..., None]) -> Callable[..., None]:
        @app.command(epilog=epilog)
        @functools.wraps(function)
        def run(*arguments: Any, **options: Any) -> None:
            try:
                function(*arguments, **options)
            except KeyboardInterrupt:
                interrupted(f"{function.__name__} was not finished.")

        return run

    return register


def note(message: str) -> None:
    """Tell a person something that is not the result."""
    print(message, file=sys.stderr)


def tell_misplaced(blocked: "Sequence[Misplaced]") -> None:
    """Say where the load must not be, and where else it could: part of the result."""
    from rich.console import Console

    console = Console()
    for each in blocked:
        for reason in each.reasons:
            console.print(reason, style="bold", markup=False, highlight=False)
        console.print(each.remedy, markup=False, highlight=False)


def fail(message: str) -> NoReturn:
    """End because of bad input."""
    note(message)
    sys.exit(2)


def interrupted(message: str) -> NoReturn:
    """End because of Ctrl-C, saying what is kept."""
    note(f"Interrupted: {message}")
    raise typer.Exit(130)


def wide_console() -> "Console":
    """Stdout for tables of seven columns: into a pipe they are not cut at 80 characters."""
    from rich.console import Console

    stdout = Console()
    return stdout if stdout.is_terminal else Console(width=max(stdout.width, 132))
