"""The built-in examples load, and each of them has a plan without a violation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from plans import EXAMPLES

import jaxsusp as js
from jaxsusp.comparison.workunit import stack_scenarios
from jaxsusp.verify import constraints, simulation
from jaxsusp.verify.simulation import simulate


def test_there_is_an_example_of_every_kind():
    found = {name: js.load_scenario(name) for name in js.examples()}
    assert {s.drive for s in found.values()} == {"cable", "end", "base", "hybrid"}
    assert {len(s.robots) for s in found.values()} == {3, 4, 6}
    assert any(s.payload.attachments != "hook" for s in found.values())
    assert all(name == scenario.name for name, scenario in found.items())
    assert not set(found) & set(js.scenarios())


@pytest.mark.parametrize("name", js.examples())
def test_an_example_can_be_planned_and_its_straight_line_cannot(name):
    scenario = js.load_scenario(name)
    problem = js.Problem.from_scenario(scenario, search="box")
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1]
    both = jnp.asarray(np.stack([problem.decision(each) for each in (line, EXAMPLES[name])]))
    terms = jax.jit(lambda suspension, x: suspension.terms(x.T))(problem.fitness, both)
    assert int(terms.collisions[0]) > 0
    assert (int(terms.collisions[1]), int(terms.violations[1])) == (0, 0)
    assert float(terms.total[1]) < 200


@pytest.mark.parametrize("name", js.examples())
def test_an_example_has_a_plan_that_is_certified_and_followed_in_simulation(name):
    scenario = js.load_scenario(name)
    plan = js.plan_through(scenario, EXAMPLES[name])
    assert plan.reasons == ()
    assert plan.certificate.proved
    assert plan.clearance >= scenario.limits.clearance
    seen = simulate(plan.rigging)
    assert seen.problems(plan.scenario.limits) == []
    assert seen.tracking_error < 0.005
    assert seen.tension_error < 0.015
    # MuJoCo's arms hold the planned ends, and its load turns as planned.
    assert plan.ends.shape == ((40, 3, 3) if plan.rigging.moves else (len(scenario.robots), 3))
    if scenario.payload.attachments != "hook":
        planned = np.rad2deg(np.arccos(plan.loads_at(seen.times).posture[:, 2, 2]))
        np.testing.assert_allclose(seen.tilt, planned, atol=0.3)


def test_systems_of_one_shape_share_a_program():
    chosen = [js.load_scenario(name) for name in (*js.examples(), "scenario-1", "scenario-6")]
    groups = stack_scenarios(chosen, waypoints=2, samples=8, search="box")
    assert [group.names for group in groups] == [
        ["base-driven"],
        ["end-driven"],
        ["four-robots"],
        ["hybrid"],
        ["level-rim"],
        ["rim"],
        ["six-robots"],
        ["scenario-1", "scenario-6"],
    ]


def test_more_robots_are_compared_like_three():
    ds = js.compare(["four-robots"], "pso", 1, 2, 4, search="box", samples=8)
    assert np.isfinite(ds["fitness"].values).all()


@pytest.mark.fast
def test_what_no_rule_moves_says_why():
    rim = js.load_scenario("rim")
    beside = rim.payload.model_copy(update={"center_of_mass": (0.2, 0.0, 0.0)})
    with pytest.raises(js.InputError, match=r"the cable of robots\[\d\] would have to push"):
        js.Problem.from_scenario(rim.model_copy(update={"drive": "base", "payload": beside}))
    four = js.load_scenario("four-robots")
    separate = four.payload.model_copy(update={"attachments": RING})
    led = four.model_copy(update={"payload": separate, "drive": "hybrid"})
    with pytest.raises(js.InputError, match=r"with 4 separate .* leaves open"):
        js.plan_through(led, EXAMPLES["four-robots"])
    level = js.load_scenario("level-rim")
    with pytest.raises(js.InputError, match='give ends = "given"'):
        js.plan(level, ends="placed")
    with pytest.raises(js.InputError, match="fans of ends are for cables that meet at a hook"):
        js.moving_ends(level, np.linspace(level.task.start, level.task.goal, 9))


RING = tuple((0.07 * x, 0.07 * y, 0.15) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)))


def test_a_load_on_four_separate_cables_is_planned_too(monkeypatch):
    """Looked at every 0.16 s, since equilibria of so many cables take long."""
    for module in (constraints, simulation):
        monkeypatch.setattr(module, "INSTANTS", 251)
    monkeypatch.setattr(simulation, "_EVERY", 80)
    content = js.load_scenario("four-robots").model_dump()
    content["payload"]["attachments"] = RING
    content["task"] |= {"start": (-1.2, 0.9, 1.0), "goal": (1.3, -0.9, 2.5)}
    content["obstacles"] = ()
    ring = js.Scenario.model_validate(content)
    plan = js.plan_through(ring, [(-0.7, 0.5, 1.4), (0.0, 0.0, 1.8), (0.7, -0.5, 2.2)])
    assert plan.reasons == ()
    assert 3 < np.rad2deg(np.abs(plan.angles).max()) < 10
    assert simulate(plan.rigging).problems(plan.scenario.limits) == []
