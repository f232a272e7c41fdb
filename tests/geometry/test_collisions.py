"""The count n_p is sound between the samples: zero means clear at every instant.

The reference moves payload and cables along the polyline in small steps and measures points of
them against the warning areas, with formulas of its own.
"""

import functools
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.geometry.collisions import Bodies, count_at_samples, count_collisions
from jaxsusp.geometry.obstacles import pack
from jaxsusp.problem.fitness import trajectory
from jaxsusp.scenario.world import World, build_world
from jaxsusp.vec3 import Vec3

count = jax.jit(count_collisions)
ALONG_CABLE = np.linspace(0, 1, 250)


def signed_distance(obstacle, p: np.ndarray) -> np.ndarray:
    """Exact distance of points (3, …) outside an obstacle; inside, any negative number."""
    x, y, z = (each - middle for each, middle in zip(p, obstacle.center, strict=True))
    match obstacle.kind:
        case "box":
            yaw = np.deg2rad(obstacle.yaw_deg)
            c, s = np.cos(yaw), np.sin(yaw)
            own = c * x + s * y, c * y - s * x, z
            gaps = [np.abs(q) - size / 2 for q, size in zip(own, obstacle.size, strict=True)]
        case "cylinder":
            gaps = [np.sqrt(x**2 + y**2) - obstacle.radius, np.abs(z) - obstacle.height / 2]
        case "sphere":
            return np.sqrt(x**2 + y**2 + z**2) - obstacle.radius
    outside = np.sqrt(sum(np.maximum(gap, 0) ** 2 for gap in gaps))
    deepest = functools.reduce(np.maximum, gaps)
    return np.where(deepest <= 0, deepest, outside)


def payload_surface(scenario: js.Scenario) -> np.ndarray:
    """Points (3, …) on the payload's rims, side and axis, relative to its centre."""
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ring = scenario.payload.radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    heights = np.linspace(-0.5, 0.5, 5) * scenario.payload.height
    side = np.concatenate([np.column_stack([ring, np.full(12, z)]) for z in heights])
    return np.concatenate([side, np.column_stack([np.zeros((5, 2)), heights])]).T


def truly_clear(scenario: js.Scenario, polyline: np.ndarray, per_segment: int) -> bool:
    """Dense check: payload and cables outside every warning area at many instants."""
    t = np.linspace(0, 1, per_segment, endpoint=False)[:, None]
    instants = np.concatenate([a + t * (b - a) for a, b in pairwise(polyline)])
    instants = np.concatenate([instants, polyline[-1:]]).T[:, :, None]
    surface = instants + payload_surface(scenario)[:, None]
    hooks = instants + np.reshape([0, 0, scenario.payload.height / 2], (3, 1, 1))
    ends = [np.reshape(robot.end, (3, 1, 1)) for robot in scenario.robots]
    cables = [hooks + ALONG_CABLE * (end - hooks) for end in ends]
    cable_radius, clearance = scenario.limits.cable_radius, scenario.limits.clearance
    return all(
        (signed_distance(obstacle, surface) >= clearance).all()
        and all((signed_distance(obstacle, c) >= clearance + cable_radius).all() for c in cables)
        for obstacle in scenario.obstacles
    )


@pytest.fixture(scope="module")
def problems(scenarios) -> list[js.Problem]:
    """Those of the six scenarios with places for more obstacles, so that they share programs."""
    return [
        js.Problem.from_scenario(each, world=build_world(each, (9, 8, 7)), search="box")
        for each in scenarios
    ]


