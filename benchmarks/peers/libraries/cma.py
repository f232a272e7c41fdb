"""pycma, CMA-ES by its author: from a uniform point, with our first step of 0.3 of every range."""

import cma
import numpy as np

from benchmarks.peers.task import Objective, Peer, Task, run_by_run


def _search(objective: Objective, seed: int, task: Task) -> None:
    lower, upper = objective.lower, objective.upper
    options = {
        "popsize": task.population,
        "bounds": [lower, upper],
        "CMA_stds": upper - lower,
        "maxiter": task.iterations + 1,
        "seed": seed + 1,  # 0 would be the time
        "verbose": -9,
    }
    start = np.random.default_rng(seed).uniform(lower, upper)
    strategy = cma.CMAEvolutionStrategy(start, 0.3, options)
    while not strategy.stop():
        x = strategy.ask()
        strategy.tell(x, objective.many(np.array(x)))


PEERS = [Peer("cma", "CMAEvolutionStrategy", "cmaes", run_by_run(_search))]
