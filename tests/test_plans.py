"""Plans through given waypoints: what is right about a good one, and why bad ones are refused."""

import dataclasses

import numpy as np
import pytest
from plans import LOW

import jaxsusp as js
from jaxsusp.mechanics import arm
from jaxsusp.verify.limits import Check


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW)


def changed(scenario: js.Scenario, **tables) -> js.Scenario:
    content = scenario.model_dump()
    for table, values in tables.items():
        content[table] = {**content[table], **values}
    return js.Scenario.model_validate(content)


def limit(plan: js.Plan, name: str) -> Check:
    return next(each for each in plan.report if each.name == name)


def test_a_good_plan_is_feasible_and_consistent(plan, scenarios):
    assert plan.feasible
    assert plan.certificate.proved
    assert plan.reasons == ()
    assert all(each.ok for each in plan.report)
    np.testing.assert_allclose(plan.position[0], scenarios[0].task.start, atol=1e-12)
    np.testing.assert_allclose(plan.position[-1], scenarios[0].task.goal, atol=1e-12)
    hooks = plan.position + np.array([0, 0, 0.15])
    gaps = plan.ends[None] - hooks[:, None]
    np.testing.assert_allclose(plan.lengths, np.linalg.norm(gaps, axis=-1))
    pull = (plan.tensions[..., None] * gaps / plan.lengths[..., None]).sum(axis=1)
    np.testing.assert_allclose(pull, 10 * (plan.acceleration + np.array([0, 0, 9.81])), atol=1e-9)
    for k, robot in enumerate(plan.scenario.robots):
        held = arm.forward(np.array(robot.base), np.array(robot.links), plan.joints[0, k])
        np.testing.assert_allclose(held, plan.ends[k], atol=1e-9)


def test_the_report_has_every_limit_of_eq_22(plan):
    names = {each.name for each in plan.report}
    assert names >= {
        "tilt of the load", "distance of load to obstacles", "distance of cables to obstacles",
        "distance of arms to obstacles", "least length", "greatest length", "least tension",
        "greatest tension", "ultimate tension T_lim", "tension ratio C_t",
        "stability factor S_c", "reach",
    }  # fmt: skip
    assert limit(plan, "ultimate tension T_lim").high == 150
    assert limit(plan, "greatest tension").margin == pytest.approx(
        100 - plan.loads_at(np.linspace(0, 40, 2001)).tensions.max()
    )


def test_a_waypoint_in_an_obstacle_is_refused(plan):
    waypoints = plan.waypoints.copy()
    waypoints[2] = (-0.46, 0.46, 1.0)  # in the low wall
    bad = js.plan_through(plan.scenario, waypoints)
    assert not bad.feasible
    assert not bad.certificate.proved
    assert any("load hits low wall" in reason for reason in bad.reasons)


def test_tensions_over_the_limit_are_refused(plan):
    tight = changed(plan.scenario, limits={"tension": (1.0, 70.0)})
    bad = js.plan_through(tight, plan.waypoints)
    assert not bad.feasible
    (reason,) = bad.reasons
    assert "greatest tension of cable" in reason
    assert "at most 70 N" in reason


def test_the_ultimate_tension_is_compared_with_the_dynamic_peak(plan):
    """In 2.5 s the load needs far more than at rest."""
    hasty = changed(plan.scenario, task={"duration": 2.5}, limits={"safety_factor": 1.0})
    bad = js.plan_through(hasty, plan.waypoints)
    peak, static = limit(bad, "ultimate tension T_lim"), limit(plan, "greatest tension")
    assert peak.value > 1.2 * static.value
    assert peak.value > peak.high
    assert any(reason.startswith("ultimate tension T_lim") for reason in bad.reasons)
    assert any(reason.startswith("tilt of the load") for reason in bad.reasons)


def test_an_end_out_of_reach_is_refused(plan):
    ends = plan.ends.copy()
    ends[1] += (-3.0, -2.0, 0.0)
    bad = js.plan_through(plan.scenario, plan.waypoints, ends)
    assert any("reach of robot 2 is 5.49" in reason for reason in bad.reasons)


def test_joint_limits_and_workspace_are_checked(plan):
    bent = changed(plan.scenario, limits={"joint_limits_deg": [[[-180, 180], [-90, 90], [0, 90]]]})
    bad = js.plan_through(bent, plan.waypoints)
    assert any("joint angle φ3 of robot" in reason for reason in bad.reasons)
    low = changed(plan.scenario, workspace={"upper": (3.5, 3.5, 3.1)})
    bad = js.plan_through(low, plan.waypoints)
    assert any("inside the workspace" in reason for reason in bad.reasons)


@pytest.mark.parametrize(
    ("waypoints", "ends", "message"),
    [
        ([[0.0, 0.0]], None, "waypoints"),
        ([[0.0, np.nan, 1.0]], None, "waypoints"),
        (LOW, [[0.0, 6.0, 7.0]], "one per robot"),
    ],
)
def test_bad_shapes_are_refused(scenarios, waypoints, ends, message):
    with pytest.raises(js.InputError, match=message):
        js.plan_through(scenarios[0], waypoints, ends)


def test_other_systems_are_refused(scenarios):
    moving = scenarios[0].model_copy(update={"drive": "end"})
    with pytest.raises(js.InputError, match="drive"):
        js.plan_through(moving, LOW)


# Verification of plans that were changed afterwards


def test_a_plan_that_was_not_changed_passes(plan):
    found = js.verify_plan(plan)
    assert found.ok
    assert found.reasons == ()
    assert found.simulation is not None
    assert found.simulation.tracking_error < 0.005
    assert found.simulation.tension_error < 0.01


def moved_row(plan):
    position = plan.position.copy()
    position[12] = (-0.46, 0.46, 0.8)
    return {"position": position}


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (moved_row, "stored row 12: load touches low wall"),
        (lambda p: {"tensions": 2 * p.tensions}, "stored tension of cable"),
        (lambda p: {"tensions": np.full_like(p.tensions, np.nan)}, "stored tension of cable"),
        (lambda p: {"joints": p.joints + 0.1}, "joint angles of robot 1 hold its end"),
        (lambda p: {"waypoints": p.waypoints * [1, 1, 0.4]}, "hits"),
    ],
)
def test_changed_plans_are_refused_with_the_reason(plan, change, reason):
    found = js.verify_plan(dataclasses.replace(plan, **change(plan)), simulation=False)
    assert not found.ok
    assert any(reason in each for each in found.reasons), found.reasons