@jax.jit
def both_counts(problem: js.Problem, x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Collisions and violations, without the other terms, which take long to compile."""
    terms = problem.fitness.terms(x)
    return terms.collisions, terms.violations


@jax.jit
def positions(world: World, x: jax.Array) -> jax.Array:
    """Sampled trajectories, (3, samples, …)."""
    return jnp.stack(trajectory(world, x, 40))


def counts(problem: js.Problem, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Collisions and violations of up to 400 candidates, by one program whatever their number."""
    found = both_counts(problem, jnp.asarray(np.resize(x, (400, 15)).T))
    return np.asarray(found[0])[: len(x)], np.asarray(found[1])[: len(x)]


def polyline(problem: js.Problem, x: np.ndarray) -> np.ndarray:
    return np.asarray(positions(problem.fitness.world, jnp.asarray(x))).T


GOOD = {  # decision vectors without a violation, as the swarm finds them
    1: "0.15 1.64 1.3 0.3 1.18 1.7 0.21 0.64 2.22 0.06 0.06 2.73 -0.04 -0.72 3.29",
    3: "0.048 1.838 1.351 0.073 1.646 1.741 -0.028 0.956 2.441 -0.2 -0.136 3.067 -0.107 -1.147 "
    "3.224",
    5: "0.05 2.31 2.46 -0.49 1.89 3.7 -0.83 0.38 3.37 -0.57 -0.57 3.35 -0.29 -1.29 3.34",
    6: "-1.63 1.68 2.72 -1.15 1.2 3.49 -0.5 0.44 3.73 0.12 -0.24 3.82 1.08 -1.15 3.91",
}


def clear_when_refined(problem: js.Problem, x: np.ndarray, parts: int = 20) -> np.ndarray:
    """The same bodies on polylines cut finely: the limit of vanishing half-step margins."""
    world = problem.fitness.world
    path = np.asarray(positions(world, jnp.asarray(x.T)))
    t = np.arange(parts)[:, None] / parts
    fine = path[:, :-1, None] + t * (path[:, 1:] - path[:, :-1])[:, :, None]
    fine = np.concatenate([fine.reshape(3, -1, len(x)), path[:, -1:]], axis=1)
    return np.asarray(count(Vec3(*jnp.asarray(fine)), world.bodies, world.obstacles)) == 0


def test_a_zero_count_is_truly_clear_and_most_clear_motions_are_accepted(
    scenarios, problems, capsys
):
    """None missed; of truly clear perturbations of good trajectories the accepted share is printed.

    "Clear" is meant of the inflated bodies for the share, of payload and cables themselves for
    soundness.
    """
    rng = np.random.default_rng(0)
    shares = {}
    for number, found in GOOD.items():
        scenario, problem = scenarios[number - 1], problems[number - 1]
        best = np.array(found.split(), float)
        assert counts(problem, best[None]) == (0, 0)
        x = best + rng.normal(scale=0.03, size=(400, 15))
        accepted, clear = counts(problem, x)[0] == 0, clear_when_refined(problem, x)
        assert 20 < accepted.sum() < 380, "perturb so that some collide and some do not"
        assert clear[accepted].all()
        shares[number] = round(float(accepted[clear].mean()), 3)
        for row in x[accepted][:12]:
            assert truly_clear(scenario, polyline(problem, row), 6)
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
    assert counts(problem, x[None])[0] > 0
    assert at_samples(problem, path[None]) == {1: 2, 6: 0}[number]  # 1: an inflated box's corner


def at_samples(problem: js.Problem, paths: np.ndarray) -> np.ndarray:
    """Contacts at the samples of polylines (…, 40, 3)."""
    world = problem.fitness.world
    position = Vec3(*jnp.moveaxis(jnp.asarray(paths), (-1, -2), (0, 1)))
    return np.asarray(jax.jit(count_at_samples)(position, world.bodies, world.obstacles))


def test_at_the_samples_each_counts_as_a_load_at_rest(problems):
    """The sum over samples of what a motion from each to itself counts, and no more than that."""
    problem = problems[4]
    world, x = problem.fitness.world, np.random.default_rng(1).uniform(-2, 4, (15, 4))
    paths = np.moveaxis(np.asarray(positions(world, jnp.asarray(x))), 0, -1)  # (40, 4, 3)
    resting = Vec3(*jnp.asarray(np.stack([paths.reshape(-1, 3)] * 2)).transpose(2, 0, 1))
    each = np.asarray(count(resting, world.bodies, world.obstacles)).reshape(40, 4)
    found = at_samples(problem, paths.swapaxes(0, 1))
    assert found.min() > 0
    np.testing.assert_array_equal(found, each.sum(axis=0))


def test_padding_never_counts(scenarios, problems):
    x = np.random.default_rng(0).uniform(-1, 3, (50, 15))
    bare = js.Problem.from_scenario(scenarios[0], search="box")
    assert bare.fitness.world.obstacles.counts == (4, 1, 1)
    np.testing.assert_array_equal(counts(bare, x)[0], counts(problems[0], x)[0])
