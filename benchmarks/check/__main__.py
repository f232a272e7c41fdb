"""Time a few short canaries of this tree and of another one, in turns."""

import argparse
import os
import sys
import tempfile
from pathlib import Path

from rich.console import Console

from benchmarks.check import history
from benchmarks.check.canaries import CANARIES
from benchmarks.check.compared import LEAST, LEVEL, compared, table
from benchmarks.check.trees import HERE, Tree, tree
from jaxsusp.cli.application import note
from jaxsusp.cli.options import names
from jaxsusp.errors import InputError, require_count, require_known
from jaxsusp.report.render import to_rich


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.check",
        description=__doc__,
        epilog="Example: python -m benchmarks.check --against main~10. Exit status 1: a canary is "
        "slower here, beyond chance and tolerance.",
    )
    add = parser.add_argument
    add("--against", metavar="TREE", help="a folder with the package, or a revision of git")
    add("--turns", type=int, default=6, help=f"runs of each, at least {LEAST} (default 6)")
    add(
        "--canaries",
        default=",".join(CANARIES),
        help="names separated by commas; default: all, %(default)s",
    )
    add("--keep", action="store_true", help="time this tree alone, and keep it for the release")
    add("--history", action="store_true", help="only print what is kept of all releases")
    return parser.parse_args()


def in_turns(trees: list[Tree], chosen: list[str], turns: int) -> list[dict[str, list[float]]]:
    """Seconds by tree and canary: A B, B A, A B, …, so that neither profits from what goes on.

    A first round, which compiles, does not count.
    """
    found: list[dict[str, list[float]]] = [{name: [] for name in chosen} for _ in trees]
    for turn in range(turns + 1):
        order = [*range(len(trees))][:: 1 if turn % 2 else -1]
        for i in order:
            note(f"{'first round' if turn == 0 else f'turn {turn} of {turns}'}: {trees[i].name}")
            seconds = trees[i].timed(chosen)
            for name in chosen if turn else ():
                found[i][name].append(seconds[name])
    return found


def main() -> int:
    """Measure and tell."""
    asked = arguments()
    console = Console()
    if asked.history:
        kept = history.entries()
        if not kept:
            raise InputError(f"history: nothing is kept yet; `{history.COMMAND}` keeps a release")
        console.print(to_rich(history.table(kept)))
        return 0
    chosen = names("canaries", asked.canaries)
    for name in chosen:
        require_known("canary", name, CANARIES)
    require_count("turns", asked.turns, LEAST)
    if (asked.against is None) != asked.keep:
        raise InputError(
            "against: give a folder or a revision to compare with, such as make bench-check "
            "AGAINST=main~10; or keep, for this tree alone"
        )
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as scratch:
        others = [] if asked.keep else [tree(asked.against, Path(scratch) / "other")]
        mine = tree(str(HERE), Path(scratch) / "this")._replace(name="this tree")
        found = in_turns([*others, mine], chosen, asked.turns)
    if asked.keep:
        path = history.keep(history.entry(found[0], load))
        console.print(to_rich(history.table(history.entries())))
        note(f"kept in {path}")
        return 0
    rows = [compared(name, found[0][name], found[1][name]) for name in chosen]
    console.print(to_rich(table(rows, (asked.against, "this tree"))))
    console.print(
        f"Medians of {asked.turns} alternating runs (load before: {load:.1f}). The ratio is the "
        "median of those of the turns, beside the ordered values that hold it between them, with "
        f"{LEVEL:.0%} where the turns are enough."
    )
    slower = [row.name for row in rows if row.slower]
    note(f"slower: {', '.join(slower)}" if slower else "nothing is slower beyond chance")
    return 1 if slower else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        note(str(error))
        sys.exit(2)
    except KeyboardInterrupt:
        note("Interrupted: nothing was kept.")
        sys.exit(130)
