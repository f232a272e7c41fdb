"""Intervals cover as often as they say, and ranks of other runs are ranks."""

import numpy as np
import pytest
import xarray as xr

from jaxsusp.studies.resampling import crossed_interval, resampled_ranks

pytestmark = pytest.mark.fast


def test_an_interval_covers_the_truth_about_as_often_as_it_says():
    """Scenes and runs both vary; a little more often than 95 % of 200 is right."""
    random, covered = np.random.default_rng(1), 0
    for seed in range(200):
        scene, run = random.normal(size=(30, 1)), random.normal(size=(1, 12))
        values = scene + run + random.normal(size=(30, 12))
        low, high = crossed_interval(values, True, resamples=300, seed=seed)
        covered += low <= 0 <= high
    assert 178 <= covered <= 200


def test_scenes_that_are_meant_themselves_do_not_vary():
    values = np.broadcast_to(np.array([[0.0], [10.0]]), (2, 6))
    np.testing.assert_allclose(crossed_interval(values, scenes_vary=False), 5)
    low, high = crossed_interval(values, scenes_vary=True)
    assert low == pytest.approx(0)
    assert high == pytest.approx(10)


def test_an_interval_of_several_quantities_is_that_of_each():
    values = np.random.default_rng(0).normal(size=(3, 4, 5))
    together = crossed_interval(values, True)
    assert together.shape == (2, 3)
    np.testing.assert_allclose(together[:, 1], crossed_interval(values[1], True))


def test_ranks_of_algorithms_that_never_meet_are_always_the_same():
    fitness = np.arange(10.0) + 100 * np.array([2, 0, 1])[None, :, None] + np.zeros((4, 1, 1))
    ds = xr.Dataset({"fitness": (("scenario", "algorithm", "run"), fitness)})
    found = resampled_ranks(ds, resamples=50)
    assert found.shape == (50, 3)
    np.testing.assert_array_equal(found, np.tile([3, 1, 2], (50, 1)))


def test_ranks_of_equal_algorithms_are_now_this_now_that():
    fitness = np.random.default_rng(0).normal(size=(3, 2, 10))
    found = resampled_ranks(xr.Dataset({"fitness": (("scenario", "algorithm", "run"), fitness)}))
    np.testing.assert_allclose(found.sum(axis=1), 3)
    assert len(np.unique(found[:, 0])) > 1
