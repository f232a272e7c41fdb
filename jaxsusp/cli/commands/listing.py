"""`jaxsusp scenarios` and `jaxsusp algorithms`."""

import json
from typing import Annotated

from jaxsusp.cli.application import command, note
from jaxsusp.cli.options import Json, flag
from jaxsusp.optim.choices import EXTRA, PEERS, installed
from jaxsusp.planning.choices import TAUT
from jaxsusp.scenario.builtin import examples
from jaxsusp.scenario.builtin import scenarios as built_in

_WIDTH = 200
"""Of a listing, at most: where it is wider than a terminal, the terminal breaks lines, not we."""


@command(epilog="Example: jaxsusp scenarios --json")
def scenarios(
    others: Annotated[bool, flag("--examples", "The other built-in scenarios instead.")] = False,
    as_json: Json = False,
) -> None:
    """List the benchmark scenarios, or the examples of other robots, drives and attachments."""
    from jaxsusp.scenario.scenario import load_scenario

    found = [load_scenario(name) for name in (examples() if others else built_in())]
    rows = [
        {
            "scenario": each.name,
            "robots": len(each.robots),
            "drive": each.drive,
            "attachments": "hook" if each.payload.attachments == "hook" else "separate",
            "obstacles": len(each.obstacles),
            "start": list(each.task.start),
            "goal": list(each.task.goal),
        }
        for each in found
    ]
    print_rows(rows, as_json)


@command(epilog="Example: jaxsusp algorithms")
def algorithms(
    others: Annotated[bool, flag("--peers", "Those of other libraries instead.")] = False,
    as_json: Json = False,
) -> None:
    """List the algorithms that --algorithms takes: ours, or those of evosax and pymoo."""
    missing = [library for library in PEERS if library not in installed()]
    if others and missing:
        note(f"{' and '.join(missing)}: not installed; {EXTRA} brings them")

    from jaxsusp.optim.registry import ALGORITHMS, describe, peers

    found = peers() if others else [*ALGORITHMS]
    print_rows([{"algorithm": name, "what": describe(name)} for name in found], as_json)
    if not (as_json or others):
        note(f'`jaxsusp plan` also takes "{TAUT}": taut ways through the free space, as they are.')
        note(f"`jaxsusp algorithms --peers` lists those of {' and '.join(PEERS)}.")


def print_rows(rows: list[dict], as_json: bool) -> None:
    """A plain listing, for people, every row on one line, or for machines."""
    from rich.console import Console
    from rich.table import Table

    if as_json:
        print(json.dumps(rows, indent=2))
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in rows[0] if rows else ():
        table.add_column(name, no_wrap=True)
    for row in rows:
        table.add_row(*map(_plain, row.values()))
    Console(width=_WIDTH).print(table)


def _plain(value: object) -> str:
    return ",".join(f"{each:g}" for each in value) if isinstance(value, list) else str(value)
