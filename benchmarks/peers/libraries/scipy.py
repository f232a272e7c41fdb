"""SciPy's differential evolution, a population at a time, without its polishing."""

import numpy as np
from scipy.optimize import Bounds, differential_evolution

from benchmarks.peers.task import Objective, Peer, Task, run_by_run


def _search(objective: Objective, seed: int, task: Task) -> None:
    rng = np.random.default_rng(seed)
    size = task.population, len(objective.lower)
    differential_evolution(
        lambda columns: objective.many(columns.T),
        Bounds(objective.lower, objective.upper),
        init=rng.uniform(objective.lower, objective.upper, size),
        maxiter=task.iterations,
        tol=0,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=rng,
    )


PEERS = [Peer("scipy", "differential_evolution", "jde", run_by_run(_search))]
