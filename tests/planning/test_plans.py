"""Plans through given waypoints: what is right about a good one, and why bad ones are refused."""

import dataclasses

import numpy as np
import pytest
from plans import EXAMPLES, LOW
from scipy.spatial.transform import Rotation

import jaxsusp as js
from jaxsusp.mechanics import arm
from jaxsusp.verify.constraints import TURN, Check, _cables_in_load


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
    assert limit(plan, "distance off the goal").value < 1e-9
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
        (LOW, [[0.0, np.nan, 7.0]] * 3, "ends: has .* give finite numbers"),
        ([[1e200, 0.0, 1.0]], None, "waypoints: has .* give finite numbers up to 1e"),
        ([[0.0, 0.0, 1.0], [1.0]], None, "waypoints: is no array of numbers"),
        ("here", None, "waypoints: is no array of numbers"),
    ],
)
def test_bad_shapes_are_refused(scenarios, waypoints, ends, message):
    with pytest.raises(js.InputError, match=message):
        js.plan_through(scenarios[0], waypoints, ends)


@pytest.mark.fast
def test_loads_that_rolling_bases_would_tilt_are_refused():
    rim = js.load_scenario("rim")
    low, *others = rim.payload.attachments
    uneven = rim.payload.model_copy(update={"attachments": ((low[0], low[1], 0.0), *others)})
    tilted = rim.model_copy(update={"drive": "base", "payload": uneven})
    with pytest.raises(js.InputError, match=r"give all of them one height"):
        js.plan_through(tilted, LOW)


def test_elbows_are_one_truth_value_per_robot(scenarios):
    with pytest.raises(js.InputError, match="one truth value per robot"):
        js.plan_through(scenarios[0], LOW, elbow_up=True)


def test_a_cable_in_its_own_link_is_refused(plan):
    """Robot 1 stands so that its lower link lies along its own cable."""
    robots = list(plan.scenario.model_dump()["robots"])
    hook, end = plan.position[0] + [0, 0, 0.15], np.array(robots[0]["end"])
    along = (hook - end) / np.linalg.norm(hook - end)
    elbow = end + 2.0 * along  # the lower link is 2 m long
    out = np.array([0.0, 3.0 * np.cos(np.deg2rad(70)), -3.0 * np.sin(np.deg2rad(70))])
    shoulder = elbow + out
    robots[0] |= {"base": tuple((shoulder - [0, 0, 4]).tolist())}
    content = plan.scenario.model_dump() | {"robots": robots, "obstacles": ()}
    bent = js.Scenario.model_validate(content)
    found = [
        js.plan_through(bent, plan.waypoints, elbow_up=[up, False, False]) for up in (True, False)
    ]
    bad = max(found, key=lambda each: sum("lower link" in reason for reason in each.reasons))
    assert any(reason.startswith("cable 1 hits lower link of robot 1") for reason in bad.reasons)


def test_a_cable_through_its_own_load_is_refused():
    content = js.load_scenario("rim").model_dump()
    content["payload"] |= {
        "attachments": ((0, 0.05, -0.15), (-0.0435, -0.025, -0.15), (0.0435, -0.025, -0.15)),
        "center_of_mass": (0.0, 0.0, -0.14),
    }
    bad = js.plan_through(js.Scenario.model_validate(content), ON_THE_RIM)
    assert any(reason.startswith("share of a cable in its load") for reason in bad.reasons)
    good = js.plan_through(js.load_scenario("rim"), ON_THE_RIM)
    assert limit(good, "share of a cable in its load").value == 0


@pytest.mark.fast
def test_the_share_of_a_cable_in_its_load_is_exact():
    """Straight up from the bottom and aslant from the middle of the side, through a level load."""
    payload = js.load_scenario("rim").payload.model_copy(
        update={"attachments": ((0.05, 0.0, -0.15), (0.1, 0.0, 0.0), (0.1, 0.0, 0.15))}
    )
    scenario = js.load_scenario("rim").model_copy(update={"payload": payload})
    ends = np.array([[[0.05, 0.0, 1.85], [-1.9, 0.0, 0.5], [2.0, 0.0, 4.0]]])
    found = _cables_in_load(scenario, np.eye(3)[None], np.zeros((1, 3)), ends)
    np.testing.assert_allclose(found, [[0.298 / 2, 0.198 / 2, 0.0]], atol=1e-9)


