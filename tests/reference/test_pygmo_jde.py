"""Self-adapting differential evolution against pygmo's `sade` (variant 7 is DE/rand/1/bin)."""

import jax
import numpy as np
import pygmo
import pytest
from equivalence import DIM, FUNCTIONS, POPULATION, Function, compare, our_fitness

import jaxsusp as js

ITERATIONS = 200
THEIR_RUNS = 240


class Peer:
    """One of the functions as pygmo wants it."""

    def __init__(self, function: Function):
        self.function = function

    def fitness(self, x):
        return [self.function.value(x, np)]

    def get_bounds(self):
        limit = np.full(DIM, self.function.bound)
        return -limit, limit


def pygmo_run(function: Function, seed: int) -> float:
    """Best fitness of one run."""
    sade = pygmo.sade(ITERATIONS, variant=7, variant_adptv=1, ftol=0, xtol=0, seed=seed)
    population = pygmo.population(pygmo.problem(Peer(function)), POPULATION, seed=seed)
    return pygmo.algorithm(sade).evolve(population).champion_f[0]


def drawn(**coefficients: float) -> js.Optimizer:
    """Ours with the first F and CR of all members drawn, as pygmo's are; they are 0.5 and 0.9."""
    ours = js.jde(**coefficients)

    def init(key, *arguments):
        state = ours.init(key, *arguments)
        share = jax.random.uniform(jax.random.fold_in(key, 1), (2, POPULATION), state.x.dtype)
        return state._replace(scale=0.1 + 0.9 * share[0], crossover=share[1])

    return js.Optimizer(ours.name, init, ours.step)


@pytest.fixture(scope="module")
def pygmo_runs() -> dict[str, np.ndarray]:
    return {
        name: np.array([pygmo_run(function, seed) for seed in range(THEIR_RUNS)])
        for name, function in FUNCTIONS.items()
    }


@pytest.mark.parametrize("name", FUNCTIONS)
def test_finds_what_pygmo_finds(name, pygmo_runs):
    outcome = compare(our_fitness(FUNCTIONS[name], drawn(), ITERATIONS), pygmo_runs[name])
    print(f"\njDE, {name}: {outcome}")
    assert outcome.holds, str(outcome)


@pytest.mark.parametrize("wrong", [{"renew_scale": 0.0}, {"least_scale": 0.4}])
def test_the_statistic_tells_another_jde_apart(wrong, pygmo_runs):
    ours = our_fitness(FUNCTIONS["sphere"], drawn(**wrong), ITERATIONS)
    outcome = compare(ours, pygmo_runs["sphere"])
    print(f"\njDE with {wrong}, sphere: {outcome}")
    assert not outcome.holds, str(outcome)
