"""Expected running times and their intervals, by hand."""

import numpy as np
import pytest

from jaxsusp.report.comparison import gaps, runningtime

pytestmark = pytest.mark.fast


def test_the_table_agrees_with_the_running_times_of_the_gaps(comparison):
    comparison["best_known"] = ("scenario", [400.0, np.nan])
    frame = runningtime.running_time_table(comparison)
    assert set(frame["target"]) == {"+10 %", "+1 %"}  # no scenario file: a clear one is not known
    assert set(frame["scenario"]) == {"scenario-1"}
    expected = gaps.expected_running_time(comparison, 1.1 * comparison["best_known"])
    for row in frame[frame["target"] == "+10 %"].itertuples():
        assert row.ert == expected.sel(scenario=row.scenario, algorithm=row.algorithm)
        assert row.low <= row.ert <= row.high


def test_equal_runs_have_no_spread():
    assert runningtime.bootstrap(np.full(5, 30.0), 100.0, 0.95, 200, 0) == (30, 30, 30)


def test_runs_that_fail_cost_their_budget():
    spent = np.array([20.0, np.inf])
    ert, low, high = runningtime.bootstrap(spent, 100.0, 0.95, 4000, 0)
    assert ert == 120  # 20 + 100 for one success
    # resamples are (20, 20), (20, 100) twice, (100, 100): ERT 20, 120 and none
    assert (low, high) == (20, np.inf)
    assert runningtime.bootstrap(spent, 100.0, 0.4, 4000, 0) == (120, 120, 120)


def test_nobody_gets_there_or_nobody_knows_how_sure_that_is():
    assert runningtime.bootstrap(np.full(3, np.inf), 100.0, 0.95, 50, 0) == (np.inf,) * 3
    ert, low, high = runningtime.bootstrap(np.array([7.0]), 100.0, 0.95, 50, 0)
    assert ert == 7
    assert np.isnan([low, high]).all()
