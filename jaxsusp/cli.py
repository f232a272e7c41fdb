"""The command line: parse, call the library, write. Results on stdout, progress on stderr.

Exit status: 0 when it completed, 2 for bad input, 130 when interrupted.
"""

import json
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Annotated, NoReturn

import typer
import xarray as xr
from rich.console import Console
from rich.table import Table

from jaxsusp.comparison import Event
from jaxsusp.comparison import compare as run_comparison
from jaxsusp.errors import InputError
from jaxsusp.launch import configure
from jaxsusp.optim.registry import ALGORITHMS, describe
from jaxsusp.progress import ProgressBar
from jaxsusp.results import load
from jaxsusp.scenario import load_scenario
from jaxsusp.scenario import scenarios as built_in
from jaxsusp.store import FILE

app = typer.Typer(
    name="jaxsusp",
    help="Obstacle-avoidance planning for multi-robot suspension systems.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)


def _whole(text: str | int) -> int:  # defaults come as numbers
    try:
        return int(text)
    except ValueError:
        raise typer.BadParameter(f"{text!r}; give a whole number.") from None


def _count(meaning: str):
    return typer.Option(help=meaning, parser=_whole, metavar="<int>")


Output = Annotated[Path, typer.Option(help="Folder for what is written.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]


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
    runs: Annotated[int, _count("Independent runs of every algorithm.")] = 20,
    iterations: Annotated[int, _count("Iterations per run.")] = 500,
    population: Annotated[int, _count("Candidates per iteration.")] = 30,
    seed: Annotated[int, _count("Root of all randomness.")] = 0,
    budget: Annotated[
        str, typer.Option(help='Equal "iterations" (the paper) or equal "evaluations" for all.')
    ] = "iterations",
    search: Annotated[str, typer.Option(help="Rule that keeps waypoints inside.")] = "box",
    waypoints: Annotated[int, _count("Free waypoints between start and goal.")] = 5,
    samples: Annotated[int, _count("Samples of a trajectory.")] = 40,
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
    configure(cache=cache)
    stderr = Console(stderr=True)
    with ProgressBar(stderr) as bar, _interrupts() as raise_if_missed:

        def told(event: Event) -> None:
            raise_if_missed()
            bar.told(event)

        try:
            ds = run_comparison(
                built_in() if scenarios is None else _names(scenarios),
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
                progress=told,
            )
        except KeyboardInterrupt:
            _interrupted(
                f"finished and kept in {output}: {', '.join(bar.kept)}. The same command with "
                "--resume goes on."
                if bar.kept
                else "no algorithm had finished; nothing was written."
            )
    try:
        _report(ds, output, as_json)
    except KeyboardInterrupt:
        file = output / FILE
        _interrupted(f"the comparison is complete; `jaxsusp report {file}` writes its report.")


@app.command(epilog="Example: jaxsusp report results/compare.nc --output figures")
def report(
    results: Annotated[Path, typer.Argument(help="A compare.nc that `jaxsusp compare` wrote.")],
    output: Output = Path("results"),
    as_json: Json = False,
) -> None:
    """Write the tables and figures of a saved comparison again."""
    configure()
    _report(load(results), output, as_json)


@app.command(epilog="Example: jaxsusp scenarios --json")
def scenarios(as_json: Json = False) -> None:
    """List the built-in scenarios."""
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
    _print_rows([{"algorithm": name, "what": describe(name)} for name in ALGORITHMS], as_json)


def main() -> None:
    """Entry point: bad input becomes one message and status 2, never a traceback."""
    try:
        app()
    except InputError as error:
        _fail(str(error))
    except OSError as error:
        if error.errno is None:  # no answer of the system but a fault of ours
            raise
        place = error.filename or "a file"
        _fail(f"{place}: {error.strerror}; give a place that can be read and written")


def _fail(message: str) -> NoReturn:
    print(message, file=sys.stderr)
    sys.exit(2)


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """Let no Ctrl-C get lost; lends a function that raises those that came at a bad moment.

    JAX runs a callback in every garbage collection, where Python prints exceptions and goes on.
    """
    missed = False

    def handle(_, frame) -> None:
        nonlocal missed
        missed = frame is not None and frame.f_code.co_name == "_xla_gc_callback"
        if not missed:
            raise KeyboardInterrupt

    def raise_if_missed() -> None:
        if missed:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:  # as for a job in the background of a script
        signal.signal(signal.SIGINT, handle)
    try:
        yield raise_if_missed
    finally:
        signal.signal(signal.SIGINT, before)


def _interrupted(message: str) -> NoReturn:
    print(f"Interrupted: {message}", file=sys.stderr)
    raise typer.Exit(130)


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


def _report(ds: xr.Dataset, output: Path, as_json: bool) -> None:
    from jaxsusp.report.folder import PRINTED, as_records, build_tables, write_report
    from jaxsusp.report.tables import to_rich

    def note(message: str) -> None:
        print(message, file=sys.stderr)

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
