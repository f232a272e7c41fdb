"""One flat batch: runs join it, scenarios are taken in turn, and it is cut into blocks."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.problem import flatbatch
from jaxsusp.problem.flatbatch import one_flat_batch


@pytest.fixture
def sizes(monkeypatch) -> list[int]:
    """How many candidates a function is asked for at a time, with blocks of at most eight."""
    monkeypatch.setattr(flatbatch, "BLOCK", 8)
    return []


def scaled(sizes: list[int]):
    """Every candidate, times a coefficient of its scenario."""

    def of(coefficient, x):
        sizes.append(len(x))
        return coefficient * x

    return one_flat_batch(of)


@pytest.mark.fast
@pytest.mark.parametrize("count", [1, 7, 8, 9, 16, 17, 100])
def test_no_more_are_looked_at_than_a_block_holds_and_all_come_back_in_order(sizes, count):
    x = np.arange(3.0 * count).reshape(count, 3)
    np.testing.assert_array_equal(scaled(sizes)(jnp.float64(2.0), x), 2 * x)
    assert 0 < max(sizes) <= 8


@pytest.mark.fast
@pytest.mark.parametrize("runs", [1, 2, 5])
def test_runs_join_the_batch_and_scenarios_keep_their_coefficients(sizes, runs):
    x = np.random.default_rng(0).uniform(size=(4, runs, 3, 2))
    coefficients = jnp.arange(4.0)
    over_runs = jax.vmap(scaled(sizes), in_axes=(None, 0))
    found = jax.jit(jax.vmap(over_runs))(coefficients, x)
    np.testing.assert_array_equal(found, coefficients[:, None, None, None] * x)
    assert max(sizes) == min(3 * runs, 8)


def test_what_a_candidate_is_worth_does_not_depend_on_blocks(monkeypatch):
    problem = js.Problem.from_scenario("scenario-3", dtype=np.float32)
    x = problem.sample(jax.random.key(0), 100)
    whole = problem.fitness.terms(x.T).total
    monkeypatch.setattr(flatbatch, "BLOCK", 16)
    np.testing.assert_allclose(problem.evaluate(x), whole, rtol=1e-6)
    np.testing.assert_allclose(problem.repair(x), x, atol=1e-6)
