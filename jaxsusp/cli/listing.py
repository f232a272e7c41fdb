"""`jaxsusp scenarios` and `jaxsusp algorithms`."""

from typing import Annotated

import typer

from jaxsusp.cli.application import command, print_rows
from jaxsusp.cli.options import Json
from jaxsusp.scenario.builtin import examples
from jaxsusp.scenario.builtin import scenarios as built_in


@command(epilog="Example: jaxsusp scenarios --json")
def scenarios(
    others: Annotated[
        bool, typer.Option("--examples", help="The other built-in scenarios instead.")
    ] = False,
    as_json: Json = False,
) -> None:
    """List the benchmark scenarios, or the examples of other robots, drives and attachments."""
    from jaxsusp.scenario.scenario import load_scenario

    found = [load_scenario(name) for name in (examples() if others else built_in())]
    rows = [
        {
            "scenario": each.name,
            "robots": len(each.robots),
            "drive": each.drive,
            "attachments": "hook" if each.payload.attachments == "hook" else "separate",
            "obstacles": len(each.obstacles),
            "start": list(each.task.start),
            "goal": list(each.task.goal),
        }
        for each in found
    ]
    print_rows(rows, as_json)


@command(epilog="Example: jaxsusp algorithms")
def algorithms(as_json: Json = False) -> None:
    """List the algorithms that --algorithms takes."""
    from jaxsusp.optim.registry import ALGORITHMS, describe

    print_rows([{"algorithm": name, "what": describe(name)} for name in ALGORITHMS], as_json)
