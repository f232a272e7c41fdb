"""Distances from the best known fitness and expected running times, worked out by hand.

In conftest.py a history falls as 16, 8, 4, 2, 1 times the final fitness, 30 evaluations each. PSO
ends in scenario-1 at 800, 400, 1200 and 2400; its last run collides.
"""

import io
import json

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

from jaxsusp.report.comparison import folder, gaps, tables, targets
from jaxsusp.report.render import above, to_rich

pytestmark = pytest.mark.fast


def known(ds, first=400.0, second=np.nan):
    return ds.assign(best_known=("scenario", [first, second]))


def stated(ds, weights=(1.0,) * 6, kappa=1000.0):
    text = f"[fitness]\nweights = {list(weights)}\nkappa = {kappa}\n"
    return ds.assign_attrs(scenario_files=json.dumps({"scenario-1": text}))


def of_pso(values):
    return values.sel(scenario="scenario-1", algorithm="pso").values.tolist()


def test_a_gap_is_relative_and_known_only_where_the_best_is(comparison):
    ds = known(comparison)
    assert of_pso(gaps.gaps(ds)) == [1, 0, 2, 5]
    assert of_pso(gaps.mean_gap(ds)) == 200
    assert gaps.gaps(ds).sel(scenario="scenario-5").isnull().all()
    assert gaps.gaps(known(comparison, 0.0)).isnull().all()


def test_evaluations_to_a_target_are_those_of_whole_iterations(comparison):
    assert of_pso(gaps.evaluations_to(comparison, 1600.0)) == [120, 90, 150, np.inf]
    begun = comparison.assign(evaluations_initial=0 * comparison["evaluations"] + 50)
    assert of_pso(gaps.evaluations_to(begun, 1600.0)) == [130, 110, 150, np.inf]
    assert of_pso(gaps.evaluations_to(begun, 1e9)) == [70] * 4
    # sdbo makes three iterations of 100: 1600 800 100, and its last run 9600 4800 600
    sdbo = gaps.evaluations_to(comparison, 100.0).sel(scenario="scenario-1", algorithm="sdbo")
    assert sdbo.values.tolist() == [np.inf, 300, np.inf, np.inf]


def test_of_thinned_histories_a_target_is_reached_at_the_next_iteration_kept(comparison):
    thin = comparison.assign_coords(iteration=[1, 2, 3, 4, 5]).sel(iteration=[1, 3, 5])
    assert of_pso(gaps.evaluations_to(thin, 1600.0)) == [150, 90, 150, np.inf]
    assert of_pso(gaps.evaluations_to(thin, 1e9)) == [30] * 4


def test_the_expected_running_time_pays_for_the_runs_that_fail(comparison):
    ert = gaps.expected_running_time
    assert of_pso(ert(comparison, 1600.0)) == (120 + 90 + 150 + 150) / 3
    assert of_pso(ert(comparison, 400.0)) == 4 * 150 / 1
    assert of_pso(ert(comparison, 399.0)) == np.inf
    assert np.isnan(of_pso(ert(comparison, np.nan)))
    comparison["fitness"][0, 0, 3] = np.nan  # there is no such run
    assert of_pso(ert(comparison, 1600.0)) == (120 + 90 + 150) / 3


def test_clear_is_what_costs_less_than_one_collision(comparison):
    ds = stated(comparison, (1.0, 1.0, 1.0, 1.0, 1.0, 2.0), 800.0)  # 1600 is not below 1600
    price = gaps.clear_fitness(ds)
    assert of_pso(gaps.expected_running_time(ds, price)) == (150 + 120 + 150 + 150) / 3
    assert price.isnull().values.tolist() == [False, True]  # scenario-5 is not there


@pytest.mark.parametrize("odd", [{"kappa": 0.0}, {"weights": (-1.0, *[1.0] * 5)}])
def test_where_a_fitness_does_not_tell_what_is_clear_nothing_is_said(comparison, odd):
    assert gaps.clear_fitness(stated(comparison, **odd)).isnull().all()


