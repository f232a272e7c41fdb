"""pyswarms: its objective takes a swarm. It has no defaults; these are its introduction's."""

import os
from pathlib import Path

import numpy as np

from benchmarks.peers.task import Objective, Peer, Task, run_by_run

# Read when pyswarms is loaded, and again for every swarm.
os.environ.setdefault("LOG_CFG", str(Path(__file__).with_name("pyswarms-logging.yaml")))
from pyswarms.single.global_best import GlobalBestPSO

OPTIONS = {"c1": 0.5, "c2": 0.3, "w": 0.9}


def _search(objective: Objective, seed: int, task: Task) -> None:
    np.random.seed(seed)  # noqa: NPY002  what it draws from
    bounds = objective.lower, objective.upper
    swarm = GlobalBestPSO(task.population, len(objective.lower), OPTIONS, bounds)
    swarm.optimize(objective.many, task.iterations + 1, verbose=False)


PEERS = [Peer("pyswarms", "GlobalBestPSO", "pso", run_by_run(_search))]
