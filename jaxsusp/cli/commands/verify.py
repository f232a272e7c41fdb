"""`jaxsusp verify`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from jaxsusp._files import require_file, require_folder
from jaxsusp.cli.application import command, note, wide_console
from jaxsusp.cli.options import Json, checked

if TYPE_CHECKING:
    from jaxsusp.planning.recheck import Verification


def _file(suffix: str):
    """A callback that refuses a file of another suffix, or one that cannot be written."""
    return checked(lambda name, path: require_file(name, path, suffix))


@command(
    epilog="Example: jaxsusp verify results/scenario-1.plan.json --video plan.mp4",
)
def verify(
    plan: Annotated[Path, typer.Argument(help="A plan that `jaxsusp plan` wrote.")],
    model: Annotated[
        Path | None,
        typer.Option(
            help="Write the MuJoCo model (MJCF) to this XML file.", callback=_file(".xml")
        ),
    ] = None,
    images: Annotated[
        Path | None,
        typer.Option(
            help="Write five rendered PNG images into this folder.",
            callback=checked(require_folder),
        ),
    ] = None,
    video: Annotated[
        Path | None,
        typer.Option(
            help="Write a rendered film, four times as fast, to this MP4.", callback=_file(".mp4")
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Check a plan anew: limits, continuous-time certificate, simulation; exit 1 if refused."""
    from jaxsusp.optim import devices
    from jaxsusp.planning.loading import load_plan
    from jaxsusp.planning.recheck import verify_plan

    devices.configure()
    given = load_plan(plan)
    for file in filter(None, (model, video)):
        file.parent.mkdir(parents=True, exist_ok=True)
    files = []
    if model is not None:
        from jaxsusp.verify.simulation import export_model

        export_model(given.rigging, model)
        files.append(model)
    simulation = True
    if images is not None or video is not None:
        from jaxsusp.report.plan.film import NoRendererError, render

        try:
            simulation, rendered = render(given, images, video)
            files += rendered
        except NoRendererError as error:  # the verification itself needs no renderer
            note(str(error))
    found = verify_plan(given, simulation)
    name = given.scenario.name
    if as_json:
        print(json.dumps(_record(found, name, files), indent=2, allow_nan=False))
    else:
        _show(found, name)
    for file in files:
        note(f"wrote {file}")
    raise typer.Exit(0 if found.ok else 1)


def _record(found: "Verification", name: str, files: list[Path]) -> dict:
    from jaxsusp.cli.records import as_record

    record = {**as_record(found.plan, files), "feasible": found.ok, "reasons": list(found.reasons)}
    del record["settings"]
    if found.simulation is not None:
        record["simulation"] = {
            "tracking_error_m": found.simulation.tracking_error,
            "tension_error": found.simulation.tension_error,
            "swing_deg": found.simulation.swing,
            "peak_tension_N": found.simulation.peak_tension,
            "contacts": [list(contact) for contact in found.simulation.contacts],
        }
    return {"scenario": name, **record}


def _show(found: "Verification", name: str) -> None:
    from jaxsusp.report.plan.tables import limits_table, simulation_table
    from jaxsusp.report.plan.words import verdict
    from jaxsusp.report.render import to_rich

    stdout = wide_console()
    stdout.print(to_rich(limits_table(found.plan.report)), "")
    if found.simulation is not None:
        stdout.print(to_rich(simulation_table(found.simulation, found.plan.scenario.limits)), "")
    stdout.print(verdict(found.ok, found.reasons, name), markup=False, highlight=False)
