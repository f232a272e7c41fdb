"""What a comparison does and does not show: tests, effect sizes, intervals and ranks.

Everything rests on the order of the fitness values, never on their differences: a penalty of 1000
per collision makes means and deviations a matter of a few bad runs. A NaN fitness means "no such
run" and is left out; +inf (a run that found nothing) is the worst value, equal to any other +inf.
What cannot be said (one run, two algorithms) is NaN.

The benchmark scenarios share tasks and obstacles, so they are not independent samples of anything:
read the tests across scenarios as descriptions.
"""

from itertools import combinations

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Float
from scipy import stats

from jaxsusp.report.render import Column, probability, significant, two_decimals

Values = Float[np.ndarray, "runs"]


def pairwise(ds: xr.Dataset) -> pd.DataFrame:
    """Compare every two algorithms in every scenario.

    Returns:
        One row per scenario and pair, columns scenario, a, b, and
        p: two-sided Mann-Whitney U test of equal distributions;
        p_holm: the same, corrected by Holm for the pairs of one scenario;
        a12: Vargha-Delaney effect size, the probability that a run of `a` beats (is below) a run
        of `b`, ties counting half: 1 means always, 0.5 no difference, 0 never.
    """
    rows = []
    for scenario in ds["scenario"].values.tolist():
        samples = samples_of(ds, scenario)
        pairs = list(combinations(samples, 2))
        p = [mann_whitney(samples[a], samples[b]) for a, b in pairs]
        for (a, b), raw, corrected in zip(pairs, p, holm(np.array(p)), strict=True):
            a12 = vargha_delaney(samples[a], samples[b])
            rows.append((scenario, a, b, raw, corrected, a12))
    frame = pd.DataFrame(rows, columns=["scenario", "a", "b", "p", "p_holm", "a12"])
    frame.attrs["title"] = "Pairs of algorithms"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["caption"] = (
        "Two-sided Mann-Whitney U test, corrected by Holm within a scenario; A₁₂: probability that "
        "a run of a is better than a run of b, ties counting half."
    )
    return frame


def medians(
    ds: xr.Dataset, level: float = 0.95, resamples: int = 10_000, seed: int = 0
) -> pd.DataFrame:
    """Median fitness with a bootstrap confidence interval (percentile method).

    The bounds are order statistics of the resampled medians, never interpolated, so that +inf
    stays what it is. Every cell uses the same stream of random numbers: its interval does not
    depend on which other algorithms and scenarios are there.

    Args:
        ds: a comparison.
        level: coverage, in (0, 1).
        resamples: number of bootstrap samples.
        seed: of the resampling.

    Returns:
        One row per scenario and algorithm, columns scenario, algorithm, median, low, high; low and
        high are NaN for fewer than two runs.
    """
    rows = [
        (scenario, algorithm, *_median_interval(values, level, resamples, seed))
        for scenario in ds["scenario"].values.tolist()
        for algorithm, values in samples_of(ds, scenario).items()
    ]
    frame = pd.DataFrame(rows, columns=["scenario", "algorithm", "median", "low", "high"])
    frame.attrs["title"] = "Median fitness"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["caption"] = (
        f"Low and high: bootstrap {100 * level:g} % confidence interval of the median, "
        f"{resamples} resamples, seed {seed}."
    )
    return frame


def mean_ranks(ds: xr.Dataset) -> pd.DataFrame:
    """Rank the algorithms by median fitness in every scenario, 1 the best, ties shared.

    Returns:
        One row per algorithm, best first: columns algorithm, mean_rank and one per scenario.
    """
    ranks = scenario_ranks(ds)
    frame = pd.DataFrame({"mean_rank": ranks.mean(axis=1), **ranks})
    frame = frame.sort_values("mean_rank", kind="stable").rename_axis("algorithm").reset_index()
    test = friedman(ds).iloc[0]
    p = probability(test["p"])
    told = f"p {p}" if p.startswith("<") else f"p = {p}"
    frame.attrs["title"] = "Ranks by median fitness"
    frame.attrs["columns"] = {name: Column(name, "{:g}".format) for name in ranks}
    frame.attrs["caption"] = (
        f"Friedman test over the scenarios: χ² = {significant(test['statistic'], 3)}, "
        f"{told}, Kendall's W = {two_decimals(test['kendall_w'])}. Scenarios share tasks and "
        "obstacles: a description, not a proof."
    )
    return frame


