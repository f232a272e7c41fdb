"""Tests, effect sizes and ranks against numbers that follow by hand."""

import numpy as np
import pytest

from jaxsusp.report.comparison import statistics

INF = np.inf


def values(*numbers):
    return np.array(numbers, float)


@pytest.mark.fast
def test_mann_whitney_of_two_separate_samples_is_exact():
    # of the C(6, 3) = 20 equally likely orders two are as extreme
    assert statistics.mann_whitney(values(1, 2, 3), values(4, 5, 6)) == pytest.approx(2 / 20)


@pytest.mark.fast
def test_mann_whitney_sees_the_order_only():
    a, b = values(1, 2, 5, 7, 9), values(3, 4, 6, 8)
    assert statistics.mann_whitney(a, b) == statistics.mann_whitney(np.exp(a), np.exp(b))


@pytest.mark.fast
@pytest.mark.parametrize("same", [values(1, 1, 1), values(INF, INF)])
def test_equal_samples_differ_in_nothing(same):
    assert statistics.mann_whitney(same, same) == 1
    assert statistics.vargha_delaney(same, same) == 0.5


@pytest.mark.fast
def test_a12_counts_the_pairs_that_a_wins():
    assert statistics.vargha_delaney(values(1, 2, 3), values(4, 5)) == 1
    assert statistics.vargha_delaney(values(1, 4), values(2, 3)) == 0.5
    assert statistics.vargha_delaney(values(1, INF), values(INF, INF)) == 0.75  # (2 + 2·½) / 4


@pytest.mark.fast
@pytest.mark.parametrize("measure", [statistics.mann_whitney, statistics.vargha_delaney])
def test_one_run_says_nothing(measure):
    assert np.isnan(measure(values(1), values(2, 3)))


@pytest.mark.fast
def test_holm_steps_down():
    # 4·0.01, then 3·0.02 = 0.06, then 2·0.02 = 0.04 raised to 0.06, then 1·0.5
    corrected = statistics.holm(values(0.5, 0.02, 0.01, 0.02))
    assert corrected.tolist() == pytest.approx([0.5, 0.06, 0.04, 0.06])
    assert statistics.holm(values(0.6, 0.7)).tolist() == [1, 1]


def test_holm_leaves_out_what_was_not_tested():
    corrected = statistics.holm(values(np.nan, 0.02, np.nan, 0.03))
    assert corrected[[1, 3]].tolist() == pytest.approx([0.04, 0.04])
    assert np.isnan(corrected[[0, 2]]).all()


def test_pairwise_lists_every_pair_once(comparison):
    frame = statistics.pairwise(comparison)
    assert len(frame) == 2 * 6
    first = frame.iloc[0]
    assert (first["scenario"], first["a"], first["b"]) == ("scenario-1", "pso", "ga")
    # pso 400 800 1200 2400, ga 300 600 900 1800: pso is below in 3 + 2 + 1 + 0 of 16 pairs
    assert first["a12"] == 6 / 16
    assert (frame["p_holm"] >= frame["p"]).all()


def test_the_median_interval_holds_the_median_and_is_repeatable(comparison):
    frame = statistics.medians(comparison, resamples=500)
    assert frame["median"].tolist()[:4] == [1000, 750, 500, 250]
    assert (frame["low"] <= frame["median"]).all()
    assert (frame["median"] <= frame["high"]).all()
    assert frame.equals(statistics.medians(comparison, resamples=500))
    alone = statistics.medians(comparison.sel(algorithm=["sdbo"]), resamples=500)
    assert alone.iloc[0].equals(frame.iloc[3].rename(0))


def test_the_median_interval_covers_as_often_as_it_says(comparison):
    draws = np.random.default_rng(0).normal(size=(2, 100, 21))
    many = comparison.drop_dims(["algorithm", "run"]).assign(
        fitness=(("scenario", "algorithm", "run"), draws)
    )
    many = many.assign_coords(algorithm=[str(i) for i in range(100)])
    frame = statistics.medians(many, resamples=400)
    covered = ((frame["low"] <= 0) & (frame["high"] >= 0)).mean()
    assert 0.9 < covered < 0.99


def test_of_many_runs_the_interval_is_what_resampling_tends_to(comparison, monkeypatch):
    draws = np.random.default_rng(0).exponential(size=(1, 1, 1001))
    many = comparison.drop_dims(["scenario", "algorithm", "run"]).assign(
        fitness=(("scenario", "algorithm", "run"), draws)
    )
    many = many.assign_coords(scenario=["s"], algorithm=["a"])
    ideal = statistics.medians(many).iloc[0]
    monkeypatch.setattr(statistics, "MANY", 10_000)
    drawn = statistics.medians(many, resamples=20_000).iloc[0]
    ordered = np.sort(draws.ravel())
    for name in ("low", "high"):
        places = np.searchsorted(ordered, [ideal[name], drawn[name]])
        assert abs(np.diff(places).item()) <= 1, name
    assert ideal["median"] == drawn["median"] == ordered[500]


def test_infinite_fitness_stays_in_the_interval(comparison):
    comparison["fitness"][0, 0, :3] = INF
    row = statistics.medians(comparison, resamples=200).iloc[0]
    assert row["median"] == INF
    assert row["high"] == INF


def test_mean_ranks_share_ties(comparison):
    comparison["fitness"][0, 3] = comparison["fitness"][0, 2]  # sdbo as good as dbo in scenario-1
    frame = statistics.mean_ranks(comparison)
    assert frame["algorithm"].tolist() == ["sdbo", "dbo", "ga", "pso"]
    assert frame["mean_rank"].tolist() == [1.25, 1.75, 3, 4]
    assert frame["scenario-1"].tolist() == [1.5, 1.5, 3, 4]


def test_friedman_of_unanimous_scenarios(comparison):
    row = statistics.friedman(comparison).iloc[0]
    # χ² = 12/(n k (k+1)) Σ R² - 3 n (k+1) = 12/40·(8² + 6² + 4² + 2²) - 30 = 6, and W = χ²/(n(k-1))
    assert row["statistic"] == pytest.approx(6)
    assert row["kendall_w"] == pytest.approx(1)
    assert (row["scenarios"], row["algorithms"]) == (2, 4)


def test_friedman_needs_three_algorithms_two_scenarios_and_a_difference(comparison):
    flat = comparison.copy(deep=True)
    flat["fitness"][:] = 1.0
    missing = comparison.copy(deep=True)
    missing["fitness"][0, 0] = np.nan
    few = (comparison.isel(algorithm=[0, 1]), comparison.isel(scenario=[0]), flat, missing)
    for ds in few:
        assert np.isnan(statistics.friedman(ds)["p"]).all()
        assert "p = –" in statistics.mean_ranks(ds).attrs["caption"]


def test_one_run_gives_nan_everywhere(comparison):
    one = comparison.isel(run=[0])
    assert statistics.pairwise(one)[["p", "p_holm", "a12"]].isna().all(axis=None)
    frame = statistics.medians(one)
    assert frame["median"].tolist()[:4] == [800, 600, 400, 200]
    assert frame[["low", "high"]].isna().all(axis=None)
