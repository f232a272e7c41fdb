"""`jaxsusp compare` and `jaxsusp report`."""

import json
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer
import xarray as xr
from rich.console import Console

from jaxsusp import launch
from jaxsusp.cli.application import Json, Output, app, count, interrupted, interrupts, names, note
from jaxsusp.comparison import Event
from jaxsusp.comparison import compare as run_comparison
from jaxsusp.progress import ProgressBar
from jaxsusp.results import load
from jaxsusp.scenario import scenarios as built_in
from jaxsusp.search import SEARCHES
from jaxsusp.store import FILE


@app.command(
    epilog="Example: jaxsusp compare --scenarios scenario-1,mine.toml --algorithms pso,sdbo "
    "--runs 5 --output trial"
)
def compare(
    scenarios: Annotated[
        str | None, typer.Option(help="Names or TOML files, separated by commas; default: the six.")
    ] = None,
    algorithms: Annotated[
        str, typer.Option(help="Names separated by commas, see `jaxsusp algorithms`.")
    ] = "pso,ga,dbo,sdbo",
    runs: Annotated[int, count("Independent runs of every algorithm.")] = 20,
    iterations: Annotated[int, count("Iterations per run.")] = 500,
    population: Annotated[int, count("Candidates per iteration.")] = 30,
    seed: Annotated[int, count("Root of all randomness.")] = 0,
    budget: Annotated[
        str, typer.Option(help='Equal "iterations" (the paper) or equal "evaluations" for all.')
    ] = "iterations",
    search: Annotated[
        str,
        typer.Option(
            help='What waypoints are kept in: polytopes of the "free-space", the paper\'s '
            '"ellipsoid"s in them, or the "box" of the workspace.'
        ),
    ] = SEARCHES[0],
    waypoints: Annotated[int, count("Free waypoints between start and goal.")] = 5,
    samples: Annotated[int, count("Samples of a trajectory.")] = 40,
    output: Output = Path("results"),
    resume: Annotated[
        bool,
        typer.Option("--resume", help="Go on from what is in the output folder; also adds runs."),
    ] = False,
    cache: Annotated[
        Path | None, typer.Option(help="Folder that keeps compiled programs for the next time.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run every algorithm on every scenario; write tables, figures and compare.nc."""
    launch.configure(cache=cache)
    stderr = Console(stderr=True)
    with ProgressBar(stderr) as bar, interrupts() as raise_if_missed:

        def told(event: Event) -> None:
            raise_if_missed()
            bar.told(event)

        try:
            ds = run_comparison(
                built_in() if scenarios is None else names(scenarios),
                names(algorithms),
                runs,
                iterations,
                population,
                seed,
                budget=budget,
                search=search,
                waypoints=waypoints,
                samples=samples,
                output=output,
                resume=resume,
                progress=told,
            )
        except KeyboardInterrupt:
            interrupted(
                f"finished and kept in {output}: {', '.join(bar.kept)}. The same command with "
                "--resume goes on."
                if bar.kept
                else "no algorithm had finished; nothing was written."
            )
    try:
        _report(ds, output, as_json)
    except KeyboardInterrupt:
        file = output / FILE
        interrupted(f"the comparison is complete; `jaxsusp report {file}` writes its report.")


@app.command(epilog="Example: jaxsusp report results/compare.nc --output figures")
def report(
    results: Annotated[Path, typer.Argument(help="A compare.nc that `jaxsusp compare` wrote.")],
    output: Output = Path("results"),
    as_json: Json = False,
) -> None:
    """Write the tables and figures of a saved comparison again."""
    launch.configure()
    _report(load(results), output, as_json)


def _report(ds: xr.Dataset, output: Path, as_json: bool) -> None:
    from jaxsusp.report.folder import PRINTED, as_records, build_tables, write_report
    from jaxsusp.report.tables import to_rich

    stderr = Console(stderr=True)
    with stderr.status("Writing tables and figures …") if stderr.is_terminal else nullcontext():
        files = write_report(ds, output, told=note)
    if as_json:
        records = {**as_records(ds), "files": [str(file) for file in files]}
        print(json.dumps(records, indent=2, allow_nan=False))
    else:
        stdout, frames = Console(), build_tables(ds)
        for name in PRINTED:
            if name in frames:
                stdout.print(to_rich(frames[name]), "")
    note(f"{len(files)} tables and figures are in {output}")
