"""Least variance against brute force, and a way on which only moving ends keep cables clear."""

from itertools import product

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plans import EXAMPLES
from scipy.interpolate import make_interp_spline

import jaxsusp as js
from jaxsusp.coordination import leastvariance
from jaxsusp.coordination.fans import combinations, offsets, rotated
from jaxsusp.coordination.sequence import best_constant, best_sequence, spread_of, step_costs
from jaxsusp.coordination.smoothing import WIDTHS, running_means
from jaxsusp.geometry.collisions import count_between, count_collisions
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.scenario.world import build_world
from jaxsusp.trajectory.makima import makima
from jaxsusp.vec3 import Vec3

SAMPLES, KEPT, Q = 5, 4, 6
solve = jax.jit(best_sequence)
turn = jax.jit(rotated)


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
    chosen, found = solve(features, cost)
    assert float(found) == pytest.approx(least, rel=1e-12)
    if np.isfinite(least):
        assert total(np.asarray(chosen)) == pytest.approx(least, rel=1e-12)


@jax.jit
def costs(features, feasible):
    return step_costs(features, feasible, spread_of(features, feasible))


def test_the_cost_of_a_step_is_its_share_of_the_sample_variance():
    """Summed over all candidates of a step it is the variance of Eq. 20, summed over q."""
    rng = np.random.default_rng(0)
    features, feasible = rng.normal(size=(3, 8, Q)), rng.uniform(size=(3, 8)) < 0.6
    cost = np.asarray(costs(features, feasible))
    for step in range(3):
        expected = features[step][feasible[step]].var(axis=0, ddof=1).sum()
        assert cost[step][feasible[step]].sum() == pytest.approx(expected)
        assert np.isinf(cost[step][~feasible[step]]).all()


def test_one_candidate_alone_costs_nothing_and_none_costs_everything():
    features = np.ones((SAMPLES, KEPT, Q))
    alone = np.zeros((SAMPLES, KEPT), bool)
    alone[:-1, 1] = True
    cost = np.asarray(costs(features, alone))
    assert (cost[:-1, 1] == 0).all()
    assert np.isinf(cost[-1]).all()
    assert np.isinf(float(solve(features, cost)[1]))


def test_the_best_constant_choice_is_the_best_of_all_constant_choices():
    rng = np.random.default_rng(3)
    features, feasible = rng.normal(size=(4, 9, Q)), rng.uniform(size=(4, 9)) < 0.9
    always = feasible.all(axis=0)
    assert 1 < always.sum() < 9
    best, total = jax.jit(best_constant)(features, feasible)
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
    found = np.stack(turn(Vec3(*cable), heading, elevation))
    length = np.linalg.norm(cable)
    assert np.linalg.norm(found) == pytest.approx(length)
    cosine = np.clip(found @ cable / length**2, -1, 1)
    assert np.arccos(cosine) <= abs(heading) + abs(elevation) + 1e-6


@pytest.mark.fast
def test_a_base_driven_fan_turns_headings_alone():
    assert (offsets("base", 5, 0.1)[:, 1] == 0).all()
    assert len(np.unique(offsets("hybrid", 9, 0.1), axis=0)) == 9
    assert combinations(3, 4).shape == (81, 4)


