"""`jaxsusp workspace`: the load positions that a suspension can hold."""

import json
import math
from typing import Annotated

import typer

from jaxsusp.cli.application import command, interrupted, note, tell_misplaced
from jaxsusp.cli.options import RESULTS, Json, Named, Output, checked, require_choices
from jaxsusp.errors import require


def _length(name: str, value: float) -> None:
    require(math.isfinite(value) and value > 0, f"{name} = {value}: give a length above 0 m")


@command(epilog="Example: jaxsusp workspace four-robots --spacing 0.2 --output space")
def workspace(
    scenario: Named,
    spacing: Annotated[
        float | None,
        typer.Option(
            help="Of the grid, in m; default by the size of robots and workspace.",
            callback=checked(_length),
        ),
    ] = None,
    output: Output = RESULTS,
    as_json: Json = False,
) -> None:
    """Map where the tensions are admissible and the cables clear; write workspace.png and .csv.

    Where start or goal is no place for the load, tells why, and the nearest one that is.
    """
    require_choices([scenario])

    from rich.console import Console

    from jaxsusp.optim import devices
    from jaxsusp.report.drawing.style import save
    from jaxsusp.report.render import to_csv, to_rich
    from jaxsusp.report.workspace import slices, volume_table
    from jaxsusp.scenario.scenario import load_scenario
    from jaxsusp.suspension.misplaced import misplaced
    from jaxsusp.suspension.workspace import workspace as map_workspace

    devices.configure()
    task = load_scenario(scenario, task_checked=False)
    console = Console(stderr=True)
    try:
        with console.status("Judging positions …"):
            space = map_workspace(task, spacing)
            table, blocked = volume_table(space), misplaced(task, space)
            output.mkdir(parents=True, exist_ok=True)
            files = [output / "workspace.png", output / "workspace.csv"]
            save(slices(space, blocked), files[0])
            to_csv(table, files[1])
    except KeyboardInterrupt:
        interrupted("the map was not finished.")
    if as_json:
        answer = {
            "scenario": task.name,
            "cells": list(space.clear.shape),
            "volumes": dict(zip(table["set"], table["volume"], strict=True)),
            "misplaced": [each._asdict() for each in blocked],
            "files": [str(file) for file in files],
        }
        print(json.dumps(answer, indent=2, allow_nan=False))
    else:
        Console().print(to_rich(table))
        tell_misplaced(blocked)
    note(f"{len(files)} files are in {output}")
