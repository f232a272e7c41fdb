"""Tables of the synthetic comparison of conftest.py, whose numbers can be checked by hand."""

import io

import numpy as np
import pandas as pd
import pytest
from rich.console import Console

from jaxsusp.report.comparison import tables
from jaxsusp.report.render import (
    duration,
    percent,
    probability,
    significant,
    to_csv,
    to_markdown,
    to_rich,
)


def row(frame, scenario, algorithm):
    return frame[(frame["scenario"] == scenario) & (frame["algorithm"] == algorithm)].iloc[0]


def printed(frame, width=80) -> str:
    console = Console(width=width, file=io.StringIO())
    console.print(to_rich(frame))
    return console.file.getvalue()


def test_comparison_table_has_the_papers_columns(comparison):
    frame = tables.comparison_table(comparison)
    assert frame.columns.tolist() == [
        *("scenario", "obstacles", "algorithm", "min", "max", "average", "std", "length"),
        *("height", "curvature_radius", "runtime", "evaluations", "clear", "runs"),
    ]
    assert frame["algorithm"].tolist() == ["pso", "ga", "dbo", "sdbo"] * 2
    assert frame["obstacles"].tolist() == [6] * 4 + [10] * 4


def test_statistics_of_a_row(comparison):
    sdbo = row(tables.comparison_table(comparison), "scenario-1", "sdbo")
    assert (sdbo["min"], sdbo["max"], sdbo["average"]) == (100, 600, 300)
    assert sdbo["std"] == pytest.approx(100 * np.sqrt(14 / 3))
    assert sdbo["evaluations"] == 300
    assert (sdbo["clear"], sdbo["runs"]) == (3, 4)


def test_length_height_and_radius_belong_to_the_best_run(comparison):
    pso = row(tables.comparison_table(comparison), "scenario-5", "pso")
    assert (pso["length"], pso["height"], pso["curvature_radius"]) == (16, 80, 1)  # 800/50, 800/10


def test_run_time_is_the_share_of_one_run(comparison):
    frame = tables.comparison_table(comparison)
    assert row(frame, "scenario-1", "sdbo")["runtime"] == 2.0  # 16 s / (2 scenarios × 4 runs)
    assert row(frame, "scenario-5", "dbo")["runtime"] == pytest.approx(0.01)
    assert "share" in frame.attrs["caption"]


def test_a_violation_alone_makes_a_run_unclear(comparison):
    comparison["violations"][0, 3, 0] = 1
    assert row(tables.comparison_table(comparison), "scenario-1", "sdbo")["clear"] == 2


def test_the_best_values_are_stressed_among_algorithms_that_are_clear(comparison):
    bold = tables.comparison_table(comparison).attrs["bold"]
    assert {(3, "min"), (3, "length"), (7, "max")} <= bold
    # dbo has the largest radius and the least run time, but no clear run in scenario-1
    assert {(3, "curvature_radius"), (0, "runtime")} <= bold
    assert {(6, "curvature_radius"), (6, "runtime")} <= bold
    assert (2, "runtime") not in bold
    assert {(4, "clear"), (5, "clear"), (6, "clear"), (7, "clear")} <= bold  # a tie


def test_nothing_is_stressed_without_a_rival(comparison):
    frame = tables.comparison_table(comparison.sel(algorithm=["pso"]))
    assert frame.attrs["bold"] == frozenset()


def test_one_run_has_no_deviation(comparison):
    frame = tables.comparison_table(comparison.isel(run=[1]))
    assert frame["std"].isna().all()
    assert row(frame, "scenario-1", "ga")["min"] == 300


def test_infinite_and_missing_runs(comparison):
    comparison["fitness"][0, 0, :2] = np.inf
    comparison["fitness"][0, 1, 2:] = np.nan  # there are only two runs of ga: 600 and 300
    frame = tables.comparison_table(comparison)
    pso, ga = row(frame, "scenario-1", "pso"), row(frame, "scenario-1", "ga")
    assert (pso["min"], pso["max"], pso["average"]) == (1200, np.inf, np.inf)
    assert np.isnan(pso["std"])
    assert pso["length"] == 24  # run 2 is now the best: 1200/50
    assert (ga["runs"], ga["clear"], ga["average"]) == (2, 2, 450)
    assert ga["runtime"] == pytest.approx(1.6 / 6)


def test_ratio_table_puts_ours_below_the_papers(comparison):
    frame = tables.ratio_table(comparison)
    assert frame["source"].tolist() == ["paper", "ours"] * 2
    assert frame.loc[0, "length"] == pytest.approx(6.0464 / 7.0727)
    assert frame.loc[1, ["min", "max", "average", "std", "length"]].tolist() == [0.5] * 5
    assert frame.loc[3, "runtime"] == pytest.approx(16.0 / 0.08)


def test_ratio_table_marks_the_impossible_std(comparison):
    frame = tables.ratio_table(comparison)
    impossible = frame.attrs["footnotes"][0]
    assert impossible.cells == {(2, "std")}  # scenario-5, paper
    text = to_markdown(frame)
    assert "| 0.2604ᵃᶜ |" in text
    assert "ᵃ No 20 values" in text


def test_ratio_table_of_other_scenarios_and_algorithms(comparison):
    strange = comparison.assign_coords(scenario=["mine", "scenario-5"])
    frame = tables.ratio_table(strange.sel(algorithm=["pso", "sdbo"]))
    assert frame.loc[0, "min":].isna().all()
    assert frame.loc[frame["source"] == "ours", "min":].isna().all(axis=None)
    assert frame.loc[2, "height"] == pytest.approx(16.9658 / 77.1199)


