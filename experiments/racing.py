"""Does moving budget between islands pay?  `routed` with and without successive halving, paired.

python experiments/racing.py --random 50 --runs 10

The same scenes, runs and evaluations (45,000 a run); per scene the mean gap to the best known
fitness in %, and the Wilcoxon signed-rank test over scenes.
"""

import argparse

import numpy as np
from scipy.stats import wilcoxon

from jaxsusp.optim import devices


def main() -> None:
    """Print the means, how many scenes either wins, and the test."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--random", type=int, default=50)
    parser.add_argument("--runs", type=int, default=10)
    asked = parser.parse_args()
    devices.configure()
    import jaxsusp as js
    from jaxsusp.comparison.workunit import stack_scenarios
    from jaxsusp.optim.batch import run_batch

    scenes = [*map(js.load_scenario, js.scenarios()), *js.random_scenarios(asked.random)]
    best = np.array([js.best_known(scene) for scene in scenes], float)
    gaps = {}
    for name, halving in (("raced", 1.0), ("fixed", 0.0)):
        found = [
            run_batch(group.problems, js.routed(halving=halving), 0, range(asked.runs), 500, 90)
            for group in stack_scenarios(scenes, 5, 40, "free-space")
        ]
        fitness = np.concatenate([each.fitness for each in found])
        gaps[name] = 100 * (fitness.mean(axis=1) / best - 1)
        six, fresh = gaps[name][:6].mean(), gaps[name][6:]
        print(f"{name}: {six:.2f} % on the six, {fresh.mean():.2f} % on {len(fresh)} random scenes")
    ahead = int((gaps["raced"] < gaps["fixed"]).sum())
    p = wilcoxon(gaps["raced"], gaps["fixed"]).pvalue
    print(f"raced is ahead on {ahead} of {len(scenes)} scenes; Wilcoxon signed-rank p = {p:.2g}")


if __name__ == "__main__":
    main()
