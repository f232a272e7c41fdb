"""The command line: parse, call the library, write. Results on stdout, progress on stderr.

Exit status: 0 when it completed, 2 for bad input, 130 when interrupted.
"""

import json
import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer
from rich.console import Console
from rich.table import Table

from jaxsusp.errors import InputError
from jaxsusp.launch import configure

app = typer.Typer(
    name="jaxsusp",
    help="Obstacle-avoidance planning for multi-robot suspension systems.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

Output = Annotated[Path, typer.Option(help="Folder for what is written.", file_okay=False)]
Json = Annotated[bool, typer.Option("--json", help="Print the tables as JSON.")]


@app.command(
    epilog="Example: jaxsusp compare --scenarios scenario-1,mine.toml --algorithms pso,sdbo "
    "--runs 5 --output trial"
)
def compare(
    scenarios: Annotated[
        str, typer.Option(help="Names or TOML files, separated by commas; default: the six.")
    ] = "",
    algorithms: Annotated[
        str, typer.Option(help="Names separated by commas, see `jaxsusp algorithms`.")
    ] = "pso,ga,dbo,sdbo",
    runs: Annotated[int, typer.Option(help="Independent runs of every algorithm.")] = 20,
    iterations: Annotated[int, typer.Option(help="Iterations per run.")] = 500,
    population: Annotated[int, typer.Option(help="Candidates per iteration.")] = 30,
    seed: Annotated[int, typer.Option(help="Root of all randomness.")] = 0,
    budget: Annotated[
        str, typer.Option(help='Equal "iterations" (the paper) or equal "evaluations" for all.')
    ] = "iterations",
    search: Annotated[str, typer.Option(help="Rule that keeps waypoints inside.")] = "box",
    waypoints: Annotated[int, typer.Option(help="Free waypoints between start and goal.")] = 5,
    samples: Annotated[int, typer.Option(help="Samples of a trajectory.")] = 40,
    output: Output = Path("results"),
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from what is finished in the output folder.")
    ] = False,
    cache: Annotated[
        Path | None, typer.Option(help="Folder that keeps compiled programs for the next time.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run every algorithm on every scenario; write table, figures and compare.nc."""
    configure(cache=cache)
    from jaxsusp.comparison import compare as run
    from jaxsusp.progress import ProgressBar
    from jaxsusp.scenario import scenarios as built_in

    with ProgressBar(Console(stderr=True)) as bar:
        try:
            ds = run(
                _names(scenarios) or built_in(),
                _names(algorithms),
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
                progress=bar.told,
            )
        except KeyboardInterrupt:
            bar.stop()
            kept = ", ".join(bar.finished) or "nothing"
            Console(stderr=True).print(
                f"Interrupted. Finished and kept: {kept}. Go on with the same command and --resume."
            )
            raise typer.Exit(130) from None
    _report(ds, output, as_json)


@app.command(epilog="Example: jaxsusp report results/compare.nc --output figures")
def report(
    results: Annotated[Path, typer.Argument(help="A compare.nc that `jaxsusp compare` wrote.")],
    output: Output = Path("results"),
    as_json: Json = False,
) -> None:
    """Write the tables and figures of a saved comparison again."""
    configure()
    from jaxsusp.results import load

    _report(load(results), output, as_json)


@app.command(epilog="Example: jaxsusp scenarios")
def scenarios(as_json: Json = False) -> None:
    """List the built-in scenarios."""
    configure()
    from jaxsusp.scenario import load_scenario
    from jaxsusp.scenario import scenarios as built_in

    found = [load_scenario(name) for name in built_in()]
    rows = [
        {
            "scenario": each.name,
            "robots": len(each.robots),
            "obstacles": len(each.obstacles),
            "start": list(each.task.start),
            "goal": list(each.task.goal),
        }
        for each in found
    ]
    _print_rows(rows, as_json)


@app.command(epilog="Example: jaxsusp algorithms")
def algorithms(as_json: Json = False) -> None:
    """List the algorithms that --algorithms takes."""
    from jaxsusp.optim.registry import ALGORITHMS, describe

    _print_rows([{"algorithm": name, "what": describe(name)} for name in ALGORITHMS], as_json)


def main() -> None:
    """Entry point: bad input becomes one message and status 2, never a traceback."""
    try:
        app()
    except InputError as error:
        _fail(str(error))
    except OSError as error:
        if error.filename is None:
            raise
        _fail(f"{error.filename}: {error.strerror}; give a place that can be read and written")


def _fail(message: str) -> NoReturn:
    print(message, file=sys.stderr)
    sys.exit(2)


def _names(listed: str) -> list[str]:
    return [name.strip() for name in listed.split(",") if name.strip()]


def _print_rows(rows: list[dict], as_json: bool) -> None:
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in rows[0]:
        table.add_column(name)
    for row in rows:
        table.add_row(*(str(value) for value in row.values()))
    Console().print(table)


def _report(ds, output: Path, as_json: bool) -> None:
    from jaxsusp.report.folder import PRINTED, as_records, build_tables, write_report
    from jaxsusp.report.tables import to_rich

    stderr = Console(stderr=True)
    with stderr.status("Writing tables and figures …"):
        files = write_report(ds, output, told=stderr.print)
    if as_json:
        print(json.dumps({**as_records(ds), "files": [str(file) for file in files]}))
        return
    stdout, frames = Console(), build_tables(ds)
    for name in PRINTED:
        if name in frames:
            stdout.print(to_rich(frames[name]), "")
    stderr.print(f"{len(files)} tables and figures are in {output}/")
