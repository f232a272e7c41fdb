"""The certificate against distances computed otherwise, and against what it must not miss.

The other distances are signed distances of points: closed forms for box, cylinder and sphere,
sampled densely along cables and on the surface of the load.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from plans import HIGH

import jaxsusp as js
from jaxsusp.planning.waypoints import plan_through
from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.certificate import TOLERANCE, certify
from jaxsusp.verify.pairs import KINDS

HOOK = np.array([0.0, 0.0, 0.15])


@pytest.fixture(scope="module")
def plan(scenarios):
    return plan_through(scenarios[5], HIGH)


def scenario_with(scenario, *obstacles, **changed):
    content = scenario.model_dump()
    content["obstacles"] = obstacles
    for table, values in changed.items():
        content[table] = {**content[table], **values}
    return js.Scenario.model_validate(content)


def check(scenario, points, **options):
    """Certify the smooth path through points, with the scenario's ends and arms that suit them."""
    law = TimeLaw.through(np.asarray(points, float), scenario.task.duration)
    ends = np.array([[robot.end for robot in scenario.robots]])
    return certify(Rigging.of(scenario, law, ends), **options)


def signed_distance(obstacle, points: np.ndarray) -> np.ndarray:
    """Of points (…, 3) to the surface of an obstacle, negative inside (m)."""
    local = points - np.array(obstacle.center)
    match obstacle.kind:
        case "sphere":
            return np.linalg.norm(local, axis=-1) - obstacle.radius
        case "cylinder":
            level = np.linalg.norm(local[..., :2], axis=-1)
            gap = np.stack(
                [level - obstacle.radius, np.abs(local[..., 2]) - obstacle.height / 2], axis=-1
            )
        case "box":
            gap = np.abs(local) - np.array(obstacle.size) / 2
    outside = np.linalg.norm(np.maximum(gap, 0), axis=-1)
    return outside + np.minimum(gap.max(axis=-1), 0)


def surface_of_load() -> np.ndarray:
    """Points on the rims and sides of the load, relative to its centre."""
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = 0.1 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    heights = np.linspace(-0.15, 0.15, 13)
    return np.array([[x, y, z] for z in heights for x, y in ring])


def test_least_distances_are_those_of_a_dense_check(plan):
    assert plan.certificate.proved
    centers = plan.at(np.linspace(0, 40, 1201)).position
    share = np.linspace(0, 1, 600)[:, None]
    load = surface_of_load()
    least = {"load": np.inf, "cables": np.inf}
    for some in np.split(centers[:, None], range(20, len(centers), 20)):
        cables = [(1 - share) * (some + HOOK) + share * end for end in plan.ends]
        for obstacle in plan.scenario.obstacles:
            least["load"] = min(least["load"], signed_distance(obstacle, some + load).min())
            for cable in cables:
                gap = signed_distance(obstacle, cable).min() - 0.01
                least["cables"] = min(least["cables"], gap)
    found = {each.kind: each for each in plan.certificate.clearances}
    for name, dense in least.items():
        exact = found[f"{name} to obstacles"].value
        assert exact <= dense + 1e-6  # sampling cannot find less than there is …
        assert exact == pytest.approx(dense, abs=2e-3)  # … nor much more
        assert exact >= 0.05


def test_every_kind_of_pair_is_reported(plan):
    assert [each.kind for each in plan.certificate.clearances] == list(KINDS)
    for each in plan.certificate.clearances:
        assert each.bodies[0]
        assert 0 <= each.time <= 40


def test_a_thin_wall_between_two_samples_is_found(scenarios):
    """5 mm thick, across a straight way: the load is clear of it at every sample."""
    wall = {"kind": "box", "name": "sheet", "center": (0.0, 0.0, 2.0), "size": (0.3, 0.005, 0.3)}
    free = scenario_with(scenarios[0])
    walled = scenario_with(scenarios[0], wall)
    points = np.linspace(free.task.start, free.task.goal, 12)
    assert check(free, points).proved
    at_samples = points[:, None] + surface_of_load()
    assert signed_distance(SimpleNamespace(**wall), at_samples).min() > 0.06
    found = check(walled, points)
    assert not found.proved
    first = found.contacts[0]
    assert "sheet" in first.bodies
    assert first.least <= 0
    law = TimeLaw.through(points, 40.0)
    center = law.at(np.array([first.time])).position[0]
    gap = signed_distance(SimpleNamespace(**wall), center + surface_of_load()).min()
    assert gap == pytest.approx(0.05, abs=3e-3)  # where it enters the warning area


@pytest.mark.parametrize(("spare", "proved"), [(2e-4, True), (-2e-4, False)])
def test_the_limit_is_the_clearance_to_a_fraction_of_a_millimetre(scenarios, spare, proved):
    """A level way over a long box, at the required distance and a little more or less."""
    top = 1.0 - 0.15 - 0.05 - spare
    box = {"kind": "box", "name": "rail", "center": (0, 0, top / 2), "size": (0.4, 2.0, top)}
    scenario = scenario_with(scenarios[0], box, task={"start": (0, 2, 1), "goal": (0, -2, 1)})
    found = check(scenario, np.linspace(scenario.task.start, scenario.task.goal, 20))
    assert found.proved == proved
    load = found.clearances[0]
    assert load.value == pytest.approx(0.05 + spare, abs=TOLERANCE)


def test_a_cable_through_a_beam_is_found_though_the_load_is_clear(scenarios):
    beam = {"kind": "box", "name": "beam", "center": (0, 3.0, 3.4), "size": (2.0, 0.1, 0.1)}
    scenario = scenario_with(scenarios[0], beam)
    knots = np.array([[0, 2, 1], [0, 1, 2.2], [0, 0, 2.4], [0, -1, 2.6], [0, -2, 3]], float)
    found = check(scenario, knots)
    assert not found.proved
    assert {contact.bodies for contact in found.contacts} == {("cable 1", "beam")}
    assert found.clearances[0].value > 0.5
    early = check(scenario, knots, first_only=True)
    assert not early.proved
    assert early.distances < found.distances


def test_an_arm_is_held_clear_of_its_own_cable(plan):
    """Elbow up the nominal arms would stand in the way of their own cables."""
    up = plan_through(plan.scenario, plan.waypoints, elbow_up=[True] * 3)
    assert not up.feasible
    assert any("cable 1 hits upper link of robot 1" in reason for reason in up.reasons)
    assert plan.feasible
    assert (plan.joints[:, :, 2] < 0).all()
