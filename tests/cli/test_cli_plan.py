"""`jaxsusp plan` and `jaxsusp verify` as a person or a script meets them."""

import json

import numpy as np
import pytest
from plans import LOW

import jaxsusp as js
from jaxsusp.planning.many.kept import Planned
from jaxsusp.planning.many.scenes import Step
from jaxsusp.planning.planner import Event
from jaxsusp.planning.ranking import with_settings
from jaxsusp.report.plan import film as pictures
from jaxsusp.report.plan import folder as planfolder
from jaxsusp.report.plan.words import how_good

FOUND = {
    "seed": 0, "algorithm": "routed", "attempts": 2, "fitness": 90.0, "way": "searched",
    "simulated": True,
}  # fmt: skip
"""What the planner says of a plan."""


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW, settings=FOUND)


@pytest.fixture
def planned(monkeypatch, plan):
    """The planner answers at once."""
    answer = {"plan": plan}

    def found(*_, progress, **__):
        for phase in ("searching", "checking", "checking", "simulating"):
            progress(Event(phase, 0, 4))
        return answer["plan"]

    monkeypatch.setattr("jaxsusp.planning.planner.plan", found)
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
    near = next(each for each in plan.report if each.name == "distance of load to obstacles")
    assert f"+{near.margin:.4f}"[:5] in said
    assert "feasible and certified" in said
    assert "\nDriven in 40 s.\nPlayed in simulation.\n" in said
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {
        "scenario-1.plan.json", "scenario-1.plan.csv", "scenario-1.plan.md",
        "scenario-1.kinematics.png", "scenario-1.scene.png", "scenario-1.cables.png",
    }  # fmt: skip
    assert told.splitlines()[:-1] == [
        f"scenario-1: {phase}, attempt 1 of at most 4"
        for phase in ("searching", "checking", "simulating")
    ]
    assert "scenario-1.plan.json" in told
    loaded = js.load_plan(tmp_path / "out" / "scenario-1.plan.json")
    np.testing.assert_array_equal(loaded.tensions, plan.tensions)


@pytest.mark.fast
@pytest.mark.parametrize("duration", ["fast", "-3", "nan"])
def test_what_is_no_duration_is_refused(run, duration):
    status, _, told = run("plan", "scenario-1", "--duration", duration)
    assert status == 2
    assert 'is no time; give seconds above 0, or "shortest"' in told


@pytest.mark.usefixtures("planned")
@pytest.mark.parametrize(("duration", "compared"), [("40", True), ("20", False)])
def test_the_best_known_is_that_of_the_task_s_own_duration(run, tmp_path, duration, compared):
    said = run("plan", "scenario-1", "--duration", duration, "--output", tmp_path)[1]
    assert ("best known" in said) == compared


def test_a_plan_is_told_with_its_fitness_and_how_it_was_found(plan):
    length = plan.law.path.length
    assert how_good(plan, 80.0) == (
        f"Fitness 90.00 (12.5 % above the best known), path {length:.2f} m, found by routed in 2 "
        "attempts."
    )
    taut = with_settings(plan, way="taut", attempts=1)
    assert how_good(taut, None) == (
        f"Fitness 90.00, path {length:.2f} m, the rounded taut way, than which routed found "
        "nothing better in 1 attempt."
    )
    assert "m, the rounded taut way in 1 attempt." in how_good(
        with_settings(taut, algorithm="taut"), None
    )


@pytest.mark.parametrize("given", ["tout", "foo"])
def test_the_taut_ways_are_among_the_algorithms_of_a_plan(run, given):
    _, _, told = run("plan", "scenario-1", "--algorithm", given)
    assert told.startswith(f"algorithm = '{given}' is not known; ")
    assert "sdbo-task, taut" in told
    with pytest.raises(js.InputError) as refused:
        js.plan("scenario-1", given)
    assert told == f"{refused.value}\n"


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


@pytest.mark.usefixtures("planned")
def test_several_are_a_file_each_and_one_table(run, tmp_path, monkeypatch, plan):
    told = []

    def many(scenarios, *, progress, **settings):
        told.append((scenarios, settings))
        found = (
            Planned("scenario-1", plan, "", 1.5, tmp_path / "scenario-1.plan.json"),
            Planned("other", None, "other.toml: payload.mass = -3; give more", 0.0),
        )
        for done, each in enumerate(found, 1):
            progress(Step("finished", each.name, done, 2, each))
        return found

    monkeypatch.setattr("jaxsusp.planning.many.scenes.plan_many", many)
    several = ("plan", "scenario-1", "scenario-2", "--runs", 3, "--output", tmp_path)
    status, said, noted = run(*several)
    assert status == 1
    assert "1 of 2 feasible" in said
    assert "Not played" not in said
    assert "other: other.toml: payload.mass = -3; give more" in said
    assert noted.splitlines()[:2] == [
        "1 of 2: scenario-1: feasible",
        "2 of 2: other: no plan: other.toml: payload.mass = -3; give more",
    ]
    (scenarios, settings), = told  # fmt: skip
    assert scenarios == ["scenario-1", "scenario-2"]
    assert settings["runs"] == 3
    assert settings["workers"].here
    assert (tmp_path / "plans.csv").read_text().startswith("scenario,plan,")
    run("plan", "scenario-1", "missing.toml", "--output", tmp_path)
    assert told.pop()[0] == ["scenario-1", "missing.toml"]  # told in its place, see plan_many
    status, said, _ = run(*several, "--json", "--workers", 2)
    records = json.loads(said)
    assert [each["feasible"] for each in records] == [True, False]
    assert records[1]["reasons"] == ["other.toml: payload.mass = -3; give more"]
    assert told[1][1]["workers"].workers == 2


def test_the_table_of_several_says_which_were_not_played(run, tmp_path, monkeypatch, plan):
    alone = with_settings(plan, simulated=False)
    found = (Planned("played", plan, "", 1.5), Planned("alone", alone, "", 1.5))
    monkeypatch.setattr("jaxsusp.planning.many.scenes.plan_many", lambda *_, **__: found)
    status, said, _ = run("plan", "scenario-1", "scenario-2", "--output", tmp_path)
    assert status == 0
    told = " ".join(said.split())
    assert "2 of 2 feasible. Not played: 1; whether a swinging load follows, `jaxsusp" in told
    rows = (tmp_path / "plans.csv").read_text().splitlines()
    assert [row.split(",")[2] for row in rows] == ["played", "yes", "no"]


def test_an_interrupt_among_several_tells_what_is_kept(run, tmp_path, monkeypatch, plan):
    def many(scenarios, *, progress, **_):
        progress(Step("finished", "scenario-1", 1, 2, Planned("scenario-1", plan, "", 1.5)))
        raise KeyboardInterrupt

    monkeypatch.setattr("jaxsusp.planning.many.scenes.plan_many", many)
    status, said, told = run("plan", "scenario-1", "scenario-2", "--output", tmp_path)
    assert status == 130
    assert "1 of 1 feasible" in said
    assert f"1 of 2 plans are kept in {tmp_path}. The same command with --resume" in told
