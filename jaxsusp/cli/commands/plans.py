"""What `jaxsusp plan` does with several scenarios, or with workers."""

import json
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from jaxsusp.cli.application import interrupted, note, wide_console
from jaxsusp.cli.interrupts import working
from jaxsusp.cluster.choices import Place

if TYPE_CHECKING:
    from jaxsusp.planning.many.kept import Planned
    from jaxsusp.planning.many.scenes import Step

TABLE = "plans.csv"


def plan_several(
    scenarios: Sequence[str],
    output: Path,
    place: Place,
    resume: bool,
    as_json: bool,
    **settings: Any,
) -> None:
    """Plan all of them, tell of each as it is finished, and print a table in the end."""
    from rich.console import Console

    from jaxsusp.planning.many.scenes import plan_many

    stderr = Console(stderr=True)
    status = stderr.status("Planning …") if stderr.is_terminal else nullcontext()
    finished: list[Planned] = []
    with status as shown:

        def told(step: "Step") -> None:
            if step.planned is not None:
                finished.append(step.planned)
                note(f"{step.done} of {step.total}: {_said(step)}")
            elif step.phase == "note":
                note(step.note)
            elif shown is not None:
                shown.update(f"{step.name}, {step.done + 1} of {step.total} …")

        working()
        try:
            found = plan_many(
                scenarios, output=output, resume=resume, workers=place, progress=told, **settings
            )
        except KeyboardInterrupt:
            if finished:
                _tell(finished, output, as_json)
            interrupted(
                f"{len(finished)} of {len(scenarios)} plans are kept in {output}. The same command "
                "with --resume goes on."
                if finished
                else "no plan was finished; nothing was written."
            )
    _tell(found, output, as_json)
    raise typer.Exit(0 if all(each.feasible for each in found) else 1)


def _said(step: "Step") -> str:
    planned = step.planned
    assert planned is not None
    there = " (there already)" if step.phase == "there already" else ""
    if planned.feasible:
        return f"{planned.name}: feasible{there}"
    kind = "no plan" if planned.plan is None else "infeasible"
    return f"{planned.name}: {kind}{there}: {planned.reason}"


def _tell(found: "Sequence[Planned]", output: Path, as_json: bool) -> None:
    from jaxsusp.report.plan.several import plans_table
    from jaxsusp.report.render import to_csv, to_rich

    table = plans_table(found)
    output.mkdir(parents=True, exist_ok=True)
    to_csv(table, output / TABLE)
    if as_json:
        print(json.dumps([_record(each) for each in found], indent=2, allow_nan=False))
    else:
        stdout = wide_console()
        stdout.print(to_rich(table), "")
        for each in found:
            if not each.feasible:
                stdout.print(f"{each.name}: {each.reason}", markup=False, highlight=False)
    note(f"a plan file of each, plans.json and {TABLE} are in {output}")


def _record(each: "Planned") -> dict[str, Any]:
    from jaxsusp.cli.records import as_record

    seconds = {"seconds": each.seconds}
    if each.plan is None:
        return {"scenario": each.name, "feasible": False, "reasons": [each.failure], **seconds}
    files = [] if each.file is None else [each.file]
    return {**as_record(each.plan, files), **seconds}
