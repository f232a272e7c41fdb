"""The simulation: it follows good plans, and notices what is wrong with bad ones."""

import mujoco
import numpy as np
import pytest
from plans import LOW

import jaxsusp as js
from jaxsusp.scenario.ownunits import Frame, restated
from jaxsusp.verify.model import build_spec
from jaxsusp.verify.simulation import commands, export_model, simulate


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW)


def changed(scenario, **tables):
    content = scenario.model_dump()
    for table, values in tables.items():
        content[table] = {**content[table], **values} if isinstance(values, dict) else values
    return js.Scenario.model_validate(content)


def test_at_rest_the_simulated_tensions_are_the_static_ones(plan):
    """Before the plan begins; MuJoCo knows nothing of Eq. 4."""
    model = build_spec(plan.rigging).compile()
    data = mujoco.MjData(model)
    data.ctrl[:] = plan.lengths[0]
    mujoco.mj_step(model, data, 4000)
    static = js.tensions(plan.scenario, data.body("load").xpos)
    np.testing.assert_allclose(-data.actuator_force, static, rtol=2e-5)


def test_a_hasty_plan_swings_and_is_told_so(plan):
    hasty = changed(plan.scenario, task={"duration": 5.0})
    found = simulate(js.plan_through(hasty, plan.waypoints).rigging)
    assert found.swing > 5
    assert any(
        "tilts" in problem or "differ" in problem
        for problem in found.problems(plan.scenario.limits)
    )


def test_contacts_are_noticed(plan):
    crate = {"kind": "box", "name": "crate", "center": (0, 0, 2.6), "size": (1.0, 0.5, 0.8)}
    blocked = changed(plan.scenario, obstacles=(crate,))
    found = simulate(js.plan_through(blocked, plan.waypoints).rigging)
    assert found.contacts[0][1] == "1 crate"
    assert any("touches 1 crate" in problem for problem in found.problems(plan.scenario.limits))


def test_the_exported_model_is_the_simulated_one(plan, tmp_path):
    export_model(plan.rigging, tmp_path / "model.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    data = mujoco.MjData(model)
    assert model.nu == 3
    data.ctrl[:] = commands(plan.rigging, np.zeros(1))[0]
    mujoco.mj_step(model, data, 1000)
    off = np.linalg.norm(data.body("load").xpos - plan.position[0])
    assert off < 2e-3
    cables = [np.asarray(data.tendon(f"cable {k + 1}").length).item() for k in range(3)]
    np.testing.assert_allclose(cables, plan.lengths[0], atol=2e-3)


def test_cables_pull_and_never_push(plan):
    model = build_spec(plan.rigging).compile()
    assert (model.actuator_forcerange[:, 1] == 0).all()
    data = mujoco.MjData(model)
    data.ctrl[:] = plan.lengths[0] + 1.0  # all slack: the load falls
    mujoco.mj_step(model, data, 50)
    np.testing.assert_array_equal(data.actuator_force, 0)
    assert data.qvel[2] == pytest.approx(-9.81 * 50 * model.opt.timestep, rel=1e-3)


@pytest.mark.parametrize("name", ["base-driven", "hybrid", "end-driven"])
def test_an_exported_model_with_moving_ends_is_read_and_played(name, tmp_path):
    scenario = restated(js.load_scenario(name), Frame(0.1, 0.002, (50.0, -20.0, 3.0)))
    ways = np.linspace(scenario.task.start, scenario.task.goal, 5)[1:-1]
    rigging = js.plan_through(scenario, ways).rigging
    export_model(rigging, tmp_path / "model.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, 500)
    off = np.linalg.norm(data.body("load").xpos - scenario.task.start)
    assert off < 1e-3 * scenario.units.length


def test_loads_far_away_are_those_of_the_same_system_nearby():
    near = js.load_scenario("rim")
    frame = Frame(0.1, 1e-3, (5e5, 5e6, 0.0))
    ways = np.linspace(near.task.start, near.task.goal, 5)[1:-1]
    plan = js.plan_through(near, ways)
    far = js.plan_through(restated(near, frame), frame.place(ways))
    times = np.linspace(0, 1, 101)
    known = plan.loads_at(times * plan.times[-1]).tensions
    found = far.loads_at(times * far.times[-1]).tensions
    np.testing.assert_allclose(found, frame.number(known, "N"), rtol=1e-4)