@pytest.mark.fast
@pytest.mark.parametrize(("drive", "fan"), [("base", 7), ("hybrid", 9), ("end", 25), ("end", 1)])
def test_the_middle_joint_candidate_is_what_the_fan_opens_around(drive, fan):
    middle = combinations(fan, 3)[fan**3 // 2]
    assert (offsets(drive, fan, 0.3)[middle] == 0).all()
    assert np.abs(offsets(drive, fan, 0.3)).max() == (0.3 if fan > 1 else 0)


@pytest.mark.fast
def test_running_means_average_and_the_last_changes_nothing():
    means = running_means(12)
    assert (means >= 0).all()
    np.testing.assert_allclose(means.sum(axis=-1), 1)
    assert (means[-1] == np.eye(12)).all()
    assert WIDTHS[-1] == 0
    kinked = np.abs(np.arange(12) - 6.0)
    rough = [np.abs(np.diff(mean @ kinked, 2)).max() for mean in means]
    assert (np.diff(rough) > 0).all()  # the wider the smoother


# Every drive mode, along a way of its example.


def smooth_way(scenario, waypoints):
    rows = np.array([scenario.task.start, *waypoints, scenario.task.goal])
    return np.stack([np.asarray(makima(jnp.asarray(axis), 40)) for axis in rows.T], axis=1)


@pytest.fixture(scope="module", params=["end-driven", "base-driven", "hybrid"])
def driven(request):
    scenario = js.load_scenario(request.param)
    way = smooth_way(scenario, EXAMPLES[request.param])
    return scenario, way, js.moving_ends(scenario, way)


def cables(scenario, way, ends):
    return ends - np.add(way, (0, 0, scenario.payload.height / 2))[:, None]


def test_a_drive_mode_keeps_what_it_says_at_every_step(driven):
    scenario, way, found = driven
    assert found.feasible, found.reason
    lengths = np.linalg.norm(cables(scenario, way, found.ends), axis=-1)
    np.testing.assert_allclose(found.lengths, lengths, rtol=1e-13)
    given_ends = np.array([robot.end for robot in scenario.robots])
    if scenario.drive == "hybrid":
        assert np.ptp(lengths, axis=0).min() > 0.1
        return
    start = np.linalg.norm(cables(scenario, way[:1], given_ends[None]), axis=-1)
    np.testing.assert_allclose(lengths, np.broadcast_to(start, lengths.shape), rtol=1e-13)
    if scenario.drive == "base":
        heights = np.broadcast_to(given_ends[:, 2], lengths.shape)
        np.testing.assert_allclose(found.ends[..., 2], heights, rtol=1e-13)


def test_what_is_chosen_keeps_every_limit_and_balances(driven):
    scenario, way, found = driven
    vectors = cables(scenario, way, found.ends)
    pulls = vectors * (found.tensions / found.lengths)[..., None]
    np.testing.assert_allclose(pulls.sum(axis=1), np.tile([0, 0, 98.1], (40, 1)), atol=1e-9)
    assert 1 <= found.tensions.min() <= found.tensions.max() <= 100
    assert contacts(scenario, way, found.ends) == 0
    apart = [np.linalg.norm(found.ends[:, j] - found.ends[:, k], axis=-1) for j, k in PAIRS]
    assert np.min(apart) >= scenario.limits.separation
    if scenario.drive != "base":
        shoulders = np.array([np.add(robot.base, (0, 0, 4)) for robot in scenario.robots])
        distance = np.linalg.norm(found.ends - shoulders, axis=-1)
        assert 1 <= distance.min() <= distance.max() <= 5
    assert np.rad2deg(np.abs(found.angles).max()) <= 10 + 1e-9


PAIRS = ((0, 1), (0, 2), (1, 2))


def test_no_pass_raises_the_cost_and_narrower_fans_lower_it(driven):
    costs = driven[2].costs
    assert costs.shape == (8,)
    assert (np.diff(costs) <= 1e-12).all()
    assert costs[-1] < 0.95 * costs[0]


def test_the_ends_turn_smoothly(driven):
    """What they turn by beside the plain rule: one pass alone jumps by whole steps of 10°."""
    _, _, found = driven
    assert np.rad2deg(np.abs(np.diff(found.angles, 2, axis=1)).max()) < 0.3
    assert found.smoothing == WIDTHS[0]


def test_a_spline_through_the_ends_keeps_the_lengths_between_the_steps(driven):
    scenario, way, found = driven
    if scenario.drive == "hybrid":
        return
    steps, between = np.arange(40), np.linspace(0, 39, 39 * 20 + 1)
    natural = ([(3, np.zeros(3)), (4, np.zeros(3))],) * 2
    curve = make_interp_spline(steps, way, k=5, bc_type=natural)(between)
    ends = [make_interp_spline(steps, row, k=5, bc_type=natural)(between)
            for row in found.ends.transpose(1, 0, 2)]  # fmt: skip
    lengths = np.linalg.norm(cables(scenario, curve, np.stack(ends, axis=1)), axis=-1)
    assert np.abs(lengths - found.lengths[0]).max() < 1e-4
    if scenario.drive == "base":
        assert np.ptp(ends, axis=1)[:, 2].max() < 1e-9


# The panel and the wall.


@pytest.fixture(scope="module")
def straight():
    scenario = js.load_scenario("hybrid")
    return scenario, np.linspace(scenario.task.start, scenario.task.goal, 40)


@pytest.fixture(scope="module")
def coordinated(straight):
    return js.moving_ends(*straight)


COUNTS = (4, 2, 2)
"""Places for obstacles of every kind, so that all scenarios here share programs."""


def contacts(scenario, way, ends, count=count_between):
    """Contacts of load and cables with ends (K, 3) or (n, K, 3) along a way of n points."""
    world = build_world(scenario, COUNTS)
    rows = np.moveaxis(np.broadcast_to(ends, (len(way), *np.shape(ends)[-2:])), -2, 0)
    bodies = world.bodies._replace(ends=Vec3(*np.moveaxis(rows, -1, 0)))
    return int(jax.jit(count)(Vec3(*way.T), bodies, world.obstacles))


def pieces(rows, parts):
    """A polyline cut further: the same motion."""
    at, steps = np.linspace(0, len(rows) - 1, parts * (len(rows) - 1) + 1), np.arange(len(rows))
    flat = rows.reshape(len(rows), -1)
    return np.stack([np.interp(at, steps, c) for c in flat.T], axis=1).reshape(-1, *rows.shape[1:])


def test_moving_ends_pass_what_blocks_the_given_ones(straight, coordinated):
    scenario, way = straight
    given_ends = np.array([robot.end for robot in scenario.robots])
    assert contacts(scenario, way, given_ends) > 0
    assert coordinated.feasible, coordinated.reason
    assert contacts(scenario, way, coordinated.ends) == 0
    fine, ends = pieces(way, 40), pieces(coordinated.ends, 40)
    assert contacts(scenario, fine, ends, count_collisions) == 0
    assert np.linalg.norm(np.diff(coordinated.ends, 2, axis=0), axis=-1).max() < 0.04


def blocked(scenario, way, ends, parts=4):
    """How many places of the way each end of robot 1 is blocked at, whatever the others do."""
    hook = np.add(pieces(way, parts), (0, 0, scenario.payload.height / 2))
    world = build_world(scenario, COUNTS)
    thick = world.bodies.cable_radius + world.bodies.clearance
    lower, upper = Vec3(*hook.T[:, :, None]), Vec3(*ends.T[:, None])
    clear = jax.jit(segments_clear)(lower, upper, thick, world.obstacles)
    return (~np.asarray(clear)).sum(axis=0)


def test_no_end_in_reach_of_the_first_robot_can_stay_where_it_is(straight):
    scenario, way = straight
    robot = scenario.robots[0]
    shoulder, reach = np.add(robot.base, (0, 0, robot.links[0])), sum(robot.links[1:])
    steps = np.arange(-reach, reach + 0.1, 0.25)
    grid = shoulder + np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)
    grid = grid[np.linalg.norm(grid - shoulder, axis=-1) <= reach]
    assert len(grid) > 30_000
    assert blocked(scenario, way, grid).min() >= 5  # of 157 places
    for k in range(2):  # either obstacle alone leaves many
        alone = scenario.model_copy(update={"obstacles": scenario.obstacles[k : k + 1]})
        assert (blocked(alone, way, grid) == 0).mean() > 0.1


