"""jDE: whom a member is crossed with, and what survives."""

import jax
import numpy as np
import pytest
from scipy.stats import chisquare

import jaxsusp as js
from jaxsusp.optim.algorithms.jde import others


@pytest.mark.fast
def test_three_others_are_distinct_and_uniform():
    count, keys = 5, jax.random.split(jax.random.key(0), 4000)
    picked = np.stack(jax.vmap(lambda key: others(key, count))(keys))  # (3, keys, member)
    member = np.arange(count)
    for one in range(3):
        assert (picked[one] != member).all()
        assert (picked[one] != picked[(one + 1) % 3]).all()
    triples = picked[:, :, 2].T @ np.array([25, 5, 1])
    _, counts = np.unique(triples, return_counts=True)
    assert len(counts) == 4 * 3 * 2
    assert chisquare(counts).pvalue > 1e-3


@pytest.mark.fast
def test_factors_survive_with_the_trial_that_they_made():
    problem = js.Problem(lambda x: (x**2).sum(), -np.ones(3), np.ones(3))
    optimizer = js.jde(renew_scale=1.0, renew_crossover=1.0)
    state = optimizer.init(jax.random.key(0), problem, 8, 10)
    after, _ = optimizer.step(jax.random.key(1), problem, state)
    changed = np.asarray((after.x != state.x).any(axis=1))
    assert 0 < changed.sum() < 8
    np.testing.assert_array_equal(np.asarray(after.scale)[~changed], 0.5)
    np.testing.assert_array_equal(np.asarray(after.crossover)[~changed], 0.9)
    assert (np.asarray(after.scale)[changed] != 0.5).all()
    assert (np.asarray(after.scale) >= 0.1).all()
    assert (after.fitness <= state.fitness).all()
