"""`jaxsusp plan`."""

import json
from contextlib import nullcontext
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated, Any

import typer

from jaxsusp.cli.application import command, interrupted, note, wide_console
from jaxsusp.cli.completion import algorithm_names, one_of
from jaxsusp.cli.options import (
    RESULTS,
    SEARCH,
    Device,
    Iterations,
    Json,
    NamedMany,
    Output,
    Population,
    Runs,
    Samples,
    Scheduler,
    Search,
    Seed,
    TlsCa,
    TlsCert,
    TlsKey,
    Waypoints,
    Workers,
    configured,
    count,
    flag,
    place_of,
    require_choices,
)
from jaxsusp.cli.records import as_record
from jaxsusp.errors import InputError, require_known
from jaxsusp.optim.choices import require_algorithm
from jaxsusp.planning.choices import COORDINATIONS, ENDS, SHORTEST, TAUT

if TYPE_CHECKING:
    from jaxsusp.planning.plan import Plan
    from jaxsusp.planning.planner import Event
    from jaxsusp.scenario.scenario import Scenario


@command(
    epilog="Examples: jaxsusp plan scenario-1 --ends placed --output plans · "
    "jaxsusp plan hybrid --ends placed · jaxsusp plan scenes/*.toml --workers 4",
)
def plan(
    scenarios: NamedMany,
    algorithm: Annotated[
        str,
        typer.Option(
            help='What searches, see `jaxsusp algorithms`; "taut": nothing, taut ways.',
            autocompletion=algorithm_names,
        ),
    ] = "routed",
    ends: Annotated[
        str,
        typer.Option(
            help='"given" keeps the ends of the scenario, or moves them by the plain rule of its '
            'drive mode; "placed" optimises where they stay, or chooses their way by least '
            "variance where they move.",
            autocompletion=one_of(ENDS),
        ),
    ] = ENDS[0],
    coordination: Annotated[
        str,
        typer.Option(
            help='How ends that stay are placed with the load: "alternation" or "joint".',
            autocompletion=one_of(COORDINATIONS),
        ),
    ] = COORDINATIONS[0],
    runs: Runs = 4,
    iterations: Iterations = 300,
    population: Population = 90,
    retries: Annotated[int, count("Further attempts where one gives no feasible plan.", 0)] = 3,
    seed: Seed = 0,
    search: Search = SEARCH,
    waypoints: Waypoints = 5,
    samples: Samples = 40,
    simulate: Annotated[
        bool,
        typer.Option(help="Whether plans are played in simulation, and have to be followed there."),
    ] = True,
    duration: Annotated[
        str,
        typer.Option(
            help='Seconds from rest to rest, instead of those of the scenario; "shortest": as fast '
            "as limits allow and a swinging load follows.",
            autocompletion=one_of([SHORTEST]),
        ),
    ] = "",
    calm: Annotated[
        bool, typer.Option("--calm", help="Shape the motion so that the load does not swing on.")
    ] = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    device: Device = None,
    resume: Annotated[
        bool, flag("--resume", "Of several scenarios: go on from what is in the output folder.")
    ] = False,
    output: Output = RESULTS,
    as_json: Json = False,
) -> None:
    """Plan a task: trajectory, cables, arms, all limits, certified clear.

    Several scenarios are planned one by one, or by workers: a plan file of each, and one table.
    Exit status 1 where a plan is infeasible, or a task is proved to be impossible.
    """
    require_algorithm(algorithm, [TAUT])
    one = len(scenarios) == 1  # of several, one that cannot be read stops no other
    require_choices(scenarios if one else (), search=search)
    require_known("ends", ends, ENDS)
    require_known("coordination", coordination, COORDINATIONS)
    takes = _duration(duration)
    place = place_of(scheduler, workers, tls_ca, tls_cert, tls_key, device)
    settings = {
        "algorithm": algorithm, "ends": ends, "runs": runs, "iterations": iterations,
        "retries": retries, "seed": seed, "population": population, "waypoints": waypoints,
        "samples": samples, "search": search, "coordination": coordination, "simulate": simulate,
        "duration": takes, "calm": calm,
    }  # fmt: skip
    if len(scenarios) > 1 or resume or not place.here:
        from jaxsusp.cli.commands.plans import plan_several

        configured(device)
        plan_several(scenarios, output, place, resume, as_json, **settings)
    else:
        _plan_one(scenarios[0], output, as_json, device, settings)


def _plan_one(
    scenario: str, output: Path, as_json: bool, device: str | None, settings: dict[str, Any]
) -> None:
    """One task, with everything that is written and said about a plan."""
    from rich.console import Console

    from jaxsusp.comparison.bestknown import best_known
    from jaxsusp.planning import planner
    from jaxsusp.planning.feasibility import ImpossibleTaskError
    from jaxsusp.report.plan.folder import write_plan

    configured(device)
    stderr = Console(stderr=True)
    status = stderr.status("Planning …") if stderr.is_terminal else nullcontext()
    task, seen, found = _plannable(scenario), set(), None
    with status as shown:

        def told(event: "Event") -> None:
            text = f"{event.phase}, attempt {event.attempt + 1} of at most {event.attempts}"
            if shown is not None:
                shown.update(f"{text} …")
            elif event not in seen:
                seen.add(event)
                note(f"{task.name}: {text}")

        try:
            found = planner.plan(task, **settings, progress=told)
            files = write_plan(found, output)
        except ImpossibleTaskError as error:
            note(str(error))
            raise typer.Exit(1) from None
        except KeyboardInterrupt:
            if found is None:
                interrupted("no plan was finished; nothing was written.")
            interrupted(f"the plan was finished; what is whole of its files is in {output}.")
    sizes = settings["waypoints"], settings["samples"]
    same = settings["duration"] in (None, SHORTEST, task.task.duration)  # f4 is measured in it
    best = best_known(task, *sizes) if same and settings["ends"] == "given" else None
    if as_json:
        record = {**as_record(found, files), "best_known": best}
        print(json.dumps(record, indent=2, allow_nan=False))
    else:
        _show(found, best)
    note(f"{files[0]}, samples, report and figures are in {output}")
    raise typer.Exit(0 if found.feasible else 1)


def _duration(said: str) -> str | float | None:
    """What `--duration` says; what is no time is refused with the library's words.

    Raises:
        InputError: neither a number nor "shortest".
    """
    if said in ("", SHORTEST):
        return said or None
    try:
        return float(said)
    except ValueError:
        raise InputError(
            f'duration = "{said}": is no time; give seconds above 0, or "{SHORTEST}"'
        ) from None


def _plannable(named: str) -> "Scenario":
    """A scenario whose start and goal may be planned.

    Raises:
        ScenarioError: with what shows where else they could be, if it is they that are wrong.
    """
    from jaxsusp.errors import ScenarioError
    from jaxsusp.scenario.scenario import load_scenario

    task = load_scenario(named, task_checked=False)
    if task.troubles:
        lines = (f"{named}: {line}" for line in task.troubles)
        raise ScenarioError(
            *lines, f"`jaxsusp check {quote(named)}` draws what blocks it, and what is free"
        )
    return task


def _show(plan: "Plan", best: float | None) -> None:
    from jaxsusp.report.plan.tables import ends_table, limits_table
    from jaxsusp.report.plan.words import summary
    from jaxsusp.report.render import to_rich

    stdout = wide_console()
    stdout.print(to_rich(limits_table(plan.report)), "")
    stdout.print(to_rich(ends_table(plan)), "")
    for said in summary(plan, best):
        stdout.print(said, markup=False, highlight=False)
