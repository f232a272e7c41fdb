"""Arms (Eq. 1): the closed-form inverse, the reach, and the paper's Table 2."""

import csv
from importlib.resources import files
from itertools import permutations

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.mechanics.arm import (
    bent,
    chain,
    elbow,
    forward,
    inverse,
    reach,
    reachable,
    shoulder_distance,
)
from jaxsusp.vec3 import Vec3

LINKS = jnp.array([4.0, 3.0, 2.0])
BASES = jnp.array([[0.0, 5.0, 0.0], [-2.5 * np.sqrt(3), -2.5, 0.0], [2.5 * np.sqrt(3), -2.5, 0.0]])

coordinates = st.floats(-20, 20)
points = st.tuples(coordinates, coordinates, coordinates)
links = st.tuples(st.floats(0.1, 10), st.floats(0.1, 10), st.floats(0.1, 10))

inverse_of = jax.jit(inverse)
forward_of = jax.jit(forward)
elbow_of = jax.jit(elbow)


def towards(base, links, share, azimuth, elevation):
    """The end at a share of the way through the arm's reach, in a direction from the shoulder."""
    nearest, farthest = abs(links[1] - links[2]), links[1] + links[2]
    distance = nearest + share * (farthest - nearest)
    direction = [
        np.cos(elevation) * np.cos(azimuth),
        np.cos(elevation) * np.sin(azimuth),
        np.sin(elevation),
    ]
    return np.add(base, [0, 0, links[0]]) + distance * np.array(direction)


reaches = st.tuples(st.floats(0.001, 0.999), st.floats(-np.pi, np.pi), st.floats(-1.5, 1.5))


@settings(deadline=None)  # the first example compiles
@given(points, links, reaches)
def test_forward_undoes_inverse_on_both_branches(base, links, where):
    end = towards(base, links, *where)
    base, links = jnp.array(base), jnp.array(links)
    solution = inverse_of(base, links, jnp.array(end))
    assert solution.reachable
    for joints in (solution.elbow_up, solution.elbow_down):
        np.testing.assert_allclose(forward_of(base, links, joints), end, atol=1e-9)


@settings(deadline=None)  # the first example compiles
@given(points, links, reaches)
def test_the_elbow_is_a_link_away_from_shoulder_and_end(base, links, where):
    end = towards(base, links, *where)
    shoulder = np.add(base, [0, 0, links[0]])
    base, lengths = jnp.array(base), jnp.array(links)
    solution = inverse_of(base, lengths, jnp.array(end))
    up, down = (
        np.asarray(elbow_of(base, lengths, joints))
        for joints in (solution.elbow_up, solution.elbow_down)
    )
    for bend in (up, down):
        assert np.linalg.norm(bend - shoulder) == pytest.approx(links[1], abs=1e-9)
        assert np.linalg.norm(end - bend) == pytest.approx(links[2], abs=1e-9)
    assert up[2] >= down[2] - 1e-9


@settings(deadline=None)  # the first example compiles
@given(links, reaches, st.floats(1e-6, 10))
def test_an_end_is_reachable_exactly_between_the_limits(links, where, beyond):
    base = (1.0, -2.0, 0.5)
    nearest, farthest = abs(links[1] - links[2]), links[1] + links[2]

    def held(distance):
        share = (distance - nearest) / (farthest - nearest)
        end = towards(base, links, share, *where[1:])
        return bool(reachable(*map(jnp.array, (base, links, end))))

    assert held(nearest + where[0] * (farthest - nearest))
    assert not held(farthest + beyond)
    assert beyond >= nearest or not held(nearest - beyond)


def test_an_end_out_of_reach_gives_the_stretched_arm_that_points_at_it():
    base, end = BASES[0], jnp.array([0.0, 15.0, 4.0])
    solution = inverse(base, LINKS, end)
    assert not solution.reachable
    assert shoulder_distance(base, LINKS, end) == 10.0
    np.testing.assert_allclose(
        forward(base, LINKS, solution.elbow_up), [0.0, 10.0, 4.0], atol=1e-12
    )


def test_one_base_serves_a_batch_of_ends():
    ends = jnp.array([[0.0, 6.0, 7.0], [1.0, 6.0, 6.5], [0.0, 30.0, 0.0]])
    solution = inverse(BASES[0], LINKS, ends)
    assert solution.reachable.tolist() == [True, True, False]
    rebuilt = forward(BASES[0], LINKS, solution.elbow_down)
    np.testing.assert_allclose(rebuilt[:2], ends[:2], atol=1e-12)


@pytest.mark.fast
def test_the_reach_of_the_paper_s_arm_is_one_to_five_metres():
    assert [float(limit) for limit in reach(LINKS)] == [1.0, 5.0]


@pytest.fixture(scope="module")
def table_2():
    """Printed ends (m) per algorithm, one row per robot."""
    with (files("jaxsusp.report.comparison") / "data/tables2_3.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    printed = {}
    for row in rows:
        end = [float(row[f"end_{axis}_m"]) for axis in "xyz"]
        printed.setdefault(row["algorithm"], []).append(end)
    return printed


def test_no_printed_end_is_in_reach_of_its_robot(table_2):
    assert list(table_2) == ["PSO", "GA", "DBO", "SDBO"]
    for ends in table_2.values():
        assert not reachable(BASES, LINKS, jnp.array(ends)).any()


def test_no_assignment_of_the_printed_ends_to_robots_is_in_reach(table_2):
    for ends in table_2.values():
        for assignment in permutations(ends):
            assert not reachable(BASES, LINKS, jnp.array(assignment)).all()


def test_every_printed_row_would_need_a_cable_that_pushes(table_2, scenarios):
    """With the hook, at scenario 1's start and at its goal."""
    scenario = scenarios[0]
    places = np.array([scenario.task.start, scenario.task.goal])
    for ends in table_2.values():
        robots = tuple(
            robot.model_copy(update={"end": tuple(end)})
            for robot, end in zip(scenario.robots, ends, strict=True)
        )
        tensions = js.tensions(scenario.model_copy(update={"robots": robots}), places)
        assert (np.asarray(tensions).min(axis=1) < 0).all()


@pytest.mark.parametrize("seed", range(3))
def test_bent_arms_are_those_of_the_joint_angles(seed):
    """In reach, out of it and straight above the base: elbow and end as the chain has them."""
    random = np.random.default_rng(seed)
    base = random.normal(size=(50, 3))
    links = random.uniform(1, 4, size=(50, 3))
    end = base + random.normal(size=(50, 3)) * 4
    end[0] = base[0] + [0, 0, links[0].sum() - 0.5]
    shoulder = base + np.eye(3)[2] * links[:, :1]
    top, hand = (Vec3.from_array(jnp.array(each)) for each in (shoulder, end))
    found = bent(top, *map(jnp.array, links[:, 1:].T), hand)
    solution = inverse(jnp.array(base), jnp.array(links), jnp.array(end))
    for arm, joints in zip(found, (solution.elbow_up, solution.elbow_down), strict=True):
        points = chain(jnp.array(base), jnp.array(links), joints)
        np.testing.assert_allclose(arm.elbow.to_array(), points[:, 2], atol=1e-6)
        np.testing.assert_allclose(arm.end.to_array(), points[:, 3], atol=1e-6)
