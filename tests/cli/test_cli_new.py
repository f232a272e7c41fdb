"""`jaxsusp new`: files that explain themselves, load, and say what they were made from."""

import re
import tomllib

import pytest

import jaxsusp as js
from jaxsusp.scenario.commented import commented
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import frame_of

BUILT_IN = [*js.scenarios(), *js.examples()]


def test_what_is_written_loads_and_can_be_carried_out(run, tmp_path):
    file = tmp_path / "my.toml"
    status, out, _ = run("new", file)
    assert status == 0
    assert f"jaxsusp check {file}" in out
    scenario = js.load_scenario(file)
    assert scenario.name == "my"
    assert len(scenario.robots) == 3
    assert {each.kind for each in scenario.obstacles} == {"box", "cylinder", "sphere"}
    found = js.plan(scenario, "taut", simulate=False)
    assert found.feasible, found.reasons


def test_robots_stand_on_a_ring(run, tmp_path):
    file = tmp_path / "five.toml"
    assert run("new", file, "--robots", 5)[0] == 0
    feet = [robot.base for robot in js.load_scenario(file).robots]
    assert len(feet) == 5
    assert all(x**2 + y**2 == pytest.approx(25, rel=1e-4) for x, y, _ in feet)


def test_size_and_mass_make_the_same_task(run, tmp_path):
    """In own units it is the very task that it was made from, to their grid."""
    file, first = tmp_path / "bench.toml", js.load_scenario("scenario-3")
    assert run("new", file, "--from", "scenario-3", "--size", 0.1, "--mass", 2)[0] == 0
    small = js.load_scenario(file)
    assert frame_of(small).length == pytest.approx(0.1)
    assert small.payload.mass == 2
    assert small.limits.tension == pytest.approx((0.2, 20.0))
    assert small.task.duration == pytest.approx(40 * 0.1**0.5)
    own = small.own.model_dump()
    for key, value in first.model_dump().items():
        if key not in ("name", "task"):
            assert _rounded(own[key]) == _rounded(value), key
    said = file.read_text()
    assert '# From "scenario-3". Lengths are multiplied by 0.1, masses by 0.2.' in said


def _rounded(value):
    """Numbers as own units have them."""
    match value:
        case float():
            return round(value, 7)
        case dict():
            return {key: _rounded(each) for key, each in value.items()}
        case list() | tuple():
            return [*map(_rounded, value)]
    return value


@pytest.mark.parametrize("name", BUILT_IN)
def test_every_built_in_scenario_is_written_and_read_back(name):
    scenario = js.load_scenario(name)
    assert js.Scenario.from_toml(commented(scenario, "A test."), "x.toml") == scenario


@pytest.mark.fast
def test_every_key_is_there_and_its_remark_tells_the_default_that_holds():
    """Taking away every "#" of a key states the defaults, and changes nothing."""
    scenario = js.load_scenario("scenario-1")
    text = commented(scenario, "A test.")
    bare = Statement.model_validate(tomllib.loads(text)).model_dump()
    stated = re.sub(r"^# (?=\w+ = |\[)", "", text.split("# [[obstacles]]")[0], flags=re.MULTILINE)
    document = tomllib.loads(stated)
    for without in ("joint_limits_deg", "speed", "acceleration", "jerk", "cable_speed",
                    "joint_speed_deg"):  # fmt: skip
        assert document["limits"].pop(without)  # an example: there is no limit
    assert document.pop("ground") == {"height": 0.0}
    keys = {table: value.keys() for table, value in document.items() if isinstance(value, dict)}
    fields = Statement.model_fields
    for table in ("payload", "workspace", "task", "fitness"):
        assert keys[table] == fields[table].annotation.model_fields.keys()
    for example in ("size", "file", "scale", "yaw_deg"):  # of loads that are no cylinder
        assert example in document["payload"]
        del document["payload"][example]
    assert Statement.model_validate(document).model_dump() == bare
    for kind in ("box", "cylinder", "sphere", "mesh"):
        assert f'kind = "{kind}"' in text
    assert max(map(len, text.splitlines())) <= 100


def test_a_file_that_is_there_is_kept_unless_forced(run, tmp_path):
    file = tmp_path / "my.toml"
    file.write_text("mine")
    status, out, err = run("new", file)
    assert (status, out) == (2, "")
    assert "is there already; give another name, or --force to replace it" in err
    assert file.read_text() == "mine"
    assert run("new", file, "--force")[0] == 0
    assert js.load_scenario(file).name == "my"
    assert [*tmp_path.iterdir()] == [file]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["my.txt"], "give a file name that ends in .toml"),
        (["my.toml", "--robots", 2], "robots = 2: give a whole number from 3 to 12"),
        (["my.toml", "--size", 0], "size = 0: give a factor from 0.001 to 1000"),
        (["my.toml", "--mass", -1], "mass = -1: give a mass from 1e-6 to 1e9 kg"),
        (["my.toml", "--from", "scenario-9"], "neither a file nor a built-in scenario"),
        (["my.toml", "--from", "hybrid", "--robots", 3], "give one of the two"),
    ],
)
def test_bad_input_is_status_two(run, tmp_path, monkeypatch, arguments, message):
    monkeypatch.chdir(tmp_path)
    status, out, err = run("new", *arguments)
    assert (status, out) == (2, "")
    assert message in err
    assert not [*tmp_path.iterdir()]
