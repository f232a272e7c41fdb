"""Files of earlier versions, kept as they were written, still load and still mean the same."""

from pathlib import Path

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.report.comparison.folder import build_tables
from jaxsusp.scenario.world import build_world, obstacle_counts

terms = jax.jit(js.Problem.terms)
FILES = Path(__file__).with_name("files")


@pytest.mark.parametrize(("name", "ends"), [("scenario-1", (3, 3)), ("base-driven", (30, 3, 3))])
def test_a_plan_loads_and_is_still_verified(name, ends):
    plan = js.load_plan(FILES / f"{name}-0.1.0.plan.json")
    assert plan.feasible
    assert plan.ends.shape == ends
    assert plan.scenario.name == name
    again = js.verify_plan(plan, simulation=False)
    assert again.reasons == ()
    named = [each.name for each in again.plan.report if "ground" not in each.name]
    assert named == [each.name for each in plan.report]  # the ground was no body then


def test_a_comparison_loads_and_its_fitness_is_what_it_was():
    ds = js.load_results(FILES / "compare-0.1.0.nc")
    assert ds.sizes["run"] == 2
    assert "comparison" in build_tables(ds)
    assert ds["best_known"].isnull().all()  # two waypoints, of which nothing is known
    assert ((ds["evaluations"] - ds["evaluations_initial"]) % ds.sizes["iteration"] == 0).all()
    scenarios = {str(name): js.load_scenario(str(name)) for name in ds["scenario"].values}
    counts = obstacle_counts(list(scenarios.values()))
    for name, scenario in scenarios.items():
        world = build_world(scenario, counts)
        problem = js.Problem.from_scenario(scenario, 2, 12, "box", world=world)
        for algorithm in ds["algorithm"].values:
            cell = ds.sel(scenario=name, algorithm=algorithm, run=1)
            found = terms(problem, cell["x"].values)
            np.testing.assert_allclose(found.total, cell["fitness"], rtol=1e-9)
            assert int(found.collisions) == cell["collisions"]


@pytest.mark.fast
def test_a_free_space_loads_and_is_still_free():
    space = js.load_free_space(FILES / "scenario-1-0.1.0.free-space.nc")
    assert space.connected
    assert space.contains(space.polyline).all()
    assert space.bound <= space.length * (1 + 1e-8)
