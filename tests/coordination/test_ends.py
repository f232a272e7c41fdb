"""Placed ends: always in reach, and better than the given ones."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plans import LOW

import jaxsusp as js
from jaxsusp.coordination.ends import decode, encode, end_bounds, end_problem, evaluate_ends
from jaxsusp.mechanics import arm
from jaxsusp.planning.waypoints import plan_through, sample_path
from jaxsusp.scenario.world import build_world
from jaxsusp.suspension.armclearance import choose_postures, separation_slack
from jaxsusp.vec3 import Vec3


@pytest.fixture(scope="module")
def path(scenarios):
    return sample_path(scenarios[0], LOW, 40)


decoded = jax.jit(decode)
reachable = jax.jit(arm.reachable)


@given(st.lists(st.floats(0, 1), min_size=7, max_size=7))
@settings(max_examples=60, deadline=None)
def test_whatever_the_variables_the_ends_are_in_reach(scenarios, unit):
    lower, upper = end_bounds(scenarios[0])
    robots = build_world(scenarios[0]).robots
    for dtype in (np.float32, np.float64):
        x = (lower + (upper - lower) * np.array(unit)).astype(dtype)
        cast = type(robots)(*(leaf.astype(dtype) for leaf in robots))
        ends = np.asarray(decoded(cast, x), np.float64)
        assert np.ptp(ends[:, 2]) == 0
        assert np.asarray(reachable(robots.base, robots.links, ends)).all()
        assert 4.2 - 1e-6 <= ends[0, 2] <= 8.8


def test_ends_in_reach_are_left_where_they_are(scenarios):
    ends = np.array([robot.end for robot in scenarios[0].robots])
    np.testing.assert_allclose(
        decoded(build_world(scenarios[0]).robots, encode(ends)), ends, atol=1e-9
    )


@jax.jit
def f3_and_f4(fitness, x):
    terms = fitness.terms(x)
    return terms.cable, terms.tension_rate


def test_the_given_ends_are_worth_what_eq_21_says(scenarios, path):
    ends = np.array([robot.end for robot in scenarios[0].robots])
    worth = evaluate_ends(end_problem(scenarios[0], path), encode(ends))
    problem = js.Problem.from_scenario(scenarios[0], search="box")
    cable, rate = f3_and_f4(problem.fitness, LOW.reshape(-1))
    assert worth.cable == pytest.approx(float(cable), rel=1e-9)
    assert worth.tension_rate == pytest.approx(float(rate), rel=1e-9)
    assert worth.faults == 0


def test_placed_ends_are_better_than_the_given_ones(scenarios, path):
    scenario = scenarios[0]
    given_ends = np.array([robot.end for robot in scenario.robots])
    before = evaluate_ends(end_problem(scenario, path), encode(given_ends))
    placed = js.place_ends(
        scenario, path, "pso", seed=1, runs=2, iterations=40, population=20, refined=False
    )
    assert placed.faults == 0
    assert placed.cable + placed.tension_rate < before.cable + before.tension_rate - 1
    plan = plan_through(scenario, LOW, placed.ends)
    assert not any("reach" in reason for reason in plan.reasons)
    np.testing.assert_allclose(placed.lengths.sum(), placed.cable)


def test_the_printed_table_2_is_out_of_reach(scenarios):
    """Every row of the paper's Table 2 puts ends beyond the arms they are printed for."""
    from jaxsusp.report.comparison import paper

    printed = np.genfromtxt(
        paper.__file__.replace("paper.py", "data/tables2_3.csv"),
        delimiter=",", skip_header=1, usecols=(1, 2, 3, 4),
    )  # fmt: skip
    robots = build_world(scenarios[0]).robots
    for robot, *end in printed:
        k = int(robot) - 1
        assert not arm.reachable(robots.base[k], robots.links[k], np.array(end))


def test_what_is_in_the_way_of_an_arm_is_noticed(scenarios):
    """Slack against distances of the same segments, one after the other."""
    from jaxsusp.geometry.segments import segment_distance

    scenario = scenarios[0].model_copy(update={"obstacles": ()})
    world = build_world(scenario, (4, 2, 2))
    position = Vec3(*(jnp.linspace(a, b, 5) for a, b in ((0.0, 0.5), (2.0, -2.0), (1.0, 3.0))))
    ends = jnp.array([robot.end for robot in scenario.robots])
    found = jax.jit(choose_postures)(world, position, ends)
    chains = np.asarray(found.chains)

    distance = jax.jit(segment_distance)

    def apart(a, b, c, d):
        points = (Vec3(*np.asarray(p, float)[:, None]) for p in (a, b, c, d))
        return float(distance(*points)[0])

    least, own = np.inf, np.inf
    for row in range(5):
        hook = np.array([float(c[row]) for c in position]) + np.array([0, 0, 0.15])
        for part in range(3):
            for j in range(3):
                if part < 2 or j:
                    gap = apart(chains[0, part], chains[0, part + 1], hook, ends[j])
                    least = min(least, gap - 0.01 - (0.08 if part else 0.12))
        begun = np.asarray(ends[0]) + 0.1 * (hook - np.asarray(ends[0]))
        own = min(own, apart(chains[0, 2], chains[0, 3], hook, begun) - 0.01 - 0.08)
    assert own < least - 0.05  # the first tenth of the own cable may touch its link, no more
    assert float(found.slack[0]) == pytest.approx(own, abs=1e-9)
    between = min(
        apart(chains[j, a], chains[j, a + 1], chains[k, b], chains[k, b + 1])
        - (0.08 if a else 0.12) - (0.08 if b else 0.12)
        for j, k in ((0, 1), (0, 2), (1, 2)) for a in range(3) for b in range(3)
    )  # fmt: skip
    assert float(jax.jit(separation_slack)(world, found.chains)) == pytest.approx(
        between - 0.5, abs=1e-9
    )
