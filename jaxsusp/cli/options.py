"""Options that mean the same in every command, and the checks that need nothing heavy."""

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer

from jaxsusp.errors import require_known
from jaxsusp.optim.choices import ALGORITHMS
from jaxsusp.problem.choices import SEARCHES
from jaxsusp.scenario.builtin import find, read


def _whole(text: str | int) -> int:  # defaults come as numbers
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r}; give a whole number.") from None


def count(meaning: str):
    """An option that takes a whole number."""
    return typer.Option(help=meaning, parser=_whole, metavar="<int>")


Named = Annotated[str, typer.Argument(metavar="SCENARIO", help="A built-in name or a TOML file.")]
Runs = Annotated[int, count("Independent runs.")]
Iterations = Annotated[int, count("Iterations per run.")]
Population = Annotated[int, count("Candidates per iteration.")]
Seed = Annotated[int, count("Root of all randomness.")]
Waypoints = Annotated[int, count("Free waypoints between start and goal.")]
Samples = Annotated[int, count("Samples of a trajectory.")]
Search = Annotated[
    str,
    typer.Option(
        help='What waypoints are kept in: polytopes of the "free-space", the paper\'s '
        '"ellipsoid"s in them, or the "box" of the workspace.'
    ),
]
SEARCH = SEARCHES[0]
Output = Annotated[Path, typer.Option(help="Folder for what is written.")]
RESULTS = Path("results")
Cache = Annotated[
    Path | None, typer.Option(help="Folder that keeps compiled programs for the next time.")
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]


def names(listed: str) -> list[str]:
    """Names separated by commas."""
    return [name.strip() for name in listed.split(",") if name.strip()]


def require_choices(
    scenarios: Iterable[str] = (), algorithms: Iterable[str] = (), search: str = SEARCH
) -> None:
    """Refuse what is mistyped before anything heavy is loaded.

    Raises:
        InputError: an unknown algorithm or search rule, or a scenario that is no readable file.
    """
    for name in scenarios:
        read(find(name))
    for name in algorithms:
        require_known("algorithm", name, ALGORITHMS)
    require_known("search", search, SEARCHES)
