"""The count n_p is sound between the samples (spec §5): zero means clear at every instant.

The reference moves payload and cables along the polyline in small steps and measures points of
them against the warning areas, with formulas of its own.
"""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.geometry.collisions import Bodies, count_collisions
from jaxsusp.geometry.obstacles import pack
from jaxsusp.problem.fitness import trajectory
from jaxsusp.vec3 import Vec3

count = jax.jit(count_collisions)
ALONG_CABLE = np.linspace(0, 1, 250)[:, None]


def signed_distance(obstacle, p: np.ndarray) -> np.ndarray:
    """Exact distance outside an obstacle; inside, any negative number."""
    q = p - np.asarray(obstacle.center)
    match obstacle.kind:
        case "box":
            yaw = np.deg2rad(obstacle.yaw_deg)
            c, s = np.cos(yaw), np.sin(yaw)
            q = np.stack(
                [c * q[..., 0] + s * q[..., 1], c * q[..., 1] - s * q[..., 0], q[..., 2]], -1
            )
            gap = np.abs(q) - np.array(obstacle.size) / 2
        case "cylinder":
            gap = np.stack(
                [
                    np.hypot(q[..., 0], q[..., 1]) - obstacle.radius,
                    np.abs(q[..., 2]) - obstacle.height / 2,
                ],
                -1,
            )
        case "sphere":
            return np.linalg.norm(q, axis=-1) - obstacle.radius
    outside = np.linalg.norm(np.maximum(gap, 0), axis=-1)
    return np.where((gap <= 0).all(axis=-1), gap.max(axis=-1), outside)


