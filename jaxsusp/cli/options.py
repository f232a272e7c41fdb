"""Options that mean the same in every command, and the checks that need nothing heavy.

A value out of range is told while the command line is read, in the words of the library.
"""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated, Any

import typer

from jaxsusp._files import require_folder
from jaxsusp.cli.completion import one_of, scenario_names
from jaxsusp.cluster.choices import Place
from jaxsusp.errors import require, require_count, require_known, require_seed
from jaxsusp.optim.choices import DEVICES, require_algorithm, require_device
from jaxsusp.problem.choices import SEARCHES
from jaxsusp.scenario.builtin import find, read


def checked(check: Callable[[str, Any], None]) -> Callable[..., Any]:
    """A callback for options: refuses a value that was given, told the option's name and it."""

    def callback(_, option, value):
        if value is not None:
            check(option.name, value)
        return value

    return callback


def _whole(text: str | int) -> int:  # defaults come as numbers
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r}; give a whole number.") from None


def whole(meaning: str, check: Callable[[str, int], None]):
    """An option that takes a whole number."""
    return typer.Option(help=meaning, parser=_whole, metavar="<int>", callback=checked(check))


def count(meaning: str, least: int = 1):
    """An option that takes a whole number of at least so many."""
    return whole(meaning, lambda name, value: require_count(name, value, least))


def flag(name: str, meaning: str):
    """An option that is given or not; Typer would show it as one that takes a value."""
    return typer.Option(name, help=meaning, metavar="")


Named = Annotated[
    str,
    typer.Argument(
        metavar="SCENARIO",
        help="A built-in name or a TOML file.",
        autocompletion=scenario_names,
    ),
]
NamedMany = Annotated[
    list[str],
    typer.Argument(
        metavar="SCENARIO...",
        help="A built-in name or a TOML file; or several.",
        autocompletion=scenario_names,
    ),
]
Runs = Annotated[int, count("Independent runs.")]
Iterations = Annotated[int, count("Iterations per run.")]
Population = Annotated[int, count("Candidates per iteration.")]
Seed = Annotated[int, whole("Root of all randomness.", lambda _, seed: require_seed(seed))]
Waypoints = Annotated[int, count("Free waypoints between start and goal.")]
Samples = Annotated[int, count("Samples of a trajectory.", least=3)]
Search = Annotated[
    str,
    typer.Option(
        help='What waypoints are kept in: polytopes of the "free-space", the paper\'s '
        '"ellipsoid"s in them, or the "box" of the workspace.',
        autocompletion=one_of(SEARCHES),
    ),
]
SEARCH = SEARCHES[0]
Workers = Annotated[
    int | None, count("Do the work in so many processes of this machine, which share its cores.")
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        help="Have the work done by the workers of a Dask scheduler: its address, such as "
        "tcp://HOST:8786, or its file.",
        show_default=False,
    ),
]
TlsCa = Annotated[
    Path | None, typer.Option("--tls-ca", help="Certificates that are trusted (PEM); scheduler.")
]
TlsCert = Annotated[
    Path | None, typer.Option("--tls-cert", help="Our certificate (PEM) for the scheduler.")
]
TlsKey = Annotated[
    Path | None, typer.Option("--tls-key", help="Its key, where the certificate is without.")
]
Device = Annotated[
    str | None,
    typer.Option(
        help='What searches run on: "gpu" or "cpu"; default: a GPU where JAX has one.',
        callback=checked(lambda _, device: require_device(device)),
        autocompletion=one_of(DEVICES),
        show_default=False,
    ),
]
Output = Annotated[
    Path, typer.Option(help="Folder for what is written.", callback=checked(require_folder))
]
RESULTS = Path("results")
Json = Annotated[bool, flag("--json", "Print JSON instead of tables.")]


def place_of(
    scheduler: str | None,
    workers: int | None,
    tls_ca: Path | None,
    tls_cert: Path | None,
    tls_key: Path | None,
    device: str | None,
) -> Place:
    """Who computes, as the options say; devices are chosen for this process alone.

    Raises:
        InputError: the options contradict each other.
    """
    place = Place(scheduler, workers, tls_ca, tls_cert, tls_key)
    place.require_sense()
    require(
        device is None or place.here,
        f'device = "{device}": is for this process; workers compute on what the JAX of each has: '
        "leave device out, or set JAX_PLATFORMS where they are started",
    )
    return place


def configured(device: str | None) -> None:
    """Start JAX, and say what computes where that is not clear of itself.

    Raises:
        InputError: there is no such device.
    """
    from jaxsusp.cli.application import note
    from jaxsusp.optim import devices

    devices.configure(device=device)
    if device is not None or devices.accelerated():
        note(f"computing on {devices.said()}")


def names(field: str, listed: str) -> list[str]:
    """Names separated by commas.

    Raises:
        InputError: there is none, or one of them is empty.
    """
    require(listed.strip() != "", f"{field}: none given; name at least one")
    found = [name.strip() for name in listed.split(",")]
    remedy = "give names with one comma between two of them"
    require(all(found), f"{field} = {listed!r}: one of the names is empty; {remedy}")
    return found


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
        require_algorithm(name)
    require_known("search", search, SEARCHES)