def test_the_table_holds_what_is_known(comparison):
    frame = gaps.gap_table(stated(known(comparison)))
    assert frame.columns.tolist() == [
        *("scenario", "algorithm", "gap", "gap_median", "clear", "runs"),
        *("ert_clear", "ert_10", "ert_1"),
    ]
    pso = frame.iloc[0]
    assert (pso["gap"], pso["gap_median"], pso["clear"], pso["runs"]) == (200, 150, 3, 4)
    assert pso["ert_clear"] == (150 + 120 + 150 + 150) / 2  # 800 and 400 cost less than 1000
    assert pso["ert_1"] == 600
    assert "price of one collision" in frame.attrs["caption"]
    nothing = gaps.gap_table(comparison)
    assert nothing.columns.tolist() == ["scenario", "algorithm", "clear", "runs"]


def test_the_summary_is_over_the_scenarios(comparison):
    frame = gaps.gap_summary(known(comparison, 400.0, 1000.0)).set_index("algorithm")
    # in scenario-5 pso ends at 800 (2, 1, 3, 6): 1600 800 2400 4800, on average 2400
    assert frame.loc["pso", "gap"] == pytest.approx((200 + 140) / 2)
    assert frame.loc["pso", "worst"] == pytest.approx(200)
    assert (frame.loc["pso", "clear"], frame.loc["pso", "runs"]) == (6, 8)
    assert (frame["all_clear"] == 0).all()
    clear = gaps.gap_summary(comparison.isel(run=[0, 1])).set_index("algorithm")
    assert clear["all_clear"].tolist() == [2, 2, 1, 2]
    assert "gap" not in clear
    assert "No best fitness" in gaps.gap_summary(comparison).attrs["caption"]


def test_what_never_found_anything_is_infinitely_far(comparison):
    ds = known(comparison, 400.0, 400.0)
    ds["fitness"][0, 0, 0] = np.inf
    frame = gaps.gap_table(ds)
    assert frame.loc[0, "gap"] == np.inf
    assert frame.loc[0, "gap_median"] == (200 + 500) / 2


def test_the_comparison_has_a_gap_where_the_best_is_known(comparison):
    assert "gap" not in tables.comparison_table(comparison)
    frame = tables.comparison_table(known(comparison))
    assert frame["gap"].tolist()[:4] == [200, 125, 50, -25]
    assert frame["gap"].isna().tolist()[4:] == [True] * 4
    assert "best known is not proved to be best" in frame.attrs["caption"]
    console = Console(width=80, file=io.StringIO())
    comparison["evaluations"][:] = 45_090
    console.print(to_rich(tables.comparison_table(known(comparison, 10.0, 1600.0))))
    text = console.file.getvalue()
    assert "…" not in text
    assert "11900" in text.splitlines()[6]
    for build in (gaps.gap_table, gaps.gap_summary):
        console.print(to_rich(build(stated(known(comparison)))))
    assert "…" not in console.file.getvalue()


def test_a_clear_run_below_the_best_known_is_told(comparison):
    ds = known(comparison, 150.0)
    (sentence,) = gaps.better_than_known(ds)
    assert sentence == (
        "scenario-1: run 1 of sdbo is clear and better than the best known, 100.000000 < 150.000000"
    )
    ds["collisions"][0, 3, 1] = 1
    assert [*gaps.better_than_known(ds)] == []
    assert [*gaps.better_than_known(known(comparison, 100.0 * (1 + 1e-12)))] == []


@pytest.mark.parametrize(
    ("gap", "text"),
    [(0.04, "0.0"), (9.94, "9.9"), (9.96, "10"), (1622.2, "1622"), (-2.5, "-2.5"), (-1e-9, "0.0"),
     (np.nan, "–"), (np.inf, "∞")],
)  # fmt: skip
def test_gaps_are_written_short(gap, text):
    assert above(gap) == text


def test_shares_of_targets_are_counted_over_runs_and_targets(comparison, monkeypatch):
    monkeypatch.setattr(targets, "TARGETS", np.array([3.0, 1.0, 0.0]))  # 1600, 800, 400
    spent, share = targets.reached(known(comparison), "pso")
    # at 120 90 150 ∞, 150 120 ∞ ∞ and ∞ 150 ∞ ∞ evaluations
    assert spent.tolist() == [90, 120, 150]
    assert (12 * share).tolist() == pytest.approx([1, 3, 6])


