"""Print the timings of the free space: regions beside Drake's, and whole free spaces.

`python -m benchmarks.regions`; Drake is in the reference environment, which `make bench` uses.
"""

import argparse
import json
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.drake import compare
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.ellipsoid import largest_ellipsoid
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.optim.devices import cores
from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.scenario import load_scenario

REGIONS = 20
CUBE = HalfSpaces.box(np.zeros(3), np.ones(3))


def against_drake(count: int) -> dict:
    """Mean times per region (s) and the greatest difference of volumes, relative."""
    pairs = list(compare(count, REGIONS))
    ours, drakes = (np.mean([getattr(p, n) for p in pairs]) for n in ("seconds", "drakes_seconds"))
    difference = max(abs(pair.ours / pair.drakes - 1) for pair in pairs)
    return {"boxes": count, "ours_s": ours, "drake_s": drakes, "difference": difference}


def main() -> None:
    """Measure, print, and write the numbers where asked."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.regions", description=__doc__)
    parser.add_argument("--output", type=Path, help="write the numbers to this JSON file")
    arguments = parser.parse_args()
    console, numbers = Console(), {}
    for faces in range(8, 65, 8):  # compile Eq. 23 for all numbers of faces that will be met
        largest_ellipsoid(HalfSpaces(np.resize(CUBE.A, (faces, 3)), np.resize(CUBE.b, faces)))
    if find_spec("pydrake"):
        numbers["iris"] = [against_drake(count) for count in (10, 40, 100)]
        table = Table("boxes", "ours", "Drake", "ratio", "volumes differ by", box=None)
        for row in numbers["iris"]:
            table.add_row(
                str(row["boxes"]),
                f"{1e3 * row['ours_s']:.1f} ms",
                f"{1e3 * row['drake_s']:.1f} ms",
                f"{row['ours_s'] / row['drake_s']:.2f}",
                f"{row['difference']:.1e}",
            )
        console.print(f"time per region, mean of {REGIONS}, one run:", table, "")
    else:
        console.print("Drake is not installed here; `make bench` runs this where it is.")
    numbers["free_space"] = {}
    for name in scenarios():
        space = free_space(load_scenario(name), cache=False)
        seconds = sum(space.details["seconds"].values())
        numbers["free_space"][name] = seconds
        console.print(
            f"free space of {name}: {seconds:.2f} s, {len(space.d)} regions, "
            f"{space.details['bodies']} bodies, {space.coverage:.1%} covered ({cores()} cores)"
        )
    if arguments.output:
        arguments.output.write_text(json.dumps(numbers, indent=2))


if __name__ == "__main__":
    main()
