"""Many weights in one batch: each run is that of a scenario that states them."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.studies.settings import run_settings

WEIGHTS = np.array([[1.0, 1, 1, 1, 1, 1000], [0.2, 5, 1, 2, 0.5, 300]])


@pytest.fixture(scope="module")
def found(scenarios):
    problem = js.Problem.from_scenario(scenarios[0], dtype=np.float32)
    runs = np.array([[0, 1], [0, 1]])
    return run_settings(problem, js.pso(), WEIGHTS, runs, iterations=20, population=30)


def test_a_setting_is_the_scenario_that_states_it(scenarios, found):
    """To the rounding of a sum: its first iterations take the same course."""
    for weights, x, fitness in zip(WEIGHTS, found.x, found.fitness, strict=True):
        stated = scenarios[0].fitness.model_copy(
            update={"weights": (*weights[:5].tolist(), 1.0), "kappa": float(weights[5])}
        )
        problem = js.Problem.from_scenario(scenarios[0].model_copy(update={"fitness": stated}))
        for each, value in zip(x, fitness, strict=True):
            assert float(problem.fitness(each.astype(float))) == pytest.approx(value, rel=1e-4)


def test_weights_lead_elsewhere_and_luck_too(found):
    assert not np.array_equal(found.x[0, 0], found.x[1, 0])
    assert not np.array_equal(found.x[0, 0], found.x[0, 1])


def test_a_run_is_the_same_in_other_company(scenarios, found):
    problem = js.Problem.from_scenario(scenarios[0], dtype=np.float32)
    again = run_settings(problem, js.pso(), WEIGHTS[::-1], np.array([[0, 1]] * 2), 20, 30)
    np.testing.assert_array_equal(again.x[1], found.x[0])
