"""Critical differences and corrections against scikit-posthocs and statsmodels."""

import warnings

import numpy as np
import pytest
import xarray as xr

from jaxsusp.report.comparison import across
from jaxsusp.report.comparison.statistics import holm

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import scikit_posthocs
    from statsmodels.stats.multitest import multipletests

NAMES = ["pso", "ga", "dbo", "sdbo"]


def drawn(seed):
    """Seven scenarios of five runs; the later an algorithm, the worse it tends to be."""
    random = np.random.default_rng(seed)
    fitness = random.gamma(3.0, 20.0, (7, 4, 5)) + 15 * np.arange(4)[:, None]
    places = {"scenario": [f"s{i}" for i in range(7)], "algorithm": NAMES}
    return xr.Dataset({"fitness": (("scenario", "algorithm", "run"), fitness)}, places)


@pytest.mark.parametrize("seed", range(3))
def test_nemenyi_is_theirs(seed):
    ds = drawn(seed)
    theirs = scikit_posthocs.posthoc_nemenyi_friedman(ds["fitness"].median("run").values)
    for row in across.across_table(ds).itertuples():
        expected = theirs.iloc[NAMES.index(row.a), NAMES.index(row.b)]
        assert row.p_nemenyi == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_holm_is_theirs(seed):
    p = np.random.default_rng(seed).uniform(0, 0.2, 9)
    assert holm(p) == pytest.approx(multipletests(p, method="holm")[1])


def test_wilcoxon_over_scenarios_is_theirs():
    """Where all medians are of one size, relative differences are ranked as plain ones."""
    ds = drawn(0)
    middle = ds["fitness"].median("run")
    apart = (middle - middle.mean("algorithm")) * 1e-6 + 100  # nearly equal: |a| + |b| is constant
    small = ds.isel(run=[0]).assign(fitness=apart.expand_dims(run=1, axis=-1))
    frame = across.across_table(small).set_index(["a", "b"])
    long = apart.to_series().rename("value").reset_index()
    theirs = scikit_posthocs.posthoc_wilcoxon(long, "value", "algorithm")
    for (a, b), row in frame.iterrows():
        assert row["p_wilcoxon"] == pytest.approx(theirs.loc[a, b], rel=1e-6)
