"""The printed Table 1: its quoted ratios follow from it, its impossible number does not pass."""

import numpy as np
import pytest

from jaxsusp.report.comparison import paper


@pytest.fixture(scope="module")
def table():
    return paper.table1()


def test_table1_is_the_printed_one(table):
    assert dict(table.sizes) == {"scenario": 6, "algorithm": 4}
    assert table["algorithm"].values.tolist() == ["pso", "ga", "dbo", "sdbo"]
    assert table["scenario"].values.tolist() == [f"scenario-{i}" for i in range(1, 7)]
    assert table["obstacles"].values.tolist() == [6, 6, 8, 8, 10, 10]
    assert table["min"].sel(scenario="scenario-2", algorithm="pso") == 468.9918
    assert table["runtime"].sel(scenario="scenario-6", algorithm="dbo") == 68.30
    assert table["height"].attrs["units"] == "m"


@pytest.mark.parametrize(
    ("metric", "reduction"),
    [("length", 14.51), ("height", 79.88), ("min", 95.84), ("average", 94.77)],
)
def test_the_quoted_reductions_follow_from_the_table(table, metric, reduction):
    ratio = paper.ratios(table)[metric].sel(scenario="scenario-1").item()
    assert round(100 * (1 - ratio), 2) == reduction


@pytest.mark.fast
def test_the_largest_std_is_attained_by_two_points():
    values = np.repeat([1.0, 5.0], [15, 5])
    bound = paper.largest_std(1.0, 5.0, values.mean(), runs=20)
    assert bound == pytest.approx(values.std(ddof=1), rel=1e-14)


@pytest.mark.fast
@pytest.mark.parametrize("seed", range(5))
def test_no_sample_exceeds_the_largest_std(seed):
    values = np.random.default_rng(seed).pareto(0.7, 20)
    bound = paper.largest_std(values.min(), values.max(), values.mean(), runs=20)
    assert values.std(ddof=1) <= bound


@pytest.mark.fast
def test_equal_values_have_no_spread():
    assert paper.largest_std(3.0, 3.0, 3.0) == 0


def test_exactly_one_printed_std_is_impossible(table):
    flags = paper.impossible_std(table)
    assert flags.sum() == 1
    assert flags.sel(scenario="scenario-5", algorithm="sdbo")
    row = table.sel(scenario="scenario-5", algorithm="sdbo")
    assert paper.largest_std(row["min"], row["max"], row["average"]).item() == pytest.approx(
        717.9, abs=0.05
    )


def test_the_best_run_of_dbo_collides_in_four_scenarios(table):
    flags = paper.colliding_best(table)
    assert flags.sum() == 4
    assert flags.sel(algorithm="dbo").values.tolist() == [True, True, False, True, False, True]


def test_sdbo_is_not_superior_in_all_metrics(table):
    lost = {
        metric: [int(s[-1]) for s in flags["scenario"].values[flags]]
        for metric, flags in paper.beaten(table).items()
    }
    assert lost == {
        "min": [],
        "max": [3],
        "average": [3],
        "std": [3, 5],
        "length": [4, 6],
        "height": [],
        "curvature_radius": [5],
        "runtime": [],
    }


def test_remarks_carry_the_numbers_and_the_cells(table):
    impossible, collides, superior, fastest = paper.remarks(table)
    assert "799.8" in impossible.text
    assert "717.9" in impossible.text
    assert impossible.cells == (("scenario-5", "std"),)
    assert ("scenario-1", "min") in collides.cells
    assert ("scenario-3", "min") not in collides.cells
    assert "std (3, 5); length (4, 6)" in superior.text
    assert ("scenario-6", "length") in superior.cells
    assert "run time" in fastest.text


def test_remarks_are_found_and_not_fixed(table):
    sound = table.assign(
        std=table["std"].clip(max=100), min=table["min"].clip(max=900), runtime=-table["runtime"]
    )
    (superior,) = paper.remarks(sound)
    assert "Superior" in superior.text