def test_fixed_ends_find_none_even_in_wide_fans(straight):
    scenario, way = straight
    fixed = scenario.model_copy(update={"drive": "cable"})
    for fan, angle in ((9, 10.0), (25, 18.0)):  # at every step there are many, but never the same
        found = js.fixed_ends(fixed, way, fan, angle)
        assert not found.feasible
        assert found.reason == "no single joint candidate serves all steps"
        assert found.candidates.min() > 100
    assert not js.fixed_ends(fixed, way, 25, 30.0).feasible


def test_in_cable_mode_it_chooses_ends_that_stay(straight):
    scenario, way = straight
    panel = scenario.obstacles[:1] * 2  # as many obstacles as above: the same program
    fixed = scenario.model_copy(update={"drive": "cable", "obstacles": panel})
    given_ends = np.array([robot.end for robot in fixed.robots])
    assert contacts(fixed, way, given_ends) > 0
    found = js.fixed_ends(fixed, way, margin=0.03)
    assert found.feasible, found.reason
    assert np.ptp(found.ends, axis=0).max() == 0
    wider = fixed.limits.model_copy(update={"cable_radius": fixed.limits.cable_radius + 0.03})
    thick = fixed.model_copy(update={"limits": wider})
    assert contacts(thick, way, found.ends[0], count_collisions) == 0