def friedman(ds: xr.Dataset) -> pd.DataFrame:
    """Friedman test of equal algorithms, the scenarios (their median fitness) as blocks.

    Returns:
        One row: scenarios, algorithms, statistic (χ², corrected for ties), p (χ² approximation,
        coarse for few scenarios) and kendall_w (0: rankings unrelated, 1: the same everywhere).
        NaN for fewer than three algorithms or two scenarios, where an algorithm has no run in a
        scenario, or where everything is tied.
    """
    ranks = scenario_ranks(ds)
    algorithms, scenarios = ranks.shape
    statistic = p = np.nan
    complete = ranks.notna().all(axis=None) and algorithms >= 3 and scenarios >= 2
    if complete and (ranks.nunique() > 1).any():
        statistic, p = map(float, stats.friedmanchisquare(*ranks.to_numpy()))
    agreement = statistic / (scenarios * (algorithms - 1)) if algorithms > 1 else np.nan
    columns = ["scenarios", "algorithms", "statistic", "p", "kendall_w"]
    return pd.DataFrame([(scenarios, algorithms, statistic, p, agreement)], columns=columns)


def median(values: Values) -> float:
    """Median; NaN of no values."""
    return float(np.median(values)) if len(values) else np.nan


def mann_whitney(a: Float[np.ndarray, " runs_a"], b: Float[np.ndarray, " runs_b"]) -> float:
    """p-value of the two-sided Mann-Whitney U test: exact for small samples without ties."""
    if min(len(a), len(b)) < 2:
        return np.nan
    ranks = stats.rankdata(np.concatenate([a, b]))  # finite, and the test sees ranks only
    return float(stats.mannwhitneyu(ranks[: len(a)], ranks[len(a) :]).pvalue)


def vargha_delaney(a: Float[np.ndarray, " runs_a"], b: Float[np.ndarray, " runs_b"]) -> float:
    """Probability that a value of `a` is below one of `b`, ties counting half (Â₁₂ for costs)."""
    if min(len(a), len(b)) < 2:
        return np.nan
    ordered = np.sort(b)
    above = len(b) - np.searchsorted(ordered, a, side="right")
    equal = len(b) - above - np.searchsorted(ordered, a, side="left")
    # Wins are whole and half numbers: their sum is exact, so that one division alone rounds and
    # 0.855 is 0.855 whichever way the sum was taken.
    return float(np.sum(above + 0.5 * equal) / (len(a) * len(b)))


def holm(p: Float[np.ndarray, " tests"]) -> Float[np.ndarray, " tests"]:
    """Holm's step-down correction of a family of p-values; NaN entries are not in the family."""
    corrected = np.full_like(p, np.nan)
    order = np.argsort(p)[: np.isfinite(p).sum()]  # NaN sorts last
    factors = np.arange(len(order), 0, -1)
    corrected[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1)
    return corrected


def _median_interval(
    values: Values, level: float, resamples: int, seed: int
) -> tuple[float, float, float]:
    if len(values) < 2:
        return median(values), np.nan, np.nan
    if len(values) > MANY:
        return _ideal_interval(np.sort(values), level)
    picks = np.random.default_rng(seed).integers(len(values), size=(resamples, len(values)))
    tail = [(1 - level) / 2, (1 + level) / 2]
    low, high = np.quantile(np.median(values[picks], axis=1), tail, method="inverted_cdf")
    return median(values), float(low), float(high)


MANY = 1000
"""Values above which medians are not resampled, for which what resampling tends to is as good."""


def _ideal_interval(ordered: Values, level: float) -> tuple[float, float, float]:
    """What the percentile method tends to with ever more resamples.

    The median of a resample is at most the k-th of n values when at least half of n draws, each
    with probability k/n, are.
    """
    n = len(ordered)
    at_most = stats.binom.sf((n + 1) // 2 - 1, n, np.arange(1, n + 1) / n)
    low, high = np.searchsorted(at_most, [(1 - level) / 2, (1 + level) / 2])
    return median(ordered), float(ordered[low]), float(ordered[min(high, n - 1)])


def samples_of(ds: xr.Dataset, scenario: str) -> dict[str, Values]:
    """Final fitness of the runs there are, by algorithm."""
    fitness = ds["fitness"].sel(scenario=scenario)
    values = {name: fitness.sel(algorithm=name).values for name in ds["algorithm"].values.tolist()}
    return {name: runs[~np.isnan(runs)] for name, runs in values.items()}


def scenario_ranks(ds: xr.Dataset) -> pd.DataFrame:
    """Rank of every algorithm's median (rows) in every scenario (columns)."""
    scenarios = ds["scenario"].values.tolist()
    centre = {scenario: samples_of(ds, scenario) for scenario in scenarios}
    return pd.DataFrame(centre).map(median).rank(axis=0)
