"""Intervals cover as often as they say, and ranks of other runs are ranks."""

import numpy as np
import pytest
import xarray as xr

from jaxsusp.studies.resampling import (
    crossed_interval,
    last,
    logarithm,
    mean_of,
    resampled_ranks,
)

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


def comparison(fitness: np.ndarray) -> xr.Dataset:
    return xr.Dataset({"fitness": (("scenario", "algorithm", "run"), fitness)})


def test_a_run_is_drawn_with_its_number_in_all_scenarios():
    """Two scenarios that repeat each other have the ranks of one: no draw tells them apart."""
    one = np.random.default_rng(0).normal(size=(1, 3, 8))
    twice = resampled_ranks(comparison(np.concatenate([one, one])))
    np.testing.assert_array_equal(twice, resampled_ranks(comparison(one)))


@pytest.mark.parametrize("nothing", [np.nan, np.inf])
def test_a_run_that_found_nothing_ranks_last_and_leaves_the_others_ranked(nothing):
    fitness = np.arange(10.0) + 100 * np.array([2, 0, 1])[None, :, None] + np.zeros((4, 1, 1))
    fitness[0, 1] = nothing
    found = resampled_ranks(comparison(fitness), resamples=50)
    np.testing.assert_array_equal(found, np.tile([(3 * 3 + 2) / 4, 6 / 4, 7 / 4], (50, 1)))


def test_cells_without_a_number_are_left_out_of_an_interval():
    """As if they had been drawn from the others; of nothing there is no interval."""
    values = np.random.default_rng(3).normal(size=(40, 12))
    whole = crossed_interval(values, True)
    holed = values.copy()
    holed[0, 0], holed[7, 3] = np.nan, np.inf
    np.testing.assert_allclose(crossed_interval(holed, True), whole, atol=0.02)
    assert np.isnan(crossed_interval(np.full((3, 4), np.nan), True)).all()
    np.testing.assert_allclose(mean_of(holed), holed[np.isfinite(holed)].mean())
    assert np.isnan(mean_of(np.full(3, np.inf)))
    np.testing.assert_array_equal(last(np.array([1.0, np.nan])), [1, np.inf])
    np.testing.assert_array_equal(logarithm(np.array([1.0, np.inf, np.nan])), [0, np.nan, np.nan])
