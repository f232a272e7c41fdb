"""Is a search the same, run by run or in distribution, where its task is stated otherwise?

python experiments/similarity.py --algorithms pso,jde,cmaes,routed

Forty runs on scenario 1 as it is, in survey coordinates, on a bench and on a building site;
Wilcoxon's rank-sum test of their fitness against that of the first.
"""

import argparse

from scipy.stats import ranksums

import jaxsusp as js
from jaxsusp.optim.devices import configure
from jaxsusp.scenario.ownunits import UNCHANGED, Frame, restated

RUNS = 40
FRAMES = {
    "as it is": UNCHANGED,
    "350 km, 5500 km away": Frame(1.0, 1.0, (350000.0, 5500000.0, 0.0)),
    "1:20": Frame(0.05, 0.05**3),
    "20:1": Frame(20.0, 20.0**3),
}


def main() -> None:
    """Print one row per algorithm, place and size as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--algorithms", default="pso")
    asked = parser.parse_args()
    configure()
    scenario = js.load_scenario("scenario-1")
    print("| scenario 1 | | mean fitness | clear | rank-sum p |")
    print("| :--- | :--- | ---: | ---: | ---: |")
    for algorithm in asked.algorithms.split(","):
        known = None
        for name, frame in FRAMES.items():
            ds = js.compare([restated(scenario, frame)], algorithm, RUNS)
            found = ds["fitness"].values[0, 0]
            known = found if known is None else known
            clear = int((ds["collisions"] + ds["violations"] == 0).sum())
            p = ranksums(known, found).pvalue
            row = f"{found.mean():.1f} | {clear}/{RUNS} | {p:.2f}"
            print(f"| {algorithm} | {name} | {row} |", flush=True)


if __name__ == "__main__":
    main()
