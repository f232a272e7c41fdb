"""What the ledger's verdicts rest on, against answers known without it."""

import itertools

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import jaxsusp as js
from experiments.claims import ends, motion, tables
from experiments.claims.claim import VERDICTS, Claim, Evidence, change, leads, within
from jaxsusp.report.comparison import paper
from jaxsusp.scenario.models import Box, Cylinder


@given(st.lists(st.floats(0, 1), min_size=2, max_size=12))
def test_no_values_scatter_more_than_the_greatest_standard_deviation(inner):
    values = np.array([0.0, 1.0, *inner])
    most = tables.greatest_std(0.0, 1.0, values.mean(), len(values))
    assert values.std(ddof=1) <= most + 1e-12
    bound = paper.largest_std(0.0, 1.0, values.mean(), len(values))
    assert most <= bound + 1e-12


def test_the_greatest_standard_deviation_is_attained():
    """Of four values on a fine grid with mean 0.3, the one of brute force."""
    grid = np.linspace(0, 1, 11)
    sets = [v for v in itertools.product(grid, repeat=4) if abs(np.mean(v) - 0.3) < 1e-9]
    best = max(np.std(v, ddof=1) for v in sets if min(v) == 0 and max(v) == 1)
    assert tables.greatest_std(0.0, 1.0, 0.3, 4) == pytest.approx(best)


def test_the_printed_deviation_of_scenario_5_cannot_be():
    row = paper.table1().sel(scenario="scenario-5", algorithm="sdbo")
    low, high, mean = (float(row[name]) for name in ("min", "max", "average"))
    assert float(row["std"]) > 799 > 692 > tables.greatest_std(low, high, mean) > 691


def test_tensions_at_printed_ends_balance_the_weight():
    """And some of them would have to push, at SDBO's ends as at all others."""
    rows = paper.tables_2_3()
    for name, group in rows.groupby("algorithm"):
        held = group.sort_values("robot")[["x", "y", "z"]].to_numpy()
        for place in (ends.rig().task.start, ends.rig().task.goal):
            pull = ends.pulled(held, place)
            rays = held - ends.hook_at(place)
            units = rays / np.linalg.norm(rays, axis=1)[:, None]
            assert pull @ units == pytest.approx([0, 0, 98.1], abs=1e-9)
            assert pull.min() < 0, name


def test_tensions_are_those_of_the_package_where_the_ends_are_the_scenarios():
    scenario = ends.rig()
    held = np.array([robot.end for robot in scenario.robots])
    for place in (scenario.task.start, scenario.task.goal):
        assert ends.pulled(held, place) == pytest.approx(np.array(js.tensions(scenario, place)))


def test_a_way_across_an_obstacle_is_told_from_one_around_it():
    box = Box(name="b", center=(0, 0, 1), size=(2.0, 1.0, 2.0), yaw_deg=90.0)
    pillar = Cylinder(name="p", center=(0, 0, 1), radius=0.5, height=2.0)
    line = np.linspace([-3, 0.8, 2], [3, 0.8, 2], 601)
    assert motion._above(box, line, 0.0)  # turned, it reaches to y = 1
    assert not motion._above(pillar, line, 0.0)
    assert motion._above(pillar, line, 0.31)


def test_every_pair_of_sources_has_a_verdict_of_its_own():
    answers = [
        Claim("", "", "", printed, "", ours).verdict
        for printed, ours in itertools.product((True, False, None), repeat=2)
    ]
    assert sorted(answers) == sorted(VERDICTS)


def test_words():
    assert within([]) == "in no scenario"
    assert within(["scenario-2"]) == "in scenario 2"
    assert within(["scenario-1", "scenario-6"]) == "in scenarios 1, 6"
    assert change(0.8549, 2) == "−14.51 %"


def test_the_evidence_holds_the_published_four_with_one_row_each():
    from experiments.artefacts import Artefacts

    evidence = Evidence.of(Artefacts())
    assert evidence.ours["runtime"].dims == evidence.table1["runtime"].dims
    assert evidence.runs["algorithm"].values.tolist() == ["pso", "ga", "dbo", "sdbo"]


@pytest.mark.parametrize("others", [1.0, np.nan, np.inf])
@pytest.mark.parametrize("own", [1.0, np.nan, np.inf])
def test_nobody_leads_by_a_tie_or_by_no_number(own, others):
    values = xr.DataArray(
        [[own, others, 3.0], [2.0, 3.0, 4.0]],
        {"scenario": ["a", "b"], "algorithm": ["sdbo", "dbo", "pso"]},
    )
    found = leads(xr.Dataset(dict.fromkeys(paper.UNITS, values)))
    costs = [name for name in paper.UNITS if name != "curvature_radius"]
    assert all(found[name].values.tolist() == [own == 1 and others != 1, True] for name in costs)
    assert not found["curvature_radius"].any()
