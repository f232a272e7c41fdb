"""pygmo: generational swarms take a population at a time, the others one candidate."""

from collections.abc import Callable

import pygmo

from benchmarks.peers.task import Objective, Peer, Search, Task, run_by_run


class _Stated:
    """An objective as pygmo wants it. It copies problems, and all copies count alike."""

    def __init__(self, objective: Objective):
        self.objective = objective

    def __deepcopy__(self, memo):
        return self

    def fitness(self, x):
        return [self.objective.one(x)]

    def batch_fitness(self, flat):
        return self.objective.many(flat.reshape(-1, len(self.objective.lower)))

    def get_bounds(self):
        return self.objective.lower, self.objective.upper


def _search(made: Callable[[int, int], object]) -> Search:
    def search(objective: Objective, seed: int, task: Task) -> None:
        together = pygmo.bfe(pygmo.member_bfe())
        stated = pygmo.problem(_Stated(objective))
        population = pygmo.population(stated, task.population, b=together, seed=seed)
        pygmo.algorithm(made(task.iterations, seed)).evolve(population)

    return search


def _swarm(generations: int, seed: int):
    swarm = pygmo.pso_gen(gen=generations, seed=seed)
    swarm.set_bfe(pygmo.bfe(pygmo.member_bfe()))
    return swarm


_ENDLESS = {"ftol": 0, "xtol": 0}
PEERS = [
    Peer("pygmo", "pso_gen", "pso", run_by_run(_search(_swarm))),
    *(
        Peer("pygmo", name, ours, run_by_run(_search(made)), single=True)
        for name, ours, made in (
            ("pso", "pso", lambda gen, seed: pygmo.pso(gen=gen, seed=seed)),
            ("sade", "jde", lambda gen, seed: pygmo.sade(gen=gen, seed=seed, **_ENDLESS)),
            ("de1220", "jde", lambda gen, seed: pygmo.de1220(gen=gen, seed=seed, **_ENDLESS)),
            (
                "cmaes",
                "cmaes",
                lambda gen, seed: pygmo.cmaes(gen=gen, seed=seed, force_bounds=True, **_ENDLESS),
            ),
        )
    ),
]
