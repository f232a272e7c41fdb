"""How often planning succeeds: every scenario from many seeds, certified and simulated.

Run `python experiments/plan_success.py`; the settings are the constants below, and command-line
arguments choose scenarios. Prints a line per scenario and writes every plan's numbers to OUTPUT.
"""

import csv
import sys
import time
from pathlib import Path

import jaxsusp as js
from jaxsusp.optim.devices import configure
from jaxsusp.planning.planner import plan
from jaxsusp.verify.simulation import simulate

SEEDS = range(20)
ENDS = "given"
ALGORITHM = "sdbo"
OUTPUT = Path("results") / f"plan-success-{ENDS}.csv"


def measure(name: str, seed: int) -> dict:
    """Plan, simulate, and say how it went."""
    clock = time.perf_counter()
    found = plan(name, ALGORITHM, ENDS, seed=seed)
    seconds = time.perf_counter() - clock
    seen = simulate(found.rigging)
    return {
        "scenario": name,
        "seed": seed,
        "feasible": found.feasible,
        "certified": found.certificate.proved,
        "attempts": found.settings["attempts"],
        "fitness": found.settings["fitness"],
        "clearance_m": found.clearance,
        "tracking_error_m": seen.tracking_error,
        "tension_error": seen.tension_error,
        "swing_deg": seen.swing,
        "simulation_problems": "; ".join(seen.problems(found.scenario.limits)),
        "seconds": seconds,
        "reasons": "; ".join(found.reasons),
    }


def main() -> None:
    """Measure, print, write."""
    configure()
    rows = []
    for name in sys.argv[1:] or js.scenarios():
        of_scenario = [measure(name, seed) for seed in SEEDS]
        rows += of_scenario
        good = [row for row in of_scenario if row["feasible"] and row["certified"]]
        tracked = [row for row in good if not row["simulation_problems"]]
        print(
            f"{name}: {len(good)}/{len(SEEDS)} feasible and certified, {len(tracked)} of them "
            f"tracked in simulation; worst tracking "
            f"{1e3 * max(row['tracking_error_m'] for row in of_scenario):.1f} mm, tension "
            f"{100 * max(row['tension_error'] for row in of_scenario):.2f} %, median "
            f"{sorted(row['seconds'] for row in of_scenario)[len(SEEDS) // 2]:.2f} s",
            flush=True,
        )
    OUTPUT.parent.mkdir(exist_ok=True)
    with OUTPUT.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
