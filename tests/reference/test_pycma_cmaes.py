"""CMA-ES against pycma at the same population, first mean and first step size.

Both start at the best of a uniform population, with a step of 0.3 of the range; what pycma would
add to the tutorial's algorithm (termination, restarts, bounds) is switched off. The one thing in
which its defaults differ, how fast the step size adapts, is set to the tutorial's.
"""

import warnings

import numpy as np
import pytest
from equivalence import DIM, FUNCTIONS, POPULATION, Function, compare, our_fitness

import jaxsusp as js
from jaxsusp.optim.algorithms.cmaes import parameters

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import cma

ITERATIONS = {"sphere": 120, "Rosenbrock": 200, "Rastrigin": 150}
THEIR_RUNS = 120
TUTORIAL = parameters(DIM, POPULATION, diagonal=False)
NEVER = {"tolfun": 0, "tolfunhist": 0, "tolx": 0, "tolstagnation": 10**9, "tolflatfitness": 10**9}


def pycma_run(function: Function, iterations: int, seed: int) -> float:
    """Best fitness of one run of pycma."""
    rng = np.random.default_rng(seed)
    first = rng.uniform(-function.bound, function.bound, (POPULATION, DIM))
    first = first[function.value(first, np).argmin()]
    options = {"popsize": POPULATION, "seed": seed + 1, "verbose": -9, "verb_log": 0, **NEVER}
    strategy = cma.CMAEvolutionStrategy(first, 0.6 * function.bound, options)
    step = strategy.adapt_sigma
    step.initialize(strategy)
    step.cs, step.damps = TUTORIAL.c_sigma, TUTORIAL.d_sigma
    best = np.inf
    for _ in range(iterations):
        candidates = strategy.ask()
        fitness = function.value(np.array(candidates), np)
        strategy.tell(candidates, fitness)
        best = min(best, fitness.min())
    return best


@pytest.fixture(scope="module")
def pycma_runs() -> dict[str, np.ndarray]:
    return {
        name: np.array([pycma_run(FUNCTIONS[name], count, s) for s in range(THEIR_RUNS)])
        for name, count in ITERATIONS.items()
    }


@pytest.mark.parametrize("name", ITERATIONS)
def test_finds_what_pycma_finds(name, pycma_runs):
    ours = our_fitness(FUNCTIONS[name], js.cmaes(), ITERATIONS[name])
    outcome = compare(ours, pycma_runs[name])
    print(f"\nCMA-ES, {name}: {outcome}")
    assert outcome.holds, str(outcome)


def test_everything_else_is_pycmas():
    """Weights, negative ones included, and learning rates."""
    theirs = cma.CMAEvolutionStrategy(np.ones(DIM), 1.0, {"popsize": POPULATION, "verbose": -9}).sp
    np.testing.assert_allclose(TUTORIAL.weights, np.array(theirs.weights), rtol=1e-12)
    ours = [TUTORIAL.mass, TUTORIAL.c_1, TUTORIAL.c_mu, TUTORIAL.c_c]
    known = [theirs.weights.mueff, theirs.c1, theirs.cmu, theirs.cc]
    np.testing.assert_allclose(ours, known, rtol=1e-12)


def test_the_statistic_tells_a_diagonal_covariance_apart(pycma_runs):
    ours = our_fitness(FUNCTIONS["Rosenbrock"], js.cmaes(separable=True), ITERATIONS["Rosenbrock"])
    outcome = compare(ours, pycma_runs["Rosenbrock"])
    print(f"\nseparable CMA-ES, Rosenbrock: {outcome}")
    assert not outcome.holds, str(outcome)
