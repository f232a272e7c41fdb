"""The room of a load that may tilt, and how far it turns."""

import jax
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import jaxsusp as js
from jaxsusp.mechanics.posture.tilting import attachment_motion, warning_half_extents
from jaxsusp.problem.fitness import trajectory
from jaxsusp.scenario.world import build_world, warning_shape
from jaxsusp.suspension.levelload import tensions_at, turn_at
from jaxsusp.vec3 import Vec3


@pytest.mark.fast
def test_the_benchmark_cylinder_tilted_by_ten_degrees():
    assert warning_half_extents(0.1, 0.3, np.deg2rad(10)) == pytest.approx((0.125, 0.165), abs=5e-4)
    assert warning_half_extents(0.1, 0.3, 0.0) == pytest.approx((0.1, 0.15))


@given(st.floats(0.01, 2), st.floats(0.01, 2), st.floats(0, np.pi), st.integers(0, 2**32 - 1))
def test_no_point_of_a_tilted_cylinder_leaves_the_grown_one(radius, height, limit, seed):
    rng = np.random.default_rng(seed)
    wide, high = warning_half_extents(radius, height, limit)
    azimuth = np.linspace(0, 2 * np.pi, 721)
    rim = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), 0 * azimuth], axis=1)
    up = np.array([0, 0, height / 2])
    points = np.vstack([rim + up, rim - up])
    tilts = np.linspace(0, limit, 25)
    axis = rng.normal(size=3) * [1, 1, 0]
    axis /= np.linalg.norm(axis)
    turned = np.array([Rotation.from_rotvec(t * axis).apply(points) for t in tilts])
    across, top = np.linalg.norm(turned[..., :2], axis=-1).max(), np.abs(turned[..., 2]).max()
    assert across <= wide * (1 + 1e-9)
    assert top <= high * (1 + 1e-9)
    # And it is no larger than it must be, but for the coarseness of the tilts tried.
    slack = (radius + height / 2) * limit / 20
    assert wide <= across + slack + 1e-9
    assert high <= top + slack + 1e-9


@given(st.floats(0, np.pi), st.integers(0, 2**32 - 1))
def test_a_turn_moves_an_attachment_by_no_more_than_stated(turn, seed):
    rng = np.random.default_rng(seed)
    point, axis = rng.normal(size=3), rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    moved = Rotation.from_rotvec(turn * axis).apply(point) - point
    assert np.linalg.norm(moved) <= attachment_motion(np.linalg.norm(point), turn) + 1e-12


@pytest.mark.fast
def test_a_hook_and_moving_ends_need_no_extra_room():
    assert warning_shape(js.load_scenario("scenario-1")) == (0.1, 0.15, 0.01)
    rim = js.load_scenario("rim")
    wide, high, cable = warning_shape(rim)
    assert (wide, high) == pytest.approx((0.125, 0.165), abs=5e-4)
    assert cable == pytest.approx(0.01 + 2 * np.hypot(0.1, 0.15) * np.sin(np.deg2rad(5)), abs=1e-4)
    bodies = build_world(rim).bodies
    assert (bodies.radius, bodies.half_height, bodies.cable_radius) == (wide, high, cable)


def test_the_estimate_of_searches_is_close_to_the_equilibrium_and_never_low():
    scenario = js.load_scenario("rim")
    world = build_world(scenario)
    rng = np.random.default_rng(0)
    place = rng.uniform([-1.6, -1.6, 0.3], [1.6, 1.6, 4.0], (400, 3))
    exact = js.equilibrium(scenario, place)

    @jax.jit
    def estimate(world, where):
        tensions = tensions_at(world, where)[1]
        return tensions, turn_at(world, where, tensions)

    tensions, turn = estimate(world, Vec3(*place.T))
    excess = np.rad2deg(np.asarray(turn) - np.asarray(exact.turn))
    near = np.asarray(exact.balanced) & (np.rad2deg(exact.turn) < 10)
    assert near.sum() > 100
    assert excess[near].min() >= 0
    assert excess[near].max() < 0.35
    ratio = np.stack(tensions, axis=-1)[near] / np.asarray(exact.tensions)[near]
    assert np.abs(ratio - 1).max() < 0.03


def test_a_search_counts_samples_at_which_the_load_turns_too_far():
    scenario = js.load_scenario("rim")
    terms = jax.jit(lambda suspension, x: suspension.terms(x))
    problem = js.Problem.from_scenario(scenario, samples=9, search="box")
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1].ravel()
    assert int(terms(problem.fitness, line).violations) == 0
    tight = scenario.limits.model_copy(update={"posture_deg": 3.0})
    narrow = scenario.model_copy(update={"limits": tight})
    problem = js.Problem.from_scenario(narrow, samples=9, search="box")
    where = jax.jit(trajectory, static_argnums=2)(build_world(narrow), line, 9)
    turned = np.rad2deg(js.equilibrium(narrow, np.stack(where, axis=-1)).turn) > 3.0
    assert 0 < turned.sum() < 9
    assert int(terms(problem.fitness, line).violations) == turned.sum()
