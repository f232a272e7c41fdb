"""Least variance against brute force, and a panel that only moving ends get the cables past."""

from itertools import product

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.coordination.fans import combinations, offsets, rotated
from jaxsusp.coordination.leastvariance import (
    best_constant,
    best_sequence,
    fixed_ends,
    moving_ends,
    step_costs,
)
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.vec3 import Vec3
from jaxsusp.world import build_world

SAMPLES, KEPT, Q = 5, 4, 6
solve = jax.jit(best_sequence)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1), st.floats(0, 0.6))
def test_dynamic_programming_equals_brute_force(seed, forbidden):
    rng = np.random.default_rng(seed)
    features = rng.normal(size=(SAMPLES, KEPT, Q))
    cost = rng.uniform(0, 5, (SAMPLES, KEPT))
    cost[rng.uniform(size=cost.shape) < forbidden] = np.inf

    def total(chosen):
        rows = features[np.arange(SAMPLES), chosen]
        return cost[np.arange(SAMPLES), chosen].sum() + (np.diff(rows, axis=0) ** 2).sum()

    least = min(total(np.array(chosen)) for chosen in product(range(KEPT), repeat=SAMPLES))
    chosen, found = solve(jnp.asarray(features), jnp.asarray(cost))
    assert float(found) == pytest.approx(least, rel=1e-12)
    if np.isfinite(least):
        assert total(np.asarray(chosen)) == pytest.approx(least, rel=1e-12)


def test_the_cost_of_a_step_is_its_share_of_the_sample_variance():
    """Summed over all candidates of a step it is the variance of Eq. 20, summed over q."""
    rng = np.random.default_rng(0)
    features, feasible = rng.normal(size=(3, 8, Q)), rng.uniform(size=(3, 8)) < 0.6
    cost = np.asarray(step_costs(jnp.asarray(features), jnp.asarray(feasible)))
    for step in range(3):
        expected = features[step][feasible[step]].var(axis=0, ddof=1).sum()
        assert cost[step][feasible[step]].sum() == pytest.approx(expected)
        assert np.isinf(cost[step][~feasible[step]]).all()


def test_one_candidate_alone_costs_nothing_and_none_costs_everything():
    features = jnp.ones((2, 3, Q))
    alone = jnp.asarray([[False, True, False], [False, False, False]])
    cost = np.asarray(step_costs(features, alone))
    assert cost[0, 1] == 0
    assert np.isinf(cost[1]).all()
    assert np.isinf(float(solve(features, jnp.asarray(cost))[1]))


def test_the_best_constant_choice_is_the_best_of_all_constant_choices():
    rng = np.random.default_rng(3)
    features, feasible = rng.normal(size=(4, 9, Q)), rng.uniform(size=(4, 9)) < 0.9
    always = feasible.all(axis=0)
    assert 1 < always.sum() < 9
    best, total = best_constant(jnp.asarray(features), jnp.asarray(feasible))
    mean = features[:, always].mean(axis=1, keepdims=True)
    spread = ((features - mean) ** 2).sum(axis=(0, 2)) / (always.sum() - 1)
    change = (np.diff(features, axis=0) ** 2).sum(axis=(0, 2))
    expected = np.where(always, spread + change, np.inf)
    assert int(best) == expected.argmin()
    assert float(total) == pytest.approx(expected.min())