def test_the_figure_has_a_line_per_algorithm_that_ends_where_its_runs_end(comparison):
    assert targets.running_times(comparison) is None
    (axes,) = targets.running_times(known(comparison, 100.0)).axes
    ends = {line.get_label(): line.get_xydata()[-1].tolist() for line in axes.get_lines()}
    # sdbo ends at 200 100 300 600: one run reaches all 31 targets and one the first
    assert ends["SDBO"] == [300, pytest.approx(32 / 124)]
    assert ends["PSO"] == [150, 0]
    assert axes.get_xscale() == "log"
    assert len({line.get_marker() for line in axes.get_lines()}) == 4


def test_targets_go_from_100_percent_to_a_tenth_of_a_percent():
    assert (targets.TARGETS[0], targets.TARGETS[-1]) == (1, pytest.approx(0.001))
    assert np.ptp(np.diff(np.log(targets.TARGETS))) < 1e-12


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        ("iterations", 'Budget: 500 iterations (budget = "iterations").'),
        ("evaluations", "Budget: 15,030 fitness evaluations"),
        ("time", "measured on one machine, on which all numbers depend; iterations made in it: "
            "pso 5, ga 5, dbo 5, sdbo 3."),
    ],
)  # fmt: skip
def test_every_table_names_the_budget(comparison, rule, said):
    settings = {"budget": rule, "iterations": 500, "population": 30}
    built = folder.build_tables(comparison.assign_attrs(settings=json.dumps(settings)))
    assert {"comparison", "gap", "gap-summary", "medians", "ranks"} <= built.keys()
    assert all(said in frame.attrs["caption"] for frame in built.values())


def test_a_polished_run_gets_there_with_its_last_evaluation(comparison):
    """And what came before is counted as if nothing had followed."""
    before = gaps.evaluations_to(comparison, 800.0)
    more = {name: comparison[name] + 50 for name in ("evaluations", "evaluations_polish")}
    polished = comparison.assign(fitness=comparison["fitness"] / 10, **more)
    found = gaps.evaluations_to(polished, 800.0)
    late = np.isinf(before) & (polished["fitness"] <= 800)
    assert late.any()
    assert (found == polished["evaluations"]).where(late, True).all()
    xr.testing.assert_identical(found.where(~late), before.where(~late))


def test_captions_tell_of_polishing(comparison):
    settings = {"budget": "iterations", "iterations": 500, "population": 30, "polish": True}
    more = comparison["evaluations_polish"] + 781
    ds = comparison.assign(evaluations_polish=more).assign_attrs(settings=json.dumps(settings))
    said = "polished at the end, with 781 evaluations on top of the budget (polish = True)."
    assert all(frame.attrs["caption"].endswith(said) for frame in folder.build_tables(ds).values())
    plain = comparison.assign_attrs(settings=json.dumps({**settings, "polish": False}))
    frames = folder.build_tables(plain).values()
    assert not any("polish" in frame.attrs["caption"] for frame in frames)


def test_of_many_scenarios_there_is_a_summary_and_one_picture(comparison, monkeypatch, tmp_path):
    monkeypatch.setattr(folder, "save", lambda figure, path: path.write_text("picture"))
    names = [f"random-{i}" for i in range(folder.MOST_DRAWN + 1)]
    many = (
        known(comparison)
        .isel(scenario=[0] * len(names), algorithm=[0])
        .assign_coords(scenario=names)
    )
    told = []
    files = folder.write_report(many, tmp_path, told.append)
    assert [file.name for file in files if file.suffix == ".png"] == ["ecdf.png"]
    assert told == ["13 scenarios: pictures of each are drawn where there are at most 12"]
    assert folder.printed(many, gap=False) == ("gap-summary",)
    assert folder.printed(many, gap=True) == ("gap-summary", "gap")
    assert folder.printed(comparison, gap=False) == ("comparison", "ratios", "stability")
