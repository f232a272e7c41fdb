"""Best known trajectories of the six scenarios: searches on, and keeps only what is better.

    python experiments/best_known.py --runs 200          # cmaes in the box, and routed
    python experiments/best_known.py --runs 200 --seed 7 # other runs

Five waypoints, 40 samples, 45,000 evaluations a run. Candidates are judged in float64; what has a
collision or a violated limit does not count. `best_known/NAME.json` holds the value, the waypoints
and how they were found.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from jaxsusp.optim import devices

WAYPOINTS, SAMPLES, ITERATIONS, POPULATION = 5, 40, 500, 90
SEARCHES = (("cmaes", "box"), ("routed", "free-space"))
FOLDER = Path(__file__).with_name("best_known")


def main() -> None:
    """Search every scenario with every search, and write what is better."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    devices.configure()

    import jaxsusp as js

    for name in js.scenarios():
        for algorithm, search in SEARCHES:
            problem = js.Problem.from_scenario(name, WAYPOINTS, SAMPLES, search, np.float32)
            found = js.minimize(problem, algorithm, asked.seed, asked.runs, ITERATIONS, POPULATION)
            how = f"{algorithm} in the {search}, {asked.runs} runs, seed {asked.seed}"
            keep(name, found.x[np.argsort(found.fitness)[:5]], how)


def keep(name: str, candidates: np.ndarray, how: str) -> None:
    """Write the best clear candidate if it is better than what is known."""
    from jaxsusp._files import write_text

    file = FOLDER / f"{name}.json"
    known = json.loads(file.read_text())["fitness"] if file.exists() else np.inf
    judged = [(judge(name, x), x.tolist()) for x in np.asarray(candidates, np.float64)]
    fitness, x = min(judged)
    verdict = "kept" if fitness < known else "no better"
    print(f"{name}: {how}: {fitness:.4f}, known {known:.4f}: {verdict}", flush=True)
    if fitness < known:
        FOLDER.mkdir(exist_ok=True)
        content = {"scenario": name, "fitness": fitness, "waypoints_m": x, "found": how}
        write_text(file, json.dumps(content, indent=2) + "\n")


def judge(name: str, x: np.ndarray) -> float:
    """Fitness in float64; +inf where anything is hit or violated."""
    import jax

    import jaxsusp as js

    with jax.enable_x64(True):
        problem = js.Problem.from_scenario(name, WAYPOINTS, SAMPLES, "box", np.float64)
        terms = problem.terms(x)
        return float(terms.total) if terms.collisions + terms.violations == 0 else np.inf


if __name__ == "__main__":
    main()
