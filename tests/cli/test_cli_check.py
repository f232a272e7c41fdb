"""`jaxsusp check`: a scenario in words and one picture, before it is planned."""

import json

import pytest

import jaxsusp as js
from jaxsusp.planning.prospects.stated import keys_of, unfitting
from jaxsusp.report import examination as pictures
from jaxsusp.report.drawing import style
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.starter import resized, starter


@pytest.fixture
def quick_picture(monkeypatch):
    """A picture that takes no time."""
    monkeypatch.setattr(pictures, "sheet", lambda _: None)
    monkeypatch.setattr(style, "save", lambda figure, path: path.write_text("picture"))


@pytest.fixture
def blocked(tmp_path):
    """scenario-1 with the start in the low wall."""
    file = tmp_path / "blocked.toml"
    text = js.load_scenario("scenario-1").to_toml()
    file.write_text(text.replace("start = [0.0, 2.0, 1.0]", "start = [-0.46, 0.46, 0.81]"))
    return file


def test_a_good_task_in_words_and_a_picture(run, tmp_path):
    status, out, err = run("check", "scenario-1", "--output", tmp_path)
    said = " ".join(out.split())
    assert status == 0
    assert "3 robots" in said
    assert "obstacles: 4 boxes, 1 cylinder, 1 sphere" in said
    assert "Default: [limits] joint_limits_deg = none" in said
    assert "ground = at the lowest base." in said
    assert "Own units: 1 m" in said
    assert "1.00 … 5.00" in said
    assert "The widest way is narrowest at task.start (0, 2, 1)" in said
    assert "nothing is known that stands in the way of a plan; next: jaxsusp plan" in said
    assert (tmp_path / "check.png").read_bytes().startswith(b"\x89PNG")
    assert "check.png" in err


@pytest.mark.usefixtures("quick_picture")
def test_a_blocked_start_is_status_one_with_the_nearest_place(run, blocked, tmp_path):
    status, out, _ = run("check", blocked, "--output", tmp_path)
    said = " ".join(out.split())
    assert status == 1
    assert 'puts the load into the warning area of obstacles[0] "low wall"' in said
    assert "The nearest admissible place found is task.start = [" in said
    assert "cannot be carried out as it is stated" in said
    status, out, _ = run("check", blocked, "--output", tmp_path, "--json")
    answer = json.loads(out)
    assert (status, answer["possible"]) == (1, False)
    (place,) = answer["misplaced"]
    assert place["place"] == "task.start"
    assert answer["files"] == [str(tmp_path / "check.png")]


@pytest.mark.usefixtures("quick_picture")
def test_what_cables_cannot_hold_is_status_one(run, tmp_path):
    file = tmp_path / "heavy.toml"
    text = js.load_scenario("scenario-1").to_toml()
    file.write_text(text.replace("mass = 10.0", "mass = 40.0"))
    status, out, _ = run("check", file, "--output", tmp_path)
    assert status == 1
    assert "3 cables of at most 100 N lift 300 N, and the load weighs" in " ".join(out.split())


def test_a_plan_that_is_refused_for_its_start_names_the_command(run, blocked, tmp_path):
    status, out, err = run("plan", blocked, "--output", tmp_path / "out")
    assert (status, out) == (2, "")
    assert f"{blocked}: task.start = [-0.46, 0.46, 0.81] puts the load into" in err
    assert f"`jaxsusp check {blocked}` draws what blocks it" in err
    assert not (tmp_path / "out").exists()


def test_all_mistakes_of_a_file_are_told_at_once(run, tmp_path):
    file = tmp_path / "bad.toml"
    text = js.load_scenario("scenario-1").to_toml()
    file.write_text(text.replace("mass = 10.0", "mass = -1").replace("kappa", "kapa"))
    status, out, err = run("check", file, "--output", tmp_path / "out")
    assert (status, out) == (2, "")
    assert "payload.mass = -1 must be greater than 0" in err
    assert "kapa" in err
    assert not (tmp_path / "out").exists()


@pytest.mark.fast
def test_keys_are_given_or_default_as_the_file_has_it():
    keys = {each.path: each for each in keys_of(js.load_scenario("base-driven"))}
    assert keys["payload.mass"].given
    assert keys["drive"].value == '"base"'
    assert not keys["limits.tension"].given
    assert keys["limits.tension"].value == "[1.0, 100.0]"
    assert keys["robots[2].end"].given
    assert not keys["robots[2].link_radius"].given
    assert keys["obstacles[1].yaw_deg"].given


@pytest.mark.fast
def test_defaults_of_another_size_are_named():
    assert unfitting(starter("benchmark")) == ()
    small = resized(starter("small"), "small", 0.1, 0.001)
    assert unfitting(small) == ()  # all that has a unit is stated
    document = small.model_dump(exclude_unset=True, exclude_none=True)
    del document["limits"]["tension"], document["limits"]["clearance"]
    wrong = unfitting(Statement.model_validate(document))
    assert wrong == ("limits.tension", "limits.clearance")
    heavy = resized(starter("heavy"), "heavy", 1.0, 10.0).model_dump(exclude_none=True)
    del heavy["limits"]["tension"]
    assert unfitting(Statement.model_validate(heavy)) == ("limits.tension",)