@pytest.mark.fast
def test_ends_that_move_while_the_load_pauses_are_refused():
    scenario = changed(js.load_scenario("hybrid"), task={"goal": (-2.4, 0.0, 1.0)})
    way = np.tile([-2.4, 0.0, 1.0], (3, 1))
    ends = np.tile([robot.end for robot in scenario.robots], (40, 1, 1))
    ends[20:, 0] += 1.0
    with pytest.raises(js.InputError, match="what goes beside a path moves along with it"):
        js.plan_through(scenario, way, ends)


# Separate attachments

ON_THE_RIM = [(-0.9, 1.2, 1.2), (-0.3, 1.4, 1.5), (0.5, 0.8, 1.9)]


def test_a_load_on_a_rim_is_planned_in_its_equilibrium_posture():
    scenario = js.load_scenario("rim")
    plan = js.plan_through(scenario, ON_THE_RIM)
    assert plan.feasible, plan.reasons
    assert 1 < np.rad2deg(np.abs(plan.angles).max()) < 10
    posture = Rotation.from_euler("xyz", plan.angles).as_matrix()  # extrinsic: Rz Ry Rx
    arms = np.einsum("nij,kj->nki", posture, np.array(scenario.payload.attachments))
    cables = plan.ends - (plan.position[:, None] + arms)
    np.testing.assert_allclose(np.linalg.norm(cables, axis=-1), plan.lengths, atol=1e-9)
    pull = plan.tensions[..., None] * cables / plan.lengths[..., None]
    needed = 10 * (plan.acceleration + np.array([0, 0, 9.81]))
    np.testing.assert_allclose(pull.sum(axis=1), needed, atol=1e-6)
    np.testing.assert_allclose(np.cross(arms, pull).sum(axis=1), 0, atol=1e-6)
    names = {each.name for each in plan.report}
    assert names >= {TURN, "stiffness of the equilibrium", "moment that no tension balances"}
    assert limit(plan, "stiffness of the equilibrium").value > 100


def test_a_level_plan_that_is_no_equilibrium_is_refused_with_that_reason():
    scenario = changed(js.load_scenario("rim"), limits={"posture_deg": 6.0})
    bad = js.plan_through(scenario, [(-1.0, 1.6, 1.2), (-0.3, 2.3, 1.7), (0.5, 0.8, 1.9)])
    assert not bad.feasible
    (reason,) = (each for each in bad.reasons if each.startswith("level is no equilibrium"))
    assert "turn of the load from level is" in reason
    assert "allowed is at most 6 °" in reason


def test_a_task_whose_start_is_no_level_equilibrium_is_told_before_any_search(monkeypatch):
    monkeypatch.setattr("jaxsusp.planning.steps.run_batch", lambda *_: pytest.fail("searched"))
    scenario = changed(js.load_scenario("rim"), limits={"posture_deg": 3.0})
    with pytest.raises(js.ImpossibleTaskError, match=r"at task.start .* level is no equilibrium"):
        js.plan(scenario)


# Ends that move


def test_ends_that_the_rule_takes_out_of_reach_are_told_before_any_search(monkeypatch):
    monkeypatch.setattr("jaxsusp.planning.steps.run_batch", lambda *_: pytest.fail("searched"))
    far = changed(js.load_scenario("end-driven"), task={"goal": (3.2, -1.2, 1.6)})
    with pytest.raises(js.ImpossibleTaskError) as told:
        js.plan(far)
    message = str(told.value)
    assert 'at task.goal (3.2, -1.2, 1.6) drive = "end" takes the end of robot ' in message
    assert "its arm reaches 1 to 5 m and keeps 0.5 m off its own axis" in message


