"""How near the algorithms come to the best known fitness: mean gap of 20 runs, 45,000 evaluations.

python experiments/house_algorithm.py
"""

import json
from pathlib import Path

import numpy as np

from jaxsusp.optim import devices

RUNS = 20
SETTINGS = {"pso": (500, 90), "sdbo": (500, 30), "jde": (500, 90), "cmaes": (500, 90),
            "routed": (500, 90)}  # fmt: skip
BEST = Path(__file__).with_name("best_known")


def main() -> None:
    """Print one row per algorithm as Markdown."""
    devices.configure()
    import jaxsusp as js

    names = js.scenarios()
    best = [json.loads((BEST / f"{name}.json").read_text())["fitness"] for name in names]
    print(f"| mean gap in % | {' | '.join(names)} | clear | evaluations | seconds |")
    print("| :--- |" + " ---: |" * (len(names) + 3))
    for algorithm, (iterations, population) in SETTINGS.items():
        ds = js.compare(names, [algorithm], RUNS, iterations, population)
        gap = 100 * (ds["fitness"].mean("run").values[:, 0] / best - 1)
        clear = int(((ds["collisions"] + ds["violations"]) == 0).sum())
        cells = [_short(value) for value in gap]
        cells += [f"{clear}/{RUNS * len(names)}", f"{int(np.max(ds['evaluations'])):,}"]
        cells.append(f"{float(ds['seconds_run'].sum()):.1f}")
        print(f"| {algorithm} | {' | '.join(cells)} |", flush=True)


def _short(gap: float) -> str:
    return f"{gap:.1f}" if gap < 10 else f"{gap:.0f}"


if __name__ == "__main__":
    main()
