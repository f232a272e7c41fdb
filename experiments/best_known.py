"""Best known trajectories: searches on, and keeps only what is better than what is known.

    python experiments/best_known.py --runs 200              # cmaes in the box, and routed
    python experiments/best_known.py --runs 200 --seed 7     # other runs
    python experiments/best_known.py --random 50             # random scenes instead of the six
    python experiments/best_known.py --results compare.nc    # what a comparison has found already

Five waypoints, 40 samples, 45,000 evaluations a run. Candidates are judged in float64; what has a
collision or a violated limit does not count. The records are part of the package,
`jaxsusp/comparison/data/best_known.json`: value, waypoints, and how they were found.
"""

import argparse
import functools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxsusp.comparison import bestknown
from jaxsusp.optim import devices

if TYPE_CHECKING:
    import jaxsusp as js

FILE = bestknown.FILE
WAYPOINTS, SAMPLES, ITERATIONS, POPULATION = 5, 40, 500, 90
SEARCHES = (("cmaes", "box"), ("routed", "free-space"))
PADDED = 16  # obstacles of every kind: most scenes share a compiled program
MOST = 5  # candidates of a search that are judged: in float32 the best may be the second

Found = tuple["js.Scenario", np.ndarray, str, int]
"""Scenario, candidates (count, D), how they were found, samples."""


def main() -> None:
    """Judge what every search finds, and write what is better."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    source = parser.add_mutually_exclusive_group()
    source.add_argument("--random", type=int, metavar="N")
    source.add_argument("--results", type=Path)
    asked = parser.parse_args()
    devices.configure()
    found = searched(asked) if asked.results is None else compared(asked.results)
    for scenario, candidates, how, samples in found:
        keep(scenario, candidates, how, samples)


def searched(asked: argparse.Namespace) -> Iterator[Found]:
    """What new searches find in the six scenarios, or in random ones."""
    import jaxsusp as js

    six = js.scenarios() if asked.random is None else ()
    for scenario in [*map(js.load_scenario, six), *js.random_scenarios(asked.random or 0)]:
        for algorithm, search in SEARCHES:
            problem = js.Problem.from_scenario(scenario, WAYPOINTS, SAMPLES, search, np.float32)
            found = js.minimize(problem, algorithm, asked.seed, asked.runs, ITERATIONS, POPULATION)
            how = f"{algorithm} in the {search}, {asked.runs} runs, seed {asked.seed}"
            yield scenario, found.x[np.argsort(found.fitness)[:MOST]], how, SAMPLES


def compared(file: Path) -> Iterator[Found]:
    """The clear runs of a saved comparison, the best of every algorithm and scenario."""
    import jaxsusp as js
    from jaxsusp.report.comparison.gaps import clear_runs

    ds = js.load_results(file)
    settings = json.loads(ds.attrs["settings"])
    for name, text in json.loads(ds.attrs["scenario_files"]).items():
        for algorithm in ds["algorithm"].values.tolist():
            cell = ds.sel(scenario=name, algorithm=algorithm)
            cell = cell.isel(run=clear_runs(cell).values).sortby("fitness").isel(run=slice(MOST))
            runs, seed = ds.sizes["run"], settings["seed"]
            how = f"{algorithm} in the {settings['search']}, {runs} runs, seed {seed}"
            if cell.sizes["run"]:
                yield js.Scenario.from_toml(text), cell["x"].values, how, settings["samples"]


def keep(scenario: "js.Scenario", candidates: np.ndarray, how: str, samples: int) -> None:
    """Write the best clear candidate if it is better than what is known."""
    from jaxsusp._files import write_text

    judged = [(judge(scenario, x, samples), x.tolist()) for x in np.float64(candidates)]
    fitness, x = min(judged)
    key = {"digest": scenario.digest, "waypoints": len(x) // 3, "samples": samples}
    before = bestknown.records(FILE)
    others = [each for each in before if any(each[name] != key[name] for name in key)]
    known = min((each["fitness"] for each in before if each not in others), default=np.inf)
    verdict = "kept" if fitness < known else "no better"
    print(f"{scenario.name}: {how}: {fitness:.4f}, known {known:.4f}: {verdict}", flush=True)
    if fitness < known:
        record = {"scenario": scenario.name, **key, "fitness": fitness, "found": how}
        rows = sorted([*others, {**record, "waypoints_m": x}], key=_order)
        lines = ",\n".join(json.dumps(row) for row in rows)  # a line each: a change is one line
        write_text(FILE, f"[\n{lines}\n]\n")


def _order(record: dict) -> list:
    """By name, the numbers in it as numbers."""
    return [(int(part), "") if part.isdigit() else (-1, part) for part in
            record["scenario"].split("-")]  # fmt: skip


@functools.cache
def compiled_terms() -> Callable:
    """Once for all candidates of a scenario, which takes less time than five of them."""
    import jax

    import jaxsusp as js

    return jax.jit(js.Problem.terms)


def judge(scenario: "js.Scenario", x: np.ndarray, samples: int) -> float:
    """Fitness in float64; +inf where anything is hit or violated."""
    import jax

    import jaxsusp as js
    from jaxsusp.scenario.world import build_world, rounded_counts

    padded = [max(PADDED, count) for count in rounded_counts(scenario)]
    world = build_world(scenario, padded)
    with jax.enable_x64(True):
        problem = js.Problem.from_scenario(scenario, len(x) // 3, samples, "box", np.float64, world)
        terms = compiled_terms()(problem, x)
        return float(terms.total) if terms.collisions + terms.violations == 0 else np.inf


if __name__ == "__main__":
    main()
