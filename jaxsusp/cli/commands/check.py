"""`jaxsusp check`: a scenario in words and one picture, before it is planned."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from jaxsusp.cli.application import command, interrupted, note, wide_console
from jaxsusp.cli.options import RESULTS, Json, Named, Output, require_choices

if TYPE_CHECKING:
    from jaxsusp.planning.prospects.examination import Examination


@command(epilog="Example: jaxsusp check my.toml --output checked")
def check(scenario: Named, output: Output = RESULTS, as_json: Json = False) -> None:
    """Explain a scenario: what it states, what holds the load, what blocks it; write a picture.

    Exit status 1 where the task cannot be carried out as it is stated.
    """
    require_choices([scenario])

    from rich.console import Console

    from jaxsusp.optim import devices
    from jaxsusp.planning.prospects.examination import examine
    from jaxsusp.report.drawing.style import save
    from jaxsusp.report.examination import sheet
    from jaxsusp.scenario.scenario import load_scenario

    devices.configure()
    task = load_scenario(scenario, task_checked=False)
    try:
        with Console(stderr=True).status("Looking at the task …"):
            found = examine(task)
            output.mkdir(parents=True, exist_ok=True)
            picture = output / "check.png"
            save(sheet(found), picture)
    except KeyboardInterrupt:
        interrupted("the task was not looked at to the end.")
    if as_json:
        print(json.dumps(_record(found, picture), indent=2, allow_nan=False))
    else:
        _show(found, scenario)
    note(f"The picture is {picture}")
    raise typer.Exit(0 if found.possible else 1)


def _show(found: "Examination", source: str) -> None:
    from jaxsusp.report.examination import about, prospects, robot_table, verdict
    from jaxsusp.report.render import to_rich

    stdout = wide_console()
    for sentence in (*about(found.scenario), ""):
        stdout.print(sentence, markup=False, highlight=False)
    stdout.print(to_rich(robot_table(found)), "")
    for sentence in (*prospects(found), ""):
        stdout.print(sentence, markup=False, highlight=False)
    stdout.print(verdict(found, source), style="bold", markup=False, highlight=False)


def _record(found: "Examination", picture: Path) -> dict[str, Any]:
    from jaxsusp.planning.prospects.stated import keys_of, unfitting
    from jaxsusp.report.browser.packing import plain
    from jaxsusp.report.examination import mesh_records

    scenario, space = found.scenario, found.workspace
    keys = keys_of(scenario)
    frame = scenario.units
    return {
        "scenario": scenario.name,
        "possible": found.possible,
        "given": [key.path for key in keys if key.given],
        "default": [key.path for key in keys if not key.given],
        "unfitting": list(unfitting(scenario)),
        "own_units": {"length_m": frame.length, "mass_kg": frame.mass, "origin_m": frame.origin},
        "robots": plain(found.holding._asdict()),
        "volumes_m3": {
            "admissible": space.volume(space.admissible), "usable": space.volume(space.usable),
        },
        "meshes": mesh_records(scenario),
        "misplaced": [each._asdict() for each in found.blocked],
        "passage": plain(found.passage and found.passage._asdict()),
        "refusal": found.refusal and found.refusal._asdict(),
        "files": [str(picture)],
    }  # fmt: skip
