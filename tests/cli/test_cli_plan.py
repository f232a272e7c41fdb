"""`jaxsusp plan` and `jaxsusp verify` as a person or a script meets them."""

import json

import numpy as np
import pytest
from plans import LOW

import jaxsusp as js
from jaxsusp.report.plan import film as pictures
from jaxsusp.report.plan import folder as planfolder


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW, settings={"seed": 0})


@pytest.fixture
def planned(monkeypatch, plan):
    """The planner answers at once."""
    answer = {"plan": plan}
    monkeypatch.setattr("jaxsusp.planning.planner.plan", lambda *_, **__: answer["plan"])
    return answer


@pytest.fixture
def file(plan, tmp_path):
    plan.save(tmp_path / "plan.json")
    return tmp_path / "plan.json"


@pytest.mark.usefixtures("planned")
def test_plan_prints_the_report_and_writes_everything(run, tmp_path, plan):
    status, said, told = run("plan", "scenario-1", "--output", tmp_path / "out")
    assert status == 0
    assert "load to obstacles" in said
    assert "+0.21" in said
    assert "feasible and certified" in said
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {
        "scenario-1.plan.json", "scenario-1.plan.csv", "scenario-1.plan.md",
        "scenario-1.kinematics.png", "scenario-1.scene.png", "scenario-1.cables.png",
    }  # fmt: skip
    assert "scenario-1.plan.json" in told
    loaded = js.load_plan(tmp_path / "out" / "scenario-1.plan.json")
    np.testing.assert_array_equal(loaded.tensions, plan.tensions)


def test_an_infeasible_plan_ends_with_status_one_and_its_reasons(
    run, planned, scenarios, tmp_path, monkeypatch
):
    monkeypatch.setattr(planfolder, "FIGURES", {})
    planned["plan"] = js.plan_through(scenarios[0], LOW * [1, 1, 0.4])
    status, said, _ = run("plan", "scenario-1", "--output", tmp_path)
    assert status == 1
    assert "infeasible" in said
    assert "hits low wall" in said
    status, said, _ = run("plan", "scenario-1", "--output", tmp_path, "--json")
    answer = json.loads(said)
    assert status == 1
    assert answer["feasible"] is False
    assert any("low wall" in reason for reason in answer["reasons"])


def test_verify_checks_and_simulates(run, file, tmp_path):
    model = tmp_path / "new" / "model.xml"
    status, said, told = run("verify", file, "--model", model)
    assert status == 0
    assert "tracking error" in said
    assert "feasible and certified" in said
    assert model.read_text().startswith("<mujoco")
    assert "model.xml" in told


def test_verify_says_where_it_cannot_render_and_verifies_all_the_same(
    run, file, tmp_path, monkeypatch
):
    def missing(*_):
        raise pictures._no_renderer(ImportError("no libEGL"))

    monkeypatch.setattr(pictures, "_open", missing)
    status, said, told = run("verify", file, "--images", tmp_path / "images", "--json")
    assert status == 0
    assert "no EGL renderer (no libEGL)" in told
    assert json.loads(said)["simulation"]["tracking_error_m"] < 0.01


def test_verify_renders_images(run, file, tmp_path):
    try:
        pictures._open(16, 16).free()
    except pictures.NoRendererError:
        pytest.skip("no EGL here")
    status, _, _ = run("verify", file, "--images", tmp_path / "images")
    assert status == 0
    images = sorted((tmp_path / "images").glob("*.png"))
    assert len(images) == 5
    assert images[0].read_bytes() != images[-1].read_bytes()


def test_bad_input_is_one_message_and_status_two(run, file, tmp_path):
    text = file.read_text()
    file.write_text(text[:1000])
    commands = (
        (("verify", file), "cut short"),
        (("verify", tmp_path / "none.json"), "no such file"),
        (("plan", "scenario-7"), 'did you mean "scenario-'),
        (("plan", "scenario-1", "--ends", "here"), "ends = 'here'"),
        (("plan", "scenario-1", "--runs", "0"), "runs = 0"),
    )
    for command, message in commands:
        status, said, told = run(*command)
        assert status == 2
        assert said == ""
        assert message in told
        assert "Traceback" not in told