def test_a_margin_is_kept_at_and_between_the_steps(straight, monkeypatch):
    scenario, way = straight
    monkeypatch.setattr(leastvariance, "SLACKS", (0.05,))  # what is chosen of all that are tried
    found = js.moving_ends(scenario, way, margin=0.015)
    assert found.feasible, found.reason
    limits = scenario.limits.model_copy(update={"cable_radius": 0.025})
    thick = scenario.model_copy(update={"limits": limits})
    assert contacts(thick, way, found.ends) == 0


def test_a_way_without_candidates_says_at_which_step(straight):
    scenario, way = straight
    tense = scenario.limits.model_copy(update={"tension": (1.0, 30.0)})
    found = js.moving_ends(scenario.model_copy(update={"limits": tense}), way)
    assert not found.feasible
    assert found.reason.startswith("no joint candidate is in reach, apart, in tension and clear")


def test_a_load_in_the_way_is_told_apart_from_cables(straight):
    scenario, way = straight
    found = js.moving_ends(scenario, way + np.sin(np.linspace(0, np.pi, 40))[:, None] * [0, 1, 0])
    assert not found.feasible
    assert found.reason.startswith("the load itself meets an obstacle")


def test_bad_requests_are_refused(straight):
    scenario, way = straight
    cable = scenario.model_copy(update={"drive": "cable"})
    with pytest.raises(js.InputError, match="keeps the ends where they are"):
        js.moving_ends(cable, way)
    with pytest.raises(js.InputError, match='"hybrid" moves the ends; give "cable" to fix them'):
        js.fixed_ends(scenario, way)
    for fan in (4, 8):
        with pytest.raises(js.InputError, match=f"fan = {fan}: give an odd square number"):
            js.moving_ends(scenario, way, fan=fan)
    with pytest.raises(js.InputError, match=r"fan = 49: .* give at most 25 candidates per cable"):
        js.moving_ends(scenario, way, fan=49)
    with pytest.raises(js.InputError, match="fan = 4: give an odd number, such as 9"):
        js.moving_ends(js.load_scenario("base-driven"), way, fan=4)
    with pytest.raises(js.InputError, match="finite numbers"):
        js.moving_ends(scenario, way * np.nan)
    with pytest.raises(js.InputError, match="is no array of numbers"):
        js.moving_ends(scenario, [[0, 0, 1], [1, 2]])
    with pytest.raises(js.InputError, match=r"margin = -0\.1: give a finite number"):
        js.moving_ends(scenario, way, margin=-0.1)
    with pytest.raises(js.InputError, match="angle_deg = 0: give degrees"):
        js.moving_ends(scenario, way, angle_deg=0.0)
    with pytest.raises(js.InputError, match="fans of ends are for cables that meet at a hook"):
        js.moving_ends(js.load_scenario("rim").model_copy(update={"drive": "end"}), way)
