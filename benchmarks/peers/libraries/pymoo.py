"""pymoo: its problems take a population at a time."""

import numpy as np
from pymoo.algorithms.soo.nonconvex.cmaes import CMAES
from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.optimize import minimize

from benchmarks.peers.task import Objective, Peer, Search, Task, run_by_run


class _Stated(Problem):
    """An objective as pymoo wants it."""

    def __init__(self, objective: Objective):
        lower, upper = objective.lower, objective.upper
        super().__init__(n_var=len(lower), n_obj=1, xl=lower, xu=upper)
        self.objective = objective

    def _evaluate(self, x, out, *args, **kwargs):
        out["F"] = self.objective.many(x)


def _search(kind: type) -> Search:
    def search(objective: Objective, seed: int, task: Task) -> None:
        np.random.seed(seed)  # noqa: NPY002  pycma's, which CMAES is
        algorithm = kind(pop_size=task.population)
        generations = ("n_gen", task.iterations + 1)  # the first is the initial population
        minimize(_Stated(objective), algorithm, generations, seed=seed)

    return search


PEERS = [
    Peer("pymoo", name, ours, run_by_run(_search(kind)))
    for name, kind, ours in (
        ("PSO", PSO, "pso"),
        ("GA", GA, "ga"),
        ("DE", DE, "jde"),
        ("CMAES", CMAES, "cmaes"),
    )
]