@pytest.fixture(scope="module")
def rolling() -> js.Plan:
    return js.plan_through(js.load_scenario("base-driven"), EXAMPLES["base-driven"])


def test_where_bases_roll_everything_else_of_an_arm_stays(rolling):
    assert rolling.feasible, rolling.reasons
    assert rolling.ends.shape == (40, 3, 3)
    np.testing.assert_allclose(rolling.joints, np.tile(rolling.joints[:1], (40, 1, 1)), atol=1e-9)
    assert np.ptp(rolling.lengths, axis=0).max() < 1e-3
    assert np.ptp(rolling.ends[..., 2]) < 1e-9
    hooks = rolling.position + np.array([0, 0, 0.15])
    cables = rolling.ends - hooks[:, None]
    np.testing.assert_allclose(np.linalg.norm(cables, axis=-1), rolling.lengths, atol=1e-9)
    pull = (rolling.tensions[..., None] * cables / rolling.lengths[..., None]).sum(axis=1)
    np.testing.assert_allclose(
        pull, 10 * (rolling.acceleration + np.array([0, 0, 9.81])), atol=1e-9
    )
    assert limit(rolling, "greatest change of length").high == 1e-3
    assert limit(rolling, "lift of a base").value < 1e-9


def test_a_load_too_low_for_cables_that_keep_their_length_is_refused(rolling):
    """From a start high up cables are short, and do not reach down again."""
    short = changed(rolling.scenario, task={"start": (-1.0, 0.8, 4.5)})
    bad = js.plan_through(short, [(-0.5, 0.5, 3.0), (0.0, 0.2, 1.5), (0.5, 0.0, 0.5)])
    assert any(reason.startswith("greatest change of length") for reason in bad.reasons)
    assert np.isfinite(bad.ends).all()


def test_ends_that_stretch_their_cables_are_refused(rolling):
    off = rolling.end_path.copy()
    off[10:14, 0] += [0.0, 0.05, 0.0]
    bad = js.plan_through(rolling.scenario, rolling.waypoints, off)
    assert any(reason.startswith("greatest change of length of cable 1") for reason in bad.reasons)
    lifted = rolling.end_path + np.array([0, 0, 0.01])
    bad = js.plan_through(rolling.scenario, rolling.waypoints, lifted)
    assert any(reason.startswith("lift of a base of robot") for reason in bad.reasons)


def test_moving_ends_are_rows_beside_the_path(rolling):
    with pytest.raises(js.InputError, match=r'drive = "base" moves them; give one per sample'):
        js.plan_through(rolling.scenario, EXAMPLES["base-driven"], rolling.end_path[0])


def test_a_plan_with_moving_ends_is_verified_and_changes_to_it_are_noticed(rolling):
    found = js.verify_plan(rolling)
    assert found.ok, found.reasons
    assert found.simulation is not None
    assert found.simulation.tracking_error < 0.005
    other = dataclasses.replace(rolling, ends=rolling.ends + 0.01)
    reasons = js.verify_plan(other, simulation=False).reasons
    assert any(reason.startswith("ends differs") for reason in reasons)
    other = dataclasses.replace(rolling, joints=rolling.joints + 0.01)
    reasons = js.verify_plan(other, simulation=False).reasons
    assert any("joint angles of robot 1 hold its end" in reason for reason in reasons)


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
        (lambda p: {"path": p.path * np.linspace(1, 0.4, 40)[:, None]}, "hits"),
        (lambda p: {"waypoints": p.waypoints + 0.1}, "off the curve through its waypoints"),
        (lambda p: {"law_speed": p.law_speed + 0.1}, "law does not lead from rest"),
    ],
)
def test_changed_plans_are_refused_with_the_reason(plan, change, reason):
    found = js.verify_plan(dataclasses.replace(plan, **change(plan)), simulation=False)
    assert not found.ok
    assert any(reason in each for each in found.reasons), found.reasons
