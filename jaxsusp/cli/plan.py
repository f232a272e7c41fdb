"""`jaxsusp plan`."""

import json
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from jaxsusp import launch
from jaxsusp.cli.application import (
    Json,
    Named,
    Output,
    app,
    count,
    interrupted,
    interrupts,
    note,
    wide_console,
)
from jaxsusp.planning import SEARCH, Event
from jaxsusp.planning import plan as make_plan
from jaxsusp.plans import Plan
from jaxsusp.scenario import load_scenario


@app.command(
    epilog="Examples: jaxsusp plan scenario-1 --ends placed --output plans · "
    "jaxsusp plan hybrid --ends placed",
)
def plan(
    scenario: Named,
    algorithm: Annotated[
        str, typer.Option(help="What searches, see `jaxsusp algorithms`.")
    ] = "sdbo",
    ends: Annotated[
        str,
        typer.Option(
            help='"given" keeps the ends of the scenario, or moves them by the plain rule of its '
            'drive mode; "placed" optimises where they stay, or chooses their way by least '
            "variance where they move."
        ),
    ] = "given",
    coordination: Annotated[
        str,
        typer.Option(help='How ends that stay are placed with the load: "alternation" or "joint".'),
    ] = "alternation",
    runs: Annotated[int, count("Independent runs per batch.")] = 4,
    iterations: Annotated[int, count("Iterations per run.")] = 300,
    population: Annotated[int, count("Candidates per iteration.")] = 30,
    retries: Annotated[int, count("Further attempts where one gives no feasible plan.")] = 3,
    seed: Annotated[int, count("Root of all randomness.")] = 0,
    search: Annotated[str, typer.Option(help="Rule that keeps waypoints inside.")] = SEARCH,
    waypoints: Annotated[int, count("Free waypoints between start and goal.")] = 5,
    samples: Annotated[int, count("Samples of the trajectory and of the plan.")] = 40,
    output: Output = Path("results"),
    cache: Annotated[
        Path | None, typer.Option(help="Folder that keeps compiled programs for the next time.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Plan a task: trajectory, cables, arms, all limits, certified clear; exit 1 if infeasible."""
    launch.configure(cache=cache)
    stderr = Console(stderr=True)
    status = stderr.status("Planning …") if stderr.is_terminal else nullcontext()
    with status as shown, interrupts() as raise_if_missed:

        def told(event: Event) -> None:
            raise_if_missed()
            text = f"{event.phase}, attempt {event.attempt + 1} of at most {event.attempts}"
            if shown is not None:
                shown.update(f"{text} …")

        try:
            found = make_plan(
                load_scenario(scenario), algorithm, ends, runs, iterations, retries, seed,
                population=population, waypoints=waypoints, samples=samples, search=search,
                coordination=coordination, progress=told,
            )  # fmt: skip
            from jaxsusp.report.planfolder import write_plan

            files = write_plan(found, output)
        except KeyboardInterrupt:
            interrupted("no plan was finished; nothing was written.")
    if as_json:
        print(json.dumps(as_record(found, files), indent=2, allow_nan=False))
    else:
        _show(found)
    note(f"{files[0]}, samples, report and figures are in {output}")
    raise typer.Exit(0 if found.feasible else 1)


def as_record(plan: Plan, files: list[Path]) -> dict[str, Any]:
    """A plan's outcome as plain values for machines."""
    from jaxsusp.planfile import _plain

    return {
        "scenario": plan.scenario.name,
        "feasible": plan.feasible,
        "certified": plan.certificate.proved,
        "reasons": list(plan.reasons),
        "clearance_m": _plain(plan.clearance),
        "ends_m": plan.ends.tolist(),
        "report": [
            {**_plain(each._asdict()), "margin": _plain(each.margin), "ok": each.ok}
            for each in plan.report
        ],
        "settings": _plain(dict(plan.settings)),
        "files": [str(file) for file in files],
    }


def _show(plan: Plan) -> None:
    from jaxsusp.report.planreport import ends_table, limits_table, verdict
    from jaxsusp.report.render import to_rich

    stdout = wide_console()
    stdout.print(to_rich(limits_table(plan.report)), "")
    stdout.print(to_rich(ends_table(plan)), "")
    stdout.print(
        verdict(plan.feasible, plan.reasons, plan.scenario.name), markup=False, highlight=False
    )
