"""Many scenarios in one call: what is planned one by one, failures in their place, nothing lost."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.planning.many import scenes
from jaxsusp.planning.many.kept import LIST
from jaxsusp.planning.plan import ARRAYS
from jaxsusp.report.plan.several import plans_table

TAUT = {"algorithm": "taut", "simulate": False}
"""No search and no simulation: a plan in a second."""

BROKEN = """
[payload]
mass = -3
"""


@pytest.fixture(scope="module")
def alone() -> dict[str, js.Plan]:
    """Planned one by one."""
    return {name: js.plan(name, **TAUT) for name in ("scenario-1", "scenario-3")}


@pytest.fixture
def answered(monkeypatch, alone):
    """The planner answers at once; the names it was asked for."""
    asked = []

    def found(scenario, **settings):
        del settings
        asked.append(scenario.name)
        if scenario.name not in alone:
            raise ZeroDivisionError("a fault of ours")
        return alone[scenario.name]

    monkeypatch.setattr(scenes, "plan", found)
    monkeypatch.setattr(scenes, "_settings", lambda given: {"algorithm": "taut", **given})
    return asked


def assert_same(found: js.Plan, alone: js.Plan) -> None:
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(found, name), getattr(alone, name), err_msg=name)
    assert found.report == alone.report
    assert (found.feasible, found.reasons) == (alone.feasible, alone.reasons)
    assert found.certificate == alone.certificate
    assert dict(found.settings) == dict(alone.settings)


def test_they_are_the_plans_of_one_by_one_and_are_kept(alone, tmp_path):
    steps = []
    found = js.plan_many([*alone], output=tmp_path, progress=steps.append, **TAUT)
    for each in found:
        assert each.feasible
        assert_same(each.plan, alone[each.name])
        assert_same(js.load_plan(tmp_path / f"{each.name}.plan.json"), alone[each.name])
    assert [(step.phase, step.name, step.done) for step in steps] == [
        ("planning", "scenario-1", 0), ("finished", "scenario-1", 1),
        ("planning", "scenario-3", 1), ("finished", "scenario-3", 2),
    ]  # fmt: skip


def test_a_scenario_that_fails_is_told_in_its_place(answered, alone, tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text(BROKEN, encoding="utf-8")
    found = js.plan_many(["scenario-1", broken, "scenario-2", "scenario-3"])
    assert [each.name for each in found] == ["scenario-1", "broken", "scenario-2", "scenario-3"]
    assert [each.feasible for each in found] == [True, False, False, True]
    assert found[1].failure.startswith(f"{broken}: ")
    assert found[2].failure == "failed with ZeroDivisionError: a fault of ours"
    assert answered == ["scenario-1", "scenario-2", "scenario-3"]
    frame = plans_table(found)
    assert frame["plan"].tolist() == ["feasible", "none", "none", "feasible"]
    assert frame.attrs["caption"] == (
        "2 of 4 feasible. Not played: 2; whether a swinging load follows, `jaxsusp verify` tells."
    )
    assert frame["length"][0] == pytest.approx(alone["scenario-1"].law.path.length)


def test_an_interrupt_keeps_what_is_finished_and_resume_goes_on(
    answered, alone, tmp_path, monkeypatch
):
    def interrupted(step):
        if step.phase == "finished":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        js.plan_many([*alone], output=tmp_path, progress=interrupted)
    assert sorted(path.name for path in tmp_path.iterdir()) == [LIST, "scenario-1.plan.json"]
    steps = []
    found = js.plan_many([*alone], output=tmp_path, resume=True, progress=steps.append)
    assert answered == ["scenario-1", "scenario-3"]
    assert [step.phase for step in steps] == ["there already", "planning", "finished"]
    for each in found:
        assert_same(each.plan, alone[each.name])
    monkeypatch.setattr(scenes, "_settings", lambda given: {"algorithm": "pso", **given})
    with pytest.raises(js.InputError, match=r"made with algorithm = 'taut', not 'pso'; resume w"):
        js.plan_many([*alone], output=tmp_path, resume=True)
    (tmp_path / LIST).write_text("[", encoding="utf-8")
    with pytest.raises(js.InputError, match="is no list of plans; remove it"):
        js.plan_many([*alone], output=tmp_path, resume=True)


def test_a_scenario_that_has_changed_is_planned_again(answered, alone, tmp_path, scenarios):
    js.plan_many(["scenario-1"], output=tmp_path)
    heavier = scenarios[0].payload.model_copy(update={"mass": 3.0})
    js.plan_many(
        [scenarios[0].model_copy(update={"payload": heavier})], output=tmp_path, resume=True
    )
    assert answered == ["scenario-1", "scenario-1"]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("scenarios", "settings", "told"),
    [
        ([], {}, "scenarios: none given"),
        (["scenario-1"], {"runs": 0}, "runs = 0: give a whole number of at least 1"),
        (["scenario-1"], {"durations": 3}, "durations: is no setting of a plan; there are algo"),
        (["scenario-1"], {"resume": True}, "resume = True: give the output folder"),
        (["scenario-1"], {"workers": 0}, "workers = 0: give a whole number of at least 1"),
        (["scenario-1", "scenario-1"], {}, "scenario-1 would both be scenario-1.plan.json"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_planned(scenarios, settings, told):
    with pytest.raises(js.InputError) as refused:
        js.plan_many(scenarios, **settings)
    assert told in str(refused.value)
