"""Logistic curves: known ones are found again, and what parts everything stays finite."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit

from jaxsusp.report.comparison.logistic import fitted, resampled, share_interval

pytestmark = pytest.mark.fast
RANDOM = np.random.default_rng(0)
COLUMNS = RANDOM.normal(size=(400, 2)) * [1, 3] + [0, 5]
RUNS = np.full(400, 20.0)
SUCCESSES = RANDOM.binomial(20, expit(-1 + COLUMNS @ [1.5, 0.3])).astype(float)


def test_a_known_curve_is_found_again():
    found = fitted(COLUMNS, SUCCESSES, RUNS)
    np.testing.assert_allclose(found.slopes, [1.5, 0.3], atol=0.08)
    assert found.intercept == pytest.approx(-1, abs=0.2)


def test_it_is_the_likeliest_one():
    """Against scipy's general minimiser, to what the slight ridge moves."""

    def cost(beta):
        odds = beta[0] + COLUMNS @ beta[1:]
        return (RUNS * np.logaddexp(0, odds) - SUCCESSES * odds).sum()

    other = minimize(cost, np.zeros(3)).x
    found = fitted(COLUMNS, SUCCESSES, RUNS)
    np.testing.assert_allclose([found.intercept, *found.slopes], other, atol=1e-3)


def test_a_column_that_parts_everything_or_nothing_stays_finite():
    columns = np.column_stack([np.arange(10.0), np.ones(10)])
    found = fitted(columns, 5.0 * (np.arange(10) > 4), np.full(10, 5.0))
    assert np.isfinite(found.slopes).all()
    assert found.slopes[1] == 0
    assert found.share(columns)[[0, -1]] == pytest.approx([0, 1], abs=0.05)


def test_intervals_come_from_tasks_and_hold_the_truth():
    curves = resampled(COLUMNS[:60], SUCCESSES[:60], RUNS[:60], 200)
    low, high = np.quantile([each.slopes[0] for each in curves], [0.025, 0.975])
    assert low < 1.5 < high
    assert high - low < 0.8


def test_shares_have_wilson_intervals():
    assert share_interval(0, 0) == (0, 1)
    low, high = share_interval(10, 10)
    assert low == pytest.approx(10 / (10 + 1.959964**2), rel=1e-6)
    assert high == 1
