"""`jaxsusp new`: a scenario of one's own, as a file that explains itself."""

import math
from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from jaxsusp._files import require_file, write_text
from jaxsusp.cli.application import command
from jaxsusp.cli.completion import scenario_names
from jaxsusp.cli.options import checked, flag, require_choices, whole
from jaxsusp.errors import require

ROBOTS = 3


def _several(name: str, value: int) -> None:
    from jaxsusp.errors import require_count
    from jaxsusp.scenario.builtin import FEWEST, MOST

    require_count(name, value, FEWEST, MOST)


def _factor(name: str, value: float) -> None:
    good = math.isfinite(value) and 1e-3 <= value <= 1e3
    require(good, f"{name} = {value:g}: give a factor from 0.001 to 1000")


LIGHTEST, HEAVIEST = 1e-6, 1e9
"""kg of a load that is written."""


def _mass(name: str, value: float) -> None:
    remedy = "give a mass from 1e-6 to 1e9 kg"
    require(LIGHTEST <= value <= HEAVIEST, f"{name} = {value:g}: {remedy}")


@command(
    epilog="Examples: jaxsusp new my.toml · jaxsusp new bench.toml --from scenario-3 --size 0.1"
)
def new(
    file: Annotated[Path, typer.Argument(help="The TOML file to write.", metavar="FILE")],
    source: Annotated[
        str | None,
        typer.Option(
            "--from",
            help="A built-in scenario or a TOML file to begin with; default: a small one.",
            metavar="SCENARIO",
            autocompletion=scenario_names,
        ),
    ] = None,
    robots: Annotated[int | None, whole("So many robots on a ring; default: 3.", _several)] = None,
    size: Annotated[
        float,
        typer.Option(
            help="So many times as large: lengths with it, times with its root.",
            callback=checked(_factor),
        ),
    ] = 1.0,
    mass: Annotated[
        float | None,
        typer.Option(
            help="Of the load, in kg, and tension limits with it; default: with the size cubed.",
            callback=checked(_mass),
        ),
    ] = None,
    force: Annotated[bool, flag("--force", "Replace a file that is there.")] = False,
) -> None:
    """Write a scenario of your own to begin with: every key, its meaning, unit and default."""
    require_file("file", file, ".toml")
    there = f"file = {file}: is there already; give another name, or --force to replace it"
    require(force or not file.exists(), there)
    remedy = "a scenario has its own robots; give one of the two"
    require(source is None or robots is None, f"robots = {robots} with --from {source}: {remedy}")
    if source is not None:
        require_choices([source])

    from jaxsusp.scenario.commented import commented
    from jaxsusp.scenario.scenario import load_scenario
    from jaxsusp.scenario.starter import resized, starter
    from jaxsusp.scenario.toml import value_text

    name = file.stem
    first = starter(name, robots or ROBOTS) if source is None else load_scenario(source)
    heavier = size**3 if mass is None else mass / first.payload.mass
    scenario = resized(first, name, size, heavier)
    origin = "A scenario to begin with." if source is None else f"From {value_text(source)}."
    if (size, heavier) != (1.0, 1.0):
        origin += f" Lengths are multiplied by {size:g}, masses by {heavier:g}."
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text(file, commented(scenario, origin))
    print(f"{file} is written. Change it, then: jaxsusp check {quote(str(file))}")
