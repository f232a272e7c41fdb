"""The best known trajectories are what they are said to be, and nothing worse is kept."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.comparison import bestknown

SCRIPT = Path(__file__).parents[1] / "experiments" / "best_known.py"
RECORDS = {record["scenario"]: record for record in bestknown.records()}


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("best_known", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", js.scenarios())
def test_the_value_is_that_of_the_waypoints(script, name):
    known, scenario = RECORDS[name], js.load_scenario(name)
    assert known["digest"] == scenario.digest
    x = np.array(known["waypoints_m"])
    assert len(x) == 3 * known["waypoints"]
    assert script.judge(scenario, x, known["samples"]) == pytest.approx(known["fitness"], rel=1e-9)


@pytest.mark.fast
def test_no_task_has_two_records():
    rows = bestknown.records()
    assert len({(row["digest"], row["waypoints"], row["samples"]) for row in rows}) == len(rows)


@pytest.mark.fast
def test_a_value_holds_for_its_task_and_for_no_other():
    scenario = js.load_scenario("scenario-2")
    value = RECORDS["scenario-2"]["fitness"]
    assert js.best_known(scenario) == js.best_known("scenario-2", 5, 40) == value
    assert js.best_known(scenario, 4) is None
    assert js.best_known(scenario, samples=41) is None
    weights = scenario.fitness.model_copy(update={"weights": (2.0, 1.0, 1.0, 1.0, 1.0, 1.0)})
    assert js.best_known(scenario.model_copy(update={"fitness": weights})) is None


def test_nothing_worse_is_kept(script, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(script, "FILE", tmp_path / "best.json")
    scenario = js.load_scenario("scenario-2")
    good = np.array(RECORDS["scenario-2"]["waypoints_m"])
    script.keep(scenario, good[None] + 0.01, "first", 40)
    script.keep(scenario, good[None], "second", 40)
    script.keep(scenario, good[None] + 0.01, "third", 40)
    (found,) = bestknown.records(script.FILE)
    assert found["found"] == "second"
    assert capsys.readouterr().out.count("no better") == 1
    other = scenario.model_copy(update={"name": "scenario-10"})
    script.keep(other, good[None] + 0.01, "fourth", 40)
    names = [record["scenario"] for record in bestknown.records(script.FILE)]
    assert names == ["scenario-2", "scenario-10"]
