"""The best known trajectories are what they are said to be, and nothing worse is kept."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

import jaxsusp as js

FILE = Path(__file__).parents[1] / "experiments" / "best_known.py"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("best_known", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", js.scenarios())
def test_the_value_is_that_of_the_waypoints(script, name):
    known = json.loads((script.FOLDER / f"{name}.json").read_text())
    assert known["scenario"] == name
    assert script.judge(name, np.array(known["waypoints_m"])) == pytest.approx(
        known["fitness"], rel=1e-9
    )


def test_nothing_worse_is_kept(script, tmp_path, monkeypatch, capsys):
    known = json.loads((script.FOLDER / "scenario-2.json").read_text())
    good, monkeypatch = np.array(known["waypoints_m"]), monkeypatch
    monkeypatch.setattr(script, "FOLDER", tmp_path / "best")
    script.keep("scenario-2", good[None] + 0.01, "first")
    script.keep("scenario-2", good[None], "second")
    script.keep("scenario-2", good[None] + 0.01, "third")
    found = json.loads((tmp_path / "best" / "scenario-2.json").read_text())
    assert found["found"] == "second"
    assert capsys.readouterr().out.count("no better") == 1