@pytest.mark.parametrize("per_run", [False, True])
def test_stability_table_lists_who_has_the_move(comparison, per_run):
    if per_run:
        one_per_run = comparison[["stability_acted", "stability_kept"]].expand_dims(run=4, axis=-1)
        comparison = comparison.drop_vars(one_per_run.data_vars).merge(one_per_run)
    frame = tables.stability_table(comparison)
    assert frame["algorithm"].tolist() == ["sdbo", "sdbo"]
    assert frame["acted"].tolist() == pytest.approx([0.4, 0.25])
    assert frame["kept"].tolist() == pytest.approx([0.04, 0.025])


def test_the_comparison_fits_a_terminal_of_80_columns(comparison):
    comparison["evaluations"][:] = 45_090
    comparison["fitness"][0] += 16_000
    text = printed(tables.comparison_table(comparison))
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text
    assert "10 obstacles" in text
    assert "share of its batch" in " ".join(text.split())


def test_one_obstacle_is_one(comparison):
    comparison["obstacles"][0] = 1
    text = printed(tables.comparison_table(comparison))
    assert "1 obstacle " in text
    assert "10 obstacles" in text


def test_rich_prints_the_best_in_bold(comparison):
    table = to_rich(tables.comparison_table(comparison), title="mine", caption="[why]")
    assert table.title == "mine"
    assert table.caption == r"\[why]"
    by_name = {
        column.header.replace("-\n", "").replace("\n", " "): list(column.cells)
        for column in table.columns
    }
    assert by_name["algorithm"][:2] == ["scenario-1\n6 obstacles", "pso"]
    assert by_name["min"][1:5] == ["400.0", "300.0", "200.0", "[bold]100.0[/bold]"]
    assert by_name["clear"][3:5] == ["0/4", "[bold]3/4[/bold]"]


def test_markdown_is_a_table_with_its_caption(comparison):
    lines = to_markdown(tables.comparison_table(comparison)).splitlines()
    assert lines[0].startswith("| scenario | obstacles | algorithm | min | max ")
    assert lines[1].startswith("| :--- | ---: | :--- | ---: ")
    assert lines[5].startswith("| scenario-1 | 6 | sdbo | **100.0** | **600.0** | **300.0** |")
    assert len({line.count("|") for line in lines[:10]}) == 1
    assert "share" in lines[-1]


def test_csv_holds_every_digit(comparison, tmp_path):
    frame = tables.comparison_table(comparison)
    to_csv(frame, tmp_path / "table.csv")
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "table.csv"), frame, check_exact=True)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("number", "text"),
    [
        *((0.0415731, "0.04157"), (68.0011, "68.00"), (999.96, "1000"), (11753.4, "11753")),
        *((0.0, "0"), (1.5e-5, "1.500e-05"), (2.3e8, "2.300e+08"), (-3.14159, "-3.142")),
        *((np.inf, "∞"), (-np.inf, "−∞"), (np.nan, "–")),
    ],
)
def test_significant(number, text):
    assert significant(number) == text


@pytest.mark.fast
@pytest.mark.parametrize(
    ("seconds", "text"),
    [(75.0, "75.0 s"), (0.0123, "12.3 ms"), (4.2e-6, "4.20 µs"), (3600.0, "3600 s"), (0.0, "0 µs")],
)
def test_duration(seconds, text):
    assert duration(seconds) == text


@pytest.mark.fast
def test_shares_and_probabilities():
    assert percent(0.3817) == "38.2 %"
    assert percent(np.nan) == "–"
    assert probability(0.0004) == "< 0.001"
    assert probability(0.05) == "0.050"
    assert probability(np.nan) == "–"


def test_own_units_that_are_not_m_and_kg_are_told(comparison):
    assert "own units" not in tables.comparison_table(comparison).attrs["caption"]
    small = comparison.copy(deep=True)
    small["unit_length"][0], small["unit_mass"][0] = 0.05, 0.002
    caption = tables.comparison_table(small).attrs["caption"]
    name = str(small["scenario"].values[0])
    assert f"own units, here of {name} 0.05 m and 0.002 kg." in caption


def test_ratios_to_another_algorithm_have_an_effect_size(comparison):
    frame = tables.ratio_table(comparison, "pso")
    assert frame.attrs["title"] == "SDBO / PSO, the paper and ours"
    assert frame.loc[0, "length"] == pytest.approx(6.0464 / 6.8343)
    # 100 200 300 600 against 400 800 1200 2400: of 16 pairs sdbo loses one
    assert frame.loc[1, "a12"] == pytest.approx(15 / 16)
    assert np.isnan(frame.loc[0, "a12"])  # the paper prints no runs
    collides = frame.attrs["footnotes"][1]
    assert "PSO's minimum" not in collides.text  # it never exceeds κ


def test_the_printed_table_carries_what_does_not_add_up():
    frame = tables.printed_table(["scenario-1", "scenario-5", "mine"])
    assert len(frame) == 8
    first, second = frame.attrs["footnotes"]
    assert first.cells == {(7, "std")}  # sdbo in scenario 5
    assert second.cells == {(2, "min")}  # dbo in scenario 1
    assert "| 18.17 |" in to_markdown(frame)
