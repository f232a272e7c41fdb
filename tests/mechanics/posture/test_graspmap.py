"""Internal forces of movable ends, and the rank claims about J and the grasp map."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from suspensions import load_of

from jaxsusp.mechanics.posture.graspmap import (
    ends_of_forces,
    grasp_map,
    internal_forces,
    nearest_forces,
    rank,
)
from jaxsusp.mechanics.posture.load import Pose, cables_at
from jaxsusp.mechanics.posture.structure import imbalance, structure_matrix

RIM = np.array([[0.2, 0, 0.15], [-0.1, 0.17, 0.15], [-0.1, -0.17, 0.1]])
FOUR = np.vstack([RIM, [0.05, 0.1, -0.1]])
LINE = np.array([[0.2, 0.1, 0.1], [0, 0, 0], [-0.4, -0.2, -0.2]])
HOOK = np.tile([0, 0, 0.15], (3, 1))


def some_pose(seed=0) -> Pose:
    turn = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
    return Pose(jnp.asarray([0.3, -0.2, 1.5]), jnp.asarray(turn))


@pytest.mark.parametrize(
    ("attachments", "expected"), [(RIM, 6), (FOUR, 6), (LINE, 5), (HOOK, 3), (0 * HOOK, 3)]
)
def test_the_rank_of_the_grasp_map_and_what_is_left_over(attachments, expected):
    load, pose = load_of(attachments, center_of_mass=(0.01, 0.02, -0.05)), some_pose()
    matrix = grasp_map(pose, load)
    assert rank(attachments) == expected == np.linalg.matrix_rank(matrix, tol=1e-9)
    internal = internal_forces(pose, load, expected)
    assert internal.shape == (3 * len(attachments), 3 * len(attachments) - expected)
    np.testing.assert_allclose(matrix @ internal, 0, atol=1e-12)
    np.testing.assert_allclose(internal.T @ internal, np.eye(internal.shape[1]), atol=1e-12)


@pytest.mark.fast
def test_three_fixed_cables_leave_no_internal_tension():
    """J is 6×3 of rank 3: N(J) = {0}, and J⁺ = Jᵀ(JJᵀ)⁻¹ as printed in Eq. 7 does not exist."""
    rng = np.random.default_rng(0)
    for attachments in (RIM, LINE, HOOK):
        ends = jnp.asarray(rng.normal((0, 0, 7), 2, (3, 3)))
        matrix = np.asarray(structure_matrix(some_pose(), load_of(attachments), ends))
        assert matrix.shape == (6, 3)
        assert np.linalg.matrix_rank(matrix) == 3
        assert np.linalg.matrix_rank(matrix @ matrix.T) == 3  # 6×6: singular


def test_any_pose_balances_with_movable_ends_and_any_internal_forces():
    rng = np.random.default_rng(1)
    for seed, attachments in enumerate([RIM, FOUR, RIM]):
        load, pose = load_of(attachments, gravity=(0.3, -0.2, -9.7)), some_pose(seed)
        count = len(attachments)
        wished = jnp.asarray(rng.normal((0, 0, 40), 20, (count, 3)))
        forces = nearest_forces(wished, pose, load)
        internal = internal_forces(pose, load, 6)
        forces = forces + (internal @ rng.normal(size=internal.shape[1])).reshape(count, 3)
        lengths = jnp.asarray(rng.uniform(2, 6, count))
        ends, tensions = ends_of_forces(forces, lengths, pose, load)
        np.testing.assert_allclose(imbalance(pose, tensions, load, ends), 0, atol=1e-9)
        np.testing.assert_allclose(cables_at(pose, load, ends)[1], lengths, rtol=1e-12)


@pytest.mark.fast
def test_the_forces_nearest_to_a_wish_keep_its_internal_part():
    load, pose = load_of(RIM), some_pose()
    wished = jnp.asarray(np.random.default_rng(0).normal(scale=30, size=(3, 3)))
    found = nearest_forces(wished, pose, load)
    internal = internal_forces(pose, load, 6)
    kept = internal.T @ (found - wished).reshape(-1)
    np.testing.assert_allclose(kept, 0, atol=1e-9)
    np.testing.assert_allclose(nearest_forces(found, pose, load), found, atol=1e-9)
