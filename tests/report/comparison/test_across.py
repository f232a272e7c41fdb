"""Critical differences: what Demšar prints, and what a hand can rank."""

import numpy as np
import pandas as pd
import pytest

from jaxsusp.report.browser import results
from jaxsusp.report.comparison import across, folder

pytestmark = pytest.mark.fast


def test_critical_differences_are_those_of_the_paper():
    """Demšar 2006, Sect. 3.2.2: four classifiers, 14 data sets, q = 2.569; Table 5a."""
    assert across.critical_difference(4, 14) == pytest.approx(1.25, abs=0.005)
    assert across.critical_difference(4, 14, 0.10) == pytest.approx(1.12, abs=0.005)
    quantiles = [1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164]
    for count, quantile in enumerate(quantiles, start=2):
        found = across.critical_difference(count, 6) / np.sqrt(count * (count + 1) / 36)
        assert found == pytest.approx(quantile, abs=0.001)


def test_nemenyi_gives_the_level_at_the_critical_difference():
    assert across.nemenyi(across.critical_difference(5, 9), 5, 9) == pytest.approx(0.05)
    assert across.nemenyi(0.0, 4, 6) == pytest.approx(1.0)


def test_a_pair_that_is_always_in_the_same_order(comparison):
    """Two scenarios rank sdbo 1, dbo 2, ga 3, pso 4; their runs overlap."""
    frame = across.across_table(comparison).set_index(["a", "b"])
    worst = frame.loc["pso", "sdbo"]
    assert (worst["rank_a"], worst["rank_b"]) == (4, 1)
    assert worst["p_nemenyi"] == pytest.approx(across.nemenyi(3.0, 4, 2))
    assert worst["p_wilcoxon"] == 0.5  # two scenarios: the least that there is
    assert worst["p_holm"] == 1.0
    # 400 800 1200 2400 against 100 200 300 600: of 16 pairs pso wins one
    assert worst["a12"] == pytest.approx(1 / 16)


def test_cases_without_ranks(comparison):
    two = comparison.sel(algorithm=["pso", "sdbo"])
    comparison["fitness"][0, 1] = np.nan
    for ds in (two, comparison, comparison.isel(scenario=[0])):
        assert across.across_table(ds).empty
        assert across.diagram(ds) is None


def test_wilcoxon_knows_infinity_and_ties():
    huge = np.array([np.inf, np.inf, 3.0, 4.0])
    assert across.wilcoxon(huge, huge) == 1.0
    assert across.wilcoxon(np.full(6, np.inf), np.arange(1.0, 7)) == pytest.approx(2 / 64)


def test_cliques_hold_what_is_no_further_apart_and_none_lies_in_another():
    mean = pd.Series({"a": 1.0, "b": 1.5, "c": 2.4, "d": 4.0})
    assert across.cliques(mean, 1.0) == [("a", "b"), ("b", "c")]
    assert across.cliques(mean, 1.5) == [("a", "b", "c")]
    assert across.cliques(mean, 0.1) == []
    assert across.cliques(mean, 3.0) == [("a", "b", "c", "d")]


def test_the_diagram_names_all_with_their_ranks_and_bars_them(comparison):
    figure = across.diagram(comparison)
    assert figure is not None
    (axes,) = figure.axes
    told = [text.get_text() for text in axes.texts]
    assert {"SDBO  1.00", "DBO  2.00", "GA  3.00", "PSO  4.00"} <= set(told)
    # 2 scenarios, 4 algorithms: 3.32, more than there is between first and last
    assert "critical difference 3.32 (more than the scale)" in told
    bars = [line for line in axes.get_lines() if line.get_linewidth() == 3.5]
    assert [line.get_xdata().tolist() for line in bars] == [[0.96, 4.04]]


def test_every_figure_of_a_comparison_has_a_title_on_its_page():
    assert results.TITLES.keys() == folder._FIGURES.keys()
