"""`jaxsusp freespace`: where the load and all cables are clear, and the way through."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from jaxsusp.cli.application import command, interrupted, note, tell_misplaced
from jaxsusp.cli.options import (
    RESULTS,
    Json,
    Named,
    Output,
    Seed,
    checked,
    count,
    require_choices,
)
from jaxsusp.errors import require, require_known
from jaxsusp.freespace.choices import SOLVER, solvers

if TYPE_CHECKING:
    from jaxsusp.freespace.build import Growth
    from jaxsusp.freespace.cells.passage import Passage
    from jaxsusp.freespace.space import FreeSpace, Route
    from jaxsusp.planning.refusal import Refusal
    from jaxsusp.scenario.scenario import Scenario
    from jaxsusp.suspension.misplaced import Misplaced


def _share(name: str, value: float) -> None:
    require(0 < value < 1, f"{name} = {value!r}: give a share between 0 and 1")


@command(epilog="Example: jaxsusp freespace scenario-6 --output space")
def freespace(
    scenario: Named,
    coverage: Annotated[
        float,
        typer.Option(
            help="Share of the free space that the regions are to cover.", callback=checked(_share)
        ),
    ] = 0.95,
    limit: Annotated[int, count("Greatest number of regions.", least=2)] = 200,
    routes: Annotated[
        int | None, count("So many distinct ways are shown; default: eight, if there are.")
    ] = None,
    seed: Seed = 0,
    solver: Annotated[
        str, typer.Option(help="Solver of the cone programs, where installed: MOSEK, GUROBI, ….")
    ] = SOLVER,
    output: Output = RESULTS,
    as_json: Json = False,
) -> None:
    """Compute the free space of the whole system; write free-space.nc, a table and figures.

    Tells how narrow it gets. Exit status 1 when no collision-free route leads from start to goal,
    with what is known of the reason, and where start or goal is no place for the load, the nearest
    one that is.
    """
    require_choices([scenario])
    require_known("solver", solver, solvers())

    from rich.console import Console

    from jaxsusp.freespace.build import free_space
    from jaxsusp.freespace.cells.passage import passage
    from jaxsusp.freespace.routes import routes as routes_of
    from jaxsusp.planning.refusal import why_not
    from jaxsusp.scenario.scenario import load_scenario
    from jaxsusp.suspension.misplaced import misplaced

    task = load_scenario(scenario, task_checked=False)
    console = Console(stderr=True)
    with console.status("Growing regions …") as status:

        def told(growth: "Growth") -> None:
            way = "connected" if growth.connected else "not connected yet"
            status.update(
                f"{growth.regions} regions, {growth.coverage:.0%} covered, start and goal {way}"
            )

        try:
            space = free_space(task, coverage, limit, seed, solver, progress=told)
            shown = space.routes[:routes]
            if space.connected and len(shown) < (routes or 0):
                shown = routes_of(space, count=routes or 0)
            status.update("Looking for what is narrow …")
            narrow = passage(task, space) if space.connected else None
            told_already = space.connected or task.troubles
            refusal = None if told_already else why_not(task, space=space)
            blocked = misplaced(task, space)
        except KeyboardInterrupt:
            interrupted("nothing was written.")
    files = _write(task, space, blocked, output)
    _tell(space, shown, routes or 0, narrow, refusal, blocked, files, as_json)
    note(f"{len(files)} files are in {output}")
    if not space.connected:
        raise typer.Exit(1)


def _write(
    scenario: "Scenario", space: "FreeSpace", blocked: "Sequence[Misplaced]", output: Path
) -> list[Path]:
    from jaxsusp.report import freespace as report
    from jaxsusp.report.drawing.style import save
    from jaxsusp.report.render import to_csv

    output.mkdir(parents=True, exist_ok=True)
    files = [output / name for name in ("free-space.nc", "regions.csv", "slices.png", "space.png")]
    space.save(files[0])
    to_csv(report.region_table(space), files[1])
    save(report.slices(scenario, space, blocked), files[2])
    save(report.view(scenario, space, blocked), files[3])
    return files


def _tell(
    space: "FreeSpace", routes: "Sequence[Route]", asked: int, narrow: "Passage | None",
    refusal: "Refusal | None", blocked: "Sequence[Misplaced]", files: list[Path], as_json: bool,
) -> None:  # fmt: skip
    import numpy as np
    from rich.console import Console

    from jaxsusp.report.freespace import region_table, ways
    from jaxsusp.report.render import to_rich

    seconds = space.details["seconds"]
    if as_json:
        answer = {
            "connected": space.connected,
            "reason": space.reason,
            "coverage": space.coverage,
            "route": space.route.tolist(),
            "polyline": space.polyline.tolist(),
            "length": space.length if space.connected else None,
            "bound": space.bound if np.isfinite(space.bound) else None,
            "ways": [{**each._asdict(), "polyline": each.polyline.tolist()} for each in routes],
            "regions": region_table(space).drop(columns="route").to_dict("records"),
            "passage": narrow and _finite(narrow),
            "refusal": refusal and refusal._asdict(),
            "misplaced": [each._asdict() for each in blocked],
            "seconds": seconds,
            "files": [str(file) for file in files],
        }
        print(json.dumps(answer, indent=2, allow_nan=False))
        return
    console = Console()
    console.print(to_rich(region_table(space)), "")
    if space.connected:
        console.print("Distinct taut ways from start to goal:")
        console.print(*ways(routes, asked), "", sep="\n", highlight=False)
        console.print(
            "No polyline through this sequence of regions is shorter than "
            f"{np.floor(1e4 * space.bound) / 1e4:.4f} m."
        )
    if narrow is not None:
        console.print(narrow.words, highlight=False, markup=False)
    if not (space.connected or blocked):
        console.print(space.reason, style="bold", markup=False)
    if refusal is not None:
        console.print(refusal.text, markup=False)
    tell_misplaced(blocked)
    times = ", ".join(f"{name} {value:.2f} s" for name, value in seconds.items())
    console.print(f"{space.details['bodies']} convex bodies to avoid; computed in: {times}")


def _finite(narrow: "Passage") -> dict[str, Any]:
    """A passage as plain values; nothing where no obstacle narrows the way."""
    from math import isfinite

    return {**narrow._asdict(), "width": narrow.width if isfinite(narrow.width) else None}