@settings(deadline=None)  # the first example compiles
@given(st.tuples(*[st.floats(-5, 5)] * 3), st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_a_fan_turns_cables_and_keeps_their_lengths(cable, heading, elevation):
    cable = np.add(cable, (0, 0, 6))
    found = rotated(
        *(Vec3.from_array(jnp.asarray(cable)), jnp.asarray(heading), jnp.asarray(elevation))
    )
    found = np.asarray(found.to_array())
    length = np.linalg.norm(cable)
    assert np.linalg.norm(found) == pytest.approx(length)
    cosine = np.clip(found @ cable / length**2, -1, 1)
    assert np.arccos(cosine) <= abs(heading) + abs(elevation) + 1e-6


def test_a_base_driven_fan_turns_headings_alone():
    assert (offsets("base", 5, 0.1)[:, 1] == 0).all()
    assert len(np.unique(offsets("hybrid", 9, 0.1), axis=0)) == 9
    assert combinations(3, 4).shape == (81, 4)


# The hanging panel.


@pytest.fixture(scope="module")
def panel():
    scenario = js.load_scenario("hybrid")
    return scenario, np.linspace(scenario.task.start, scenario.task.goal, 40)


@pytest.fixture(scope="module")
def coordinated(panel):
    return moving_ends(*panel)


def contacts(scenario, way, ends):
    """Contacts of load and cables with ends (K, 3) or (n, K, 3) along a way."""
    rows = np.moveaxis(np.asarray(ends), -2, 0)
    bodies = build_world(scenario).bodies._replace(
        ends=Vec3(*(jnp.asarray(rows[..., i]) for i in range(3)))
    )
    position = Vec3(*(jnp.asarray(way[:, i]) for i in range(3)))
    return int(jax.jit(count_collisions)(position, bodies, build_world(scenario).obstacles))


def test_the_panel_blocks_the_given_ends_and_moving_ends_pass_it(panel, coordinated):
    scenario, way = panel
    assert contacts(scenario, way, [robot.end for robot in scenario.robots]) > 0
    assert coordinated.feasible, coordinated.reason
    assert contacts(scenario, way, coordinated.ends) == 0


def test_what_is_chosen_keeps_every_limit_and_balances(panel, coordinated):
    scenario, way = panel
    ends, tensions = coordinated.ends, coordinated.tensions
    vectors = ends - np.add(way, (0, 0, scenario.payload.height / 2))[:, None]
    lengths = np.linalg.norm(vectors, axis=-1)
    np.testing.assert_allclose(coordinated.lengths, lengths, rtol=1e-12)
    supplied = np.einsum("nki,nk->ni", vectors / lengths[..., None], tensions)
    np.testing.assert_allclose(supplied, np.tile([0, 0, 98.1], (40, 1)), atol=1e-9)
    assert 1 <= tensions.min() <= tensions.max() <= 100
    shoulders = np.array([np.add(robot.base, (0, 0, 4)) for robot in scenario.robots])
    distance = np.linalg.norm(ends - shoulders, axis=-1)
    assert 1 <= distance.min() <= distance.max() <= 5
    assert np.abs(np.diff(ends, axis=0)).max() < 0.5  # no jumps: transitions cost
    assert (coordinated.candidates > 300).all()


def test_in_cable_mode_it_chooses_ends_that_stay(panel):
    scenario, way = panel
    fixed = scenario.model_copy(update={"drive": "cable"})
    found = fixed_ends(fixed, way)
    assert found.feasible, found.reason
    assert np.ptp(found.ends, axis=0).max() == 0
    assert contacts(fixed, way, found.ends[0]) == 0


def test_a_way_without_candidates_says_at_which_step(panel):
    scenario, way = panel
    tense = scenario.limits.model_copy(update={"tension": (1.0, 30.0)})
    found = moving_ends(scenario.model_copy(update={"limits": tense}), way)
    assert not found.feasible
    assert found.reason.startswith("no joint candidate is in reach, apart, in tension and clear")


def test_bad_requests_are_refused(panel):
    scenario, way = panel
    cable = scenario.model_copy(update={"drive": "cable"})
    with pytest.raises(js.InputError, match="keeps the ends where they are"):
        moving_ends(cable, way)
    with pytest.raises(js.InputError, match='"hybrid" moves the ends; give "cable" to fix them'):
        fixed_ends(scenario, way)
    with pytest.raises(js.InputError, match="fan = 8: give a square number"):
        moving_ends(scenario, way, fan=8)
    with pytest.raises(js.InputError, match=r"fan = 49: .* give at most 27 candidates per cable"):
        moving_ends(scenario, way, fan=49)
    with pytest.raises(js.InputError, match="finite numbers"):
        moving_ends(scenario, way * np.nan)
    with pytest.raises(js.InputError, match='give drive = "cable", or attachments = "hook"'):
        moving_ends(js.load_scenario("rim").model_copy(update={"drive": "end"}), way)
