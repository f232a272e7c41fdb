"""How near plans come to the best known fitness, and how long they take once all is compiled.

python experiments/plans.py --seeds 10

Gaps in %, margins and the price on hard turns included: what a plan keeps beyond what is asked for
costs fitness. "taut" plans go along a taut way, rounded, and are not searched for.
"""

import argparse
import time

import numpy as np

from jaxsusp.optim import devices


def main() -> None:
    """Print one row per scenario as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=10)
    asked = parser.parse_args()
    devices.configure()
    import jaxsusp as js

    print("| scenario | taut (%) | plan (%) | feasible | seconds, taut | seconds, plan |")
    print("| :--- | ---: | ---: | ---: | ---: | ---: |")
    means = []
    for name in js.scenarios():
        best, plans, seconds = js.best_known(name), [], []
        js.plan(name)  # compiles
        for seed in range(asked.seeds):
            clock = time.perf_counter()
            plans.append(js.plan(name, seed=seed))
            seconds.append(time.perf_counter() - clock)
        clock = time.perf_counter()
        taut = js.plan(name, "taut")
        quick = time.perf_counter() - clock
        gaps = [100 * (each.settings["fitness"] / best - 1) for each in (*plans, taut)]
        means.append(np.mean(gaps[:-1]))
        feasible = sum(each.feasible for each in plans)
        print(
            f"| {name} | {gaps[-1]:.0f} | {means[-1]:.1f} | {feasible}/{len(plans)} | "
            f"{quick:.2f} | {np.median(seconds):.2f} |", flush=True,
        )  # fmt: skip
    print(f"\nMean gap of plans: {np.mean(means):.1f} %")


if __name__ == "__main__":
    main()
