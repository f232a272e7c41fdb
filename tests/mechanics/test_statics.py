"""Tensions, structure matrix and wrench against closed forms and linear algebra."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import jaxsusp as js
from jaxsusp.mechanics.posture.load import Load, Pose, rotation
from jaxsusp.mechanics.posture.structure import structure_matrix, wrench

inside = st.tuples(st.floats(-2.5, 2.5), st.floats(-2.5, 2.5), st.floats(0.2, 5.5))


def system(scenario):
    ends = np.array([robot.end for robot in scenario.robots])
    hook = np.array([0, 0, scenario.payload.height / 2])
    return ends, hook


@given(position=inside)
@settings(deadline=None, max_examples=100)
def test_level_ends_give_barycentric_tensions(scenarios, position):
    """T_k = w_k m g l_k / (z_P - z_hook) with barycentric weights w."""
    ends, hook = system(scenarios[0])
    point = np.array(position) + hook
    weights = np.linalg.solve(np.vstack([ends[:, :2].T, np.ones(3)]), [*point[:2], 1])
    lengths = np.linalg.norm(ends - point, axis=1)
    expected = weights * 10 * 9.81 * lengths / (7 - point[2])
    np.testing.assert_allclose(js.tensions(scenarios[0], position), expected, rtol=1e-10, atol=1e-9)


@given(position=inside, acceleration=st.tuples(*[st.floats(-3, 3)] * 3))
@settings(deadline=None, max_examples=100)
def test_forces_balance_to_1e_9(scenarios, position, acceleration):
    ends, hook = system(scenarios[0])
    cables = ends - (np.array(position) + hook)
    units = cables / np.linalg.norm(cables, axis=1, keepdims=True)
    tensions = np.asarray(js.tensions(scenarios[0], position, acceleration))
    force = 10 * (np.array(acceleration) + np.array([0, 0, 9.81]))
    np.testing.assert_allclose(tensions @ units, force, atol=1e-9)


@given(angles=st.tuples(*[st.floats(-3, 3)] * 3))
@settings(deadline=None, max_examples=50)
def test_rotation_is_scipys_extrinsic_xyz(angles):
    expected = Rotation.from_euler("xyz", angles).as_matrix()
    np.testing.assert_allclose(rotation(jnp.asarray(angles)), expected, atol=1e-12)


@pytest.mark.fast
def test_structure_matrix_is_the_gradient_of_the_cable_lengths():
    """Virtual work: -dl_k/dH = u_k, and -dl_k/dθ = (R B'_k) × u_k."""
    rng = np.random.default_rng(0)
    position, attachments = rng.normal(size=3), rng.normal(scale=0.2, size=(4, 3))
    ends = rng.normal(size=(4, 3)) + np.array([0, 0, 6])
    posture = np.asarray(rotation(jnp.asarray([0.1, -0.2, 0.3])))

    def lengths(shift, turn):
        small = Rotation.from_rotvec(turn).as_matrix() @ posture
        return np.linalg.norm(ends - attachments @ small.T - position - shift, axis=1)

    h = 1e-6
    gradient = [
        (lengths(*(-h * e).reshape(2, 3)) - lengths(*(h * e).reshape(2, 3))) / (2 * h)
        for e in np.eye(6)
    ]
    nothing = np.zeros(3)
    load = Load(*map(jnp.asarray, (1.0, nothing, nothing, attachments)))
    pose = Pose(jnp.asarray(position), jnp.asarray(posture))
    matrix = structure_matrix(pose, load, jnp.asarray(ends))
    np.testing.assert_allclose(matrix, gradient, atol=1e-8)


@pytest.mark.fast
def test_wrench_holds_weight_and_inertia():
    found = wrench(
        jnp.asarray(10.0), jnp.asarray([1.0, 2.0, 3.0]), jnp.asarray([0.1, 0.2, 0.3]), jnp.ones(3)
    )
    np.testing.assert_allclose(found, [1, 2, 101.1, 1, 2, 3])


def test_a_hook_leaves_a_moment_only_under_horizontal_acceleration(scenarios):
    """10 kg at 1 m/s² sideways, 0.15 m below the hook."""
    place, upwards, sideways = [0.0, 0.0, 2.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]
    np.testing.assert_allclose(js.equilibrium(scenarios[0], place, upwards).moment, 0, atol=1e-12)
    found = js.equilibrium(scenarios[0], place, sideways).moment
    np.testing.assert_allclose(found, 1.5, atol=1e-12)


def test_tensions_are_batched_and_follow_the_dtype(scenarios):
    positions = np.random.default_rng(0).uniform(-1, 1, (4, 5, 3)) + np.array([0, 0, 2])
    batched = js.tensions(scenarios[0], positions)
    assert batched.shape == (4, 5, 3)
    assert batched.dtype == np.float64
    np.testing.assert_allclose(
        batched[2, 3], js.tensions(scenarios[0], positions[2, 3]), rtol=1e-12
    )
    single = js.tensions(scenarios[0], jnp.asarray(positions, jnp.float32))
    assert single.dtype == jnp.float32
    np.testing.assert_allclose(single, batched, rtol=1e-4, atol=1e-4)


def test_tensions_are_float64_without_the_global_setting(scenarios):
    with jax.enable_x64(False):
        assert js.tensions(scenarios[0], [0.0, 0.0, 2.0]).dtype == np.float64
