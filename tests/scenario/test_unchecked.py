"""Scenarios whose start or goal is inadmissible: read on request, for maps alone."""

import pickle

import pytest
from statements import MINIMAL, TOWER, changed

import jaxsusp as js
from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.scenario import Scenario, load_scenario

BLOCKED = changed("start = [0, 2, 1]", "start = [2, -1, 1]", MINIMAL) + TOWER


@pytest.fixture(scope="module")
def blocked() -> Scenario:
    return Scenario.from_toml(BLOCKED, "my.toml", task_checked=False)


def lines(text: str) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(text, "my.toml")
    return [line.removeprefix("my.toml: ") for line in caught.value.problems]


def test_its_troubles_are_what_it_would_have_been_refused_with(blocked):
    assert list(blocked.troubles) == lines(BLOCKED)
    assert blocked.troubles[0].startswith("task.start = [2.0, -1.0, 1.0] puts the load into the wa")
    assert Scenario.from_toml(MINIMAL, task_checked=False).troubles == ()


def test_everything_else_is_refused_all_the_same():
    far = changed("end = [0, 6, 7]", "end = [0, 60, 7]", BLOCKED)
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(far, task_checked=False)
    (line,) = caught.value.problems
    assert "robots[0].end" in line
    assert len(lines(far)) == 2


def test_what_plans_refuses_it_in_the_same_words(blocked, tmp_path):
    for use in (
        load_scenario, js.plan, js.Problem.from_scenario, js.joint_problem, js.passage, js.why_not,
        lambda scenario: js.compare([scenario], ["pso"]),
    ):  # fmt: skip
        with pytest.raises(ScenarioError) as caught:
            use(blocked)
        assert caught.value.problems == blocked.troubles
    file = tmp_path / "my.toml"
    file.write_text(BLOCKED)
    with pytest.raises(ScenarioError, match="puts the load into the warning area"):
        js.plan(file)
    assert load_scenario(file, task_checked=False).troubles == blocked.troubles


def test_copies_know_what_they_are_copies_of(blocked):
    assert blocked.own.troubles == blocked.troubles
    assert pickle.loads(pickle.dumps(blocked)).troubles == blocked.troubles
    task = blocked.task.model_copy(update={"start": (0.0, 2.0, 1.0)})
    assert blocked.model_copy(update={"task": task}).troubles == ()
