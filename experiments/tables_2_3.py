"""Tables 2 and 3 in our form: ends placed by the four algorithms for one load trajectory.

Run `python experiments/tables_2_3.py [SCENARIO …]`; the settings are the constants below. The
trajectory is that of a plan with the given ends, which are printed first. Prints a table per
scenario and writes all rows to OUTPUT.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from rich.console import Console

import jaxsusp as js
from jaxsusp.coordination.ends import Placement, encode, end_problem, evaluate_ends
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.optim.devices import configure
from jaxsusp.report.render import Column, to_rich

RUNS, ITERATIONS, POPULATION, SEED = 4, 200, 30, 0
REFINED = False  # the algorithms themselves are compared
OUTPUT = Path("results") / "tables-2-3.csv"


def row(name: str, found: Placement) -> dict:
    """One line: ends (Table 2), greatest lengths (Table 3), f3 + f4."""
    ends = [f"({x:.3f}, {y:.3f}, {z:.3f})" for x, y, z in found.ends]
    return {
        "ends by": name,
        **{f"robot {k + 1} (m)": end for k, end in enumerate(ends)},
        **{f"cable {k + 1}": length for k, length in enumerate(found.lengths)},
        "f3": found.cable,
        "f4": found.tension_rate,
        "f3 + f4": found.cable + found.tension_rate,
        "faults": found.faults,
    }


def main() -> None:
    """Plan, place, print, write."""
    configure()
    console, frames = Console(width=150), []
    for name in sys.argv[1:] or js.scenarios():
        scenario = js.load_scenario(name)
        path = js.plan(scenario, "pso", seed=SEED).path
        given = np.array([robot.end for robot in scenario.robots])
        rows = [row("given", evaluate_ends(end_problem(scenario, path), encode(given)))]
        for algorithm in PUBLISHED:
            found = js.place_ends(
                scenario, path, algorithm, SEED, RUNS, ITERATIONS, POPULATION, refined=REFINED
            )
            rows.append(row(algorithm, found))
        frame = pd.DataFrame(rows)
        frame.attrs["title"] = f"{name}: ends and greatest cable lengths (Tables 2 and 3)"
        frame.attrs["columns"] = {
            f"cable {k}": Column(f"cable {k} (m)", lambda value: f"{value:.4f}") for k in (1, 2, 3)
        }
        console.print(to_rich(frame), "")
        frames.append(frame.assign(scenario=name))
    OUTPUT.parent.mkdir(exist_ok=True)
    pd.concat(frames).to_csv(OUTPUT, index=False)


if __name__ == "__main__":
    main()
