"""`jaxsusp freespace` as a person or a script meets it."""

import json

import cvxpy as cp
import numpy as np
import pytest
from cvxpy.reductions.solvers.defines import SOLVER_MAP_CONIC

import jaxsusp as js
from jaxsusp.freespace.choices import SOLVERS, solvers
from jaxsusp.freespace.ellipsoid import require_solver
from jaxsusp.report import freespace as pictures
from jaxsusp.report.drawing import style


@pytest.fixture
def walled(tmp_path):
    """A scenario whose start and goal no route connects."""
    path = tmp_path / "walled.toml"
    text = js.load_scenario("scenario-1").model_dump()
    text |= {"name": "walled", "obstacles": []}
    text["workspace"]["upper"] = (3.5, 3.5, 2.7)
    text["task"]["goal"] = (0.0, -2.5, 1.0)
    wall = {"kind": "box", "center": (0.0, 0.0, 1.3), "size": (8.0, 0.2, 2.6)}
    path.write_text(js.Scenario.model_validate(text | {"obstacles": [wall]}).to_toml())
    return path


@pytest.fixture
def quick_pictures(monkeypatch):
    """Pictures that take no time."""
    for draw in ("slices", "view"):
        monkeypatch.setattr(pictures, draw, lambda *_: None)
    monkeypatch.setattr(style, "save", lambda figure, path: path.write_text("picture"))


def test_regions_route_and_files(run, tmp_path):
    status, out, err = run("freespace", "scenario-1", "--coverage", "0.4", "--output", tmp_path)
    assert status == 0
    assert "No polyline through this sequence of regions is shorter than" in out
    assert "the widest way is narrowest at task.start" in " ".join(out.split())
    assert f"4 files are in {tmp_path}" in err
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"free-space.nc", "regions.csv", "slices.png", "space.png"}
    assert js.load_free_space(tmp_path / "free-space.nc").connected


@pytest.mark.usefixtures("quick_pictures")
def test_json(run, tmp_path):
    status, out, _ = run(
        "freespace", "scenario-1", "--coverage", "0.4", "--output", tmp_path, "--json"
    )
    answer = json.loads(out)
    assert status == 0
    assert answer["connected"]
    np.testing.assert_allclose(answer["polyline"][0], [0, 2, 1])
    assert answer["bound"] <= answer["length"] * (1 + 1e-6)
    assert 0 < answer["passage"]["width"] < 0.5
    assert answer["refusal"] is None
    assert answer["regions"][0].keys() == {"region", "polytope", "ellipsoid", "faces", "neighbours"}


@pytest.mark.usefixtures("quick_pictures")
def test_as_many_ways_are_shown_as_asked_for_or_the_lack_is_told(run, tmp_path):
    command = ["freespace", "scenario-1", "--coverage", "0.4", "--output", tmp_path]
    usual = run(*command)[1]
    count = usual.count("\nway ")
    assert "were asked for" not in usual
    said = run(*command, "--routes", "1")[1]
    assert "way 1: " in said
    assert "way 2: " not in said
    said = run(*command, "--routes", "50")[1]
    known = said.count("\nway ")
    assert known >= count > 0
    ways = "way is" if known == 1 else "ways are"
    assert f"Only {known} distinct {ways} known; 50 were asked for." in said


@pytest.mark.usefixtures("quick_pictures")
def test_no_route_is_status_one(run, walled, tmp_path):
    status, out, _ = run("freespace", walled, "--limit", "8", "--output", tmp_path / "out")
    assert status == 1
    said = " ".join(out.split())
    assert "no collision-free route found" in said
    assert "at least 1 obstacle must go; without obstacles[0] there is a way" in said
    options = "--limit", "8", "--output", tmp_path / "out", "--json"
    status, out, _ = run("freespace", walled, *options)
    answer = json.loads(out)
    assert status == 1
    assert answer["passage"] is None
    assert answer["refusal"]["kind"] == "proved blocked"
    assert answer["refusal"]["remove"] == ["obstacles[0]"]


def test_a_plan_is_refused_with_the_same_words(run, walled, tmp_path):
    status, out, err = run("plan", walled, "--output", tmp_path / "out")
    assert (status, out) == (1, "")
    assert "walled: no plan is possible: every way from task.start (0, 2, 1)" in err
    assert "without obstacles[0] there is a way" in err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["scenario-9"], "scenario-9: is neither a file nor a built-in scenario"),
        (["scenario-1", "--coverage", "2"], "coverage = 2.0: give a share between 0 and 1"),
        (["scenario-1", "--solver", "gurobbi"], "solver = 'gurobbi' is not known"),
        (["scenario-1", "--solver", "HIGHS"], "'HIGHS' is not known; choose from CLARABEL"),
    ],
)
def test_bad_input_is_status_two(run, tmp_path, arguments, message):
    status, out, err = run("freespace", *arguments, "--output", tmp_path / "out")
    assert (status, out) == (2, "")
    assert message in err
    assert not (tmp_path / "out").exists()


@pytest.mark.fast
def test_the_solvers_to_choose_from_are_those_that_solve_cone_programs():
    """The list, which loads nothing, agrees with cvxpy, and what is installed works."""
    for name in SOLVERS:
        assert cp.SOC in SOLVER_MAP_CONIC[name].SUPPORTED_CONSTRAINTS, name
    assert set(solvers()) == set(SOLVERS) & set(cp.installed_solvers())
    for name in {"CLARABEL", *solvers()} - {"COPT", "GUROBI", "MOSEK", "CPLEX", "XPRESS"}:
        require_solver(name)  # the others may lack a licence
