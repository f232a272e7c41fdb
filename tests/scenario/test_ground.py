"""The ground: a plane that load, cables and arms keep off, the same for search and proof."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.bodies import domain_of
from jaxsusp.scenario.ownunits import Frame, restated
from jaxsusp.scenario.world import build_world
from jaxsusp.verify.certificate import ROUNDING
from jaxsusp.verify.model import build_spec

pytestmark = pytest.mark.fast


def with_ground(scenario: js.Scenario, ground, bottom: float = 0.0) -> js.Scenario:
    """A scenario without obstacles whose workspace reaches down to `bottom`."""
    tables = scenario.model_dump() | {"ground": ground, "obstacles": []}
    tables["workspace"]["lower"] = (-3.5, -3.5, bottom)
    return js.Scenario.model_validate(tables)


@pytest.fixture(scope="module")
def scenario(scenarios) -> js.Scenario:
    return scenarios[0]


def test_without_a_word_it_is_at_the_lowest_base_and_changes_no_digest(scenario):
    assert scenario.ground_height == 0
    assert "ground" not in scenario.to_toml()
    lower = restated(scenario, Frame(1.0, 1.0, (0.0, 0.0, -1.0)))
    assert lower.ground_height == -1
    assert with_ground(scenario, {"height": 0.3}).digest != with_ground(scenario, None).digest


def test_it_is_stated_in_the_file(scenario):
    raised = with_ground(scenario, {"height": 0.3})
    assert raised.ground_height == 0.3
    assert js.Scenario.from_toml(raised.to_toml()).digest == raised.digest
    none = with_ground(scenario, "none")
    assert none.ground_height is None
    assert js.Scenario.from_toml(none.to_toml()).digest == none.digest


def test_it_moves_with_the_frame(scenario):
    raised = with_ground(scenario, {"height": 0.3})
    moved = restated(raised, Frame(2.0, 1.0, (5.0, 0.0, 100.0)))
    assert moved.ground_height == pytest.approx(100.6)
    assert moved.own.ground_height == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[ground]\nhight = 1\n", 'ground.hight = 1 is not a known key; did you mean "height"?'),
        ('[ground]\nheight = "a"\n', 'ground.height = "a" must be a number; give the z'),
        ("[ground]\n", "ground.height is missing; give the z of the ground in m"),
        ("[ground]\nheight = nan\n", "ground.height = nan must be finite"),
    ],
)
def test_what_is_wrong_with_it_is_told(scenario, text, message):
    toml = scenario.to_toml().replace("[task]", f"{text}[task]")
    with pytest.raises(js.ScenarioError, match="ground") as told:
        js.Scenario.from_toml(toml)
    assert any(message in line for line in told.value.problems)


def test_start_goal_and_ends_keep_off_it(scenario):
    tables = scenario.model_dump() | {"ground": {"height": 0.9}}
    with pytest.raises(Exception, match=r"task.start = .* warning area of the ground at z = 0.9"):
        js.Scenario.model_validate(tables)
    with pytest.raises(Exception, match=r"robots\[0\].end = .* puts the cable into the warning"):
        js.Scenario.model_validate(tables | {"ground": {"height": 6.95}})


@pytest.mark.parametrize("number", range(6))
def test_the_benchmark_touches_its_limit_exactly(scenarios, number):
    world = build_world(scenarios[number])
    assert world.floor == pytest.approx(world.lower.z, abs=1e-15)


def test_neither_search_nor_free_space_go_below_it(scenario):
    raised = with_ground(scenario, {"height": 0.5})
    problem = js.Problem.from_scenario(raised, search="box")
    assert problem.lower[2] == pytest.approx(0.5 + 0.15 + 0.05)
    below = np.array([0.0, 0.0, 0.69])
    assert domain_of(raised).excess(below) == pytest.approx(0.01)
    assert domain_of(with_ground(scenario, "none")).excess(below) < 0


def test_a_plan_that_comes_too_near_is_refused_and_one_that_touches_the_limit_is_not(scenario):
    low = with_ground(scenario, None)
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1]
    line[1:4, 2] = 0.19
    found = js.plan_through(low, line)
    assert any(
        "load comes as near as 0.0" in text and "to ground" in text for text in found.reasons
    )
    task = low.task.model_copy(update={"start": (0.0, 1.0, 0.2), "goal": (0.0, -1.0, 0.2)})
    flat = low.model_copy(update={"task": task})
    touching = js.plan_through(flat, np.linspace(task.start, task.goal, 7)[1:-1], smooth=False)
    assert touching.reasons == ()
    clearance = next(
        each for each in touching.certificate.clearances if each.kind == "load to the ground"
    )
    assert clearance.value == pytest.approx(0.05, abs=ROUNDING)


def test_simulation_has_the_same_ground(scenario):
    def floor(ground):
        low = with_ground(scenario, ground)
        line = np.linspace(low.task.start, low.task.goal, 7)[1:-1]
        model = build_spec(js.plan_through(low, line).rigging).compile()
        names = [model.geom(i).name for i in range(model.ngeom)]
        return model.geom("floor").pos[2] if "floor" in names else None

    assert floor(None) == 0
    assert floor({"height": 0.3}) == 0.3
    assert floor("none") is None