def payload_surface(scenario: js.Scenario) -> np.ndarray:
    """Points on the rims, the side and the axis of the payload, relative to its centre."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = scenario.payload.radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    heights = np.linspace(-0.5, 0.5, 5) * scenario.payload.height
    side = np.concatenate([np.column_stack([ring, np.full(12, z)]) for z in heights])
    return np.concatenate([side, np.column_stack([np.zeros((5, 2)), heights])])


def truly_clear(scenario: js.Scenario, polyline: np.ndarray, per_segment: int) -> bool:
    """Dense check: payload and cables outside every warning area at many instants."""
    t = np.linspace(0, 1, per_segment, endpoint=False)[:, None]
    instants = np.concatenate([a + t * (b - a) for a, b in pairwise(polyline)])
    instants = np.concatenate([instants, polyline[-1:]])
    surface = payload_surface(scenario)
    hook = np.array([0, 0, scenario.payload.height / 2])
    cable_radius, clearance = scenario.limits.cable_radius, scenario.limits.clearance
    for obstacle in scenario.obstacles:
        if (signed_distance(obstacle, instants[:, None] + surface) < clearance).any():
            return False
        for robot in scenario.robots:
            hooks = instants[:, None] + hook
            points = hooks + ALONG_CABLE * (np.array(robot.end) - hooks)
            if (signed_distance(obstacle, points) < clearance + cable_radius).any():
                return False
    return True


def clear_by_count(problem: js.Problem, x: np.ndarray) -> np.ndarray:
    return np.asarray(problem.fitness.terms(jnp.asarray(x.T)).collisions) == 0


def polyline(problem: js.Problem, x: np.ndarray) -> np.ndarray:
    return np.asarray(trajectory(problem.fitness.world, jnp.asarray(x), 40).to_array())


@pytest.fixture(scope="module")
def good(problems) -> dict[int, np.ndarray]:
    """Violation-free decision vectors of four scenarios, found by the swarm."""
    found = {}
    for i in (0, 2, 4, 5):
        single = js.Problem(
            problems[i].fitness,
            np.float32(problems[i].lower),
            np.float32(problems[i].upper),
            problems[i].reference,
        )
        result = js.minimize(single, js.pso(), runs=8, iterations=300)
        found[i] = np.float64(result.best)
        terms = problems[i].terms(found[i])
        assert int(terms.collisions) + int(terms.violations) == 0
    return found


def clear_when_refined(problem: js.Problem, x: np.ndarray, parts: int = 20) -> np.ndarray:
    """The same bodies on polylines cut finely: the limit of vanishing half-step margins."""
    world = problem.fitness.world
    path = np.moveaxis(np.array([polyline(problem, row) for row in x]), (2, 1), (0, 1))
    t = np.arange(parts)[:, None] / parts
    fine = path[:, :-1, None] + t * (path[:, 1:] - path[:, :-1])[:, :, None]
    fine = np.concatenate([fine.reshape(3, -1, len(x)), path[:, -1:]], axis=1)
    return np.asarray(count(Vec3(*jnp.asarray(fine)), world.bodies, world.obstacles)) == 0


def test_a_zero_count_is_truly_clear_and_most_clear_motions_are_accepted(
    scenarios, problems, good, capsys
):
    """None missed; of truly clear perturbations of good trajectories the accepted share is printed.

    "Clear" is meant of the inflated bodies for the share, of payload and cables themselves for
    soundness.
    """
    rng = np.random.default_rng(0)
    shares = {}
    for i, best in good.items():
        x = best + rng.normal(scale=0.03, size=(400, 15))
        accepted, clear = clear_by_count(problems[i], x), clear_when_refined(problems[i], x)
        assert 20 < accepted.sum() < 380, "perturb so that some collide and some do not"
        assert clear[accepted].all()
        shares[i + 1] = round(float(accepted[clear].mean()), 3)
        for row in x[accepted][:12]:
            assert truly_clear(scenarios[i], polyline(problems[i], row), 6)
    with capsys.disabled():
        print(f"\naccepted share of truly clear trajectories, by scenario: {shares}")
    assert min(shares.values()) > 0.5


coordinate = st.floats(-2, 2)
point = st.tuples(coordinate, coordinate, coordinate)


@given(
    path=st.lists(point, min_size=2, max_size=5),
    end=st.tuples(coordinate, coordinate, st.floats(1.5, 4)),
    box=st.tuples(point, st.tuples(*[st.floats(0.05, 1)] * 3), st.floats(0, 3.2)),
    cylinder=st.tuples(point, st.floats(0.05, 1), st.floats(0.05, 1)),
    sphere=st.tuples(point, st.floats(0.05, 1)),
)
@settings(deadline=None, max_examples=400)
def test_no_contact_is_missed_whatever_the_bodies(path, end, box, cylinder, sphere):
    """One obstacle of each kind, yawed boxes included, one cable, an arbitrary polyline."""
    from types import SimpleNamespace as Body

    path = np.array([*path, *[path[-1]] * (5 - len(path))])
    (bc, half, yaw), (cc, radius, height), (sc, ball) = box, cylinder, sphere
    obstacles = pack(
        np.array([[*bc, *half, yaw]]),
        np.array([[*cc, radius, height]]),
        np.array([[*sc, ball]]),
        (1, 1, 1),
    )
    bodies = Bodies(
        *map(np.asarray, (0.1, 0.15, 0.01, 0.05)),
        Vec3(np.zeros(1), np.zeros(1), np.full(1, 0.15)),
        Vec3(*np.array(end)[:, None]),
    )
    if int(count(Vec3(*jnp.asarray(path.T)), bodies, obstacles)) > 0:
        return
    scenario = Body(
        payload=Body(radius=0.1, height=0.3),
        limits=Body(cable_radius=0.01, clearance=0.05),
        robots=[Body(end=end)],
        obstacles=[
            Body(kind="box", center=bc, size=2 * np.array(half), yaw_deg=np.rad2deg(yaw)),
            Body(kind="cylinder", center=cc, radius=radius, height=2 * height),
            Body(kind="sphere", center=sc, radius=ball),
        ],
    )
    assert truly_clear(scenario, path, 40)


def sampled_check(scenario: js.Scenario, polyline: np.ndarray) -> bool:
    """The paper's check: load and cables at the 40 samples only."""
    return truly_clear(scenario, polyline, 1)


JUMPS = {  # kept decision vectors; the load makes long steps past an obstacle that a cable meets
    1: "0.28 1.68 1.25 0.35 1.02 1.82 0.02 0.64 2.15 0.21 -0.08 2.72 -0.07 -0.76 3.31",
    6: "-1.48 1.89 2.89 -1.5 1.38 3.54 -0.43 0.49 3.79 0.17 -0.3 3.53 1.06 -1.27 4.07",
}


@pytest.mark.parametrize("number", JUMPS)
def test_a_contact_between_two_samples_is_found(scenarios, problems, number):
    """The paper's check at 40 points passes these trajectories, ours refuses them, rightly."""
    scenario, problem = scenarios[number - 1], problems[number - 1]
    x = np.array(JUMPS[number].split(), float)
    path = polyline(problem, x)
    assert sampled_check(scenario, path)
    assert not truly_clear(scenario, path, 60)
    assert not clear_by_count(problem, x[None])[0]


def test_padding_never_counts(scenarios, problems):
    from jaxsusp.scenario.world import build_world

    x = jnp.asarray(np.random.default_rng(0).uniform(-1, 3, (50, 15)))
    world = build_world(scenarios[0], (9, 8, 7))
    padded = js.Problem.from_scenario(scenarios[0], world=world, search="box")
    np.testing.assert_array_equal(
        problems[0].fitness.terms(x.T).collisions, padded.fitness.terms(x.T).collisions
    )
