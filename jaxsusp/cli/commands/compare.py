"""`jaxsusp compare` and `jaxsusp report`."""

import json
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from jaxsusp.cli.application import command, interrupted, note
from jaxsusp.cli.completion import algorithm_names, one_of, scenario_names, some_of
from jaxsusp.cli.interrupts import working
from jaxsusp.cli.options import (
    RESULTS,
    SEARCH,
    Device,
    Json,
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
    names,
    place_of,
    require_choices,
)
from jaxsusp.comparison.choices import BUDGETS, FILE, MANIFEST
from jaxsusp.errors import require, require_known
from jaxsusp.optim.choices import ALGORITHMS, PUBLISHED
from jaxsusp.scenario.builtin import scenarios as built_in

if TYPE_CHECKING:
    import xarray as xr


PAGE = "report.html"

Gap = Annotated[
    bool,
    flag("--gap", "Print how near and how soon algorithms come to the best known fitness."),
]


@command(
    epilog="Example: jaxsusp compare --scenarios scenario-1,mine.toml --algorithms pso,sdbo "
    "--runs 5 --output trial"
)
def compare(
    scenarios: Annotated[
        str | None,
        typer.Option(
            help="Names or TOML files, separated by commas; default: the six.",
            autocompletion=some_of(scenario_names),
        ),
    ] = None,
    random: Annotated[
        int | None,
        count("So many random scenes of rising difficulty; with --scenarios beside those."),
    ] = None,
    algorithms: Annotated[
        str,
        typer.Option(
            help='Names separated by commas, see `jaxsusp algorithms`; or "all" of ours. '
            '"evosax:CMA_ES", "pymoo:GA": of other libraries, see `jaxsusp algorithms --peers`.',
            autocompletion=some_of(algorithm_names),
        ),
    ] = ",".join(PUBLISHED),
    runs: Runs = 20,
    iterations: Annotated[
        int, count("Iterations per run; of a population of 30, routed needs 63 at least.")
    ] = 500,
    population: Population = 30,
    seed: Seed = 0,
    budget: Annotated[
        str,
        typer.Option(
            help='Equal "iterations" (the paper), "evaluations" or measured "time" for all.',
            autocompletion=one_of(BUDGETS),
        ),
    ] = BUDGETS[0],
    polish: Annotated[
        bool, flag("--polish", "Improve every run's best along a gradient at the end.")
    ] = False,
    search: Search = SEARCH,
    waypoints: Waypoints = 5,
    samples: Samples = 40,
    output: Output = RESULTS,
    resume: Annotated[
        bool,
        flag("--resume", "Go on from what is in the output folder; also adds runs."),
    ] = False,
    chunk: Annotated[
        int | None,
        count("Runs that are computed and kept at a time; 250, or a two-hundredth of all."),
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    device: Device = None,
    gap: Gap = False,
    as_json: Json = False,
) -> None:
    """Run every algorithm on every scenario; write tables, figures and compare.nc."""
    default = built_in() if random is None else ()
    chosen = default if scenarios is None else names("scenarios", scenarios)
    named = [*ALGORITHMS] if algorithms == "all" else names("algorithms", algorithms)
    require_choices(chosen, named, search)
    require_known("budget", budget, BUDGETS)
    place = place_of(scheduler, workers, tls_ca, tls_cert, tls_key, device)

    from rich.console import Console

    from jaxsusp.cli.progress import ProgressBar
    from jaxsusp.comparison import compare as comparison
    from jaxsusp.comparison.kept.store import stored_scenarios
    from jaxsusp.studies.random_scenario import random_scenarios

    configured(device)
    working()
    with ProgressBar(Console(stderr=True)) as bar:
        try:
            drawn = random_scenarios(
                random or 0,
                lambda name, i: bar.drawing(name, i, random or 0),
                stored_scenarios(output) if random and resume else None,
            )
            ds = comparison.compare(
                [*chosen, *drawn], named, runs, iterations, population, seed,
                budget=budget, polish=polish, search=search, waypoints=waypoints,
                samples=samples, output=output, resume=resume, chunk=chunk, workers=place,
                progress=bar.told,
            )  # fmt: skip
        except KeyboardInterrupt:
            interrupted(
                f"finished and kept in {output}: {', '.join(bar.kept)}. The same command with "
                "--resume goes on."
                if bar.kept
                else "no algorithm had finished; nothing was written."
            )
    file = _saved_in(output)
    try:
        _report(ds, [file], output, gap, as_json)
    except KeyboardInterrupt:
        interrupted(f"the comparison is complete; `jaxsusp report {file}` writes its report.")


@command(epilog="Example: jaxsusp report results/compare.nc more/compare.nc --output figures")
def report(
    results: Annotated[
        list[Path],
        typer.Argument(
            help="Files that `jaxsusp compare` wrote; several of equal settings are put together."
        ),
    ],
    output: Output = RESULTS,
    gap: Gap = False,
    html: Annotated[
        bool, flag("--html", "Write all of it as one page instead, report.html.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Write the tables and figures of saved comparisons again, or one page with all of it."""
    for place in results:
        file = _saved_in(place)
        remedy = f"give {file}" if file.exists() else f"give a {FILE} that `jaxsusp compare` wrote"
        require(not place.is_dir(), f"{place}: is a folder, not a file; {remedy}")

    from jaxsusp.comparison.kept.together import load_together
    from jaxsusp.optim import devices

    devices.configure()
    _report(load_together(results), results, output, gap, as_json, html)


def _saved_in(folder: Path) -> Path:
    """The file of a folder's comparison: the list of a long study, or all of a shorter one."""
    manifest = folder / MANIFEST
    return manifest if manifest.exists() else folder / FILE


def _report(
    ds: "xr.Dataset",
    sources: Sequence[Path],
    output: Path,
    gap: bool,
    as_json: bool,
    html: bool = False,
) -> None:
    from rich.console import Console

    from jaxsusp.report.comparison.folder import as_records, build_tables, printed, write_report
    from jaxsusp.report.comparison.gaps import better_than_known
    from jaxsusp.report.render import to_rich

    stderr = Console(stderr=True)
    with stderr.status("Writing tables and figures …") if stderr.is_terminal else nullcontext():
        files = [_page(ds, output)] if html else write_report(ds, output, told=note)
    if as_json:
        records = {**as_records(ds), "files": [str(file) for file in files]}
        print(json.dumps(records, indent=2, allow_nan=False))
    else:
        stdout, frames = Console(), build_tables(ds)
        shown = [name for name in printed(ds, gap) if name in frames]
        for name in shown:
            stdout.print(to_rich(frames[name]), "")
        if "comparison" not in shown:
            note(f"{len(ds['scenario'])} scenarios: all other tables are in {output}")
    for sentence in better_than_known(ds):
        where = sources[0] if len(sources) == 1 else "FILE, for the one that holds it,"
        note(f"{sentence}; `python experiments/best_known.py --results {where}` keeps it")
    note(f"wrote {files[0]}" if html else f"{len(files)} tables and figures are in {output}")


def _page(ds: "xr.Dataset", output: Path) -> Path:
    from jaxsusp._files import write_text
    from jaxsusp.report.browser.results import results_page

    output.mkdir(parents=True, exist_ok=True)
    write_text(output / PAGE, results_page(ds))
    return output / PAGE
