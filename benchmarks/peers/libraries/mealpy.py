"""mealpy: it evaluates one agent at a time in all of its modes."""

from mealpy import GA, PSO, FloatVar

from benchmarks.peers.task import Objective, Peer, Search, Task, run_by_run


def _search(kind: type) -> Search:
    def search(objective: Objective, seed: int, task: Task) -> None:
        bounds = FloatVar(lb=tuple(objective.lower), ub=tuple(objective.upper))
        stated = {"obj_func": objective.one, "bounds": bounds, "minmax": "min", "log_to": None}
        kind(epoch=task.iterations, pop_size=task.population).solve(stated, seed=seed)

    return search


PEERS = [
    Peer("mealpy", "OriginalPSO", "pso", run_by_run(_search(PSO.OriginalPSO)), single=True),
    Peer("mealpy", "BaseGA", "ga", run_by_run(_search(GA.BaseGA)), single=True),
]
