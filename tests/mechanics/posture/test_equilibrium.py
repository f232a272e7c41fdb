"""Equilibria of separate attachments against balance, published poses and the potential energy."""

import functools
import os
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from suspensions import hang_all, load_of, settle_all, stiffness_all

import jaxsusp as js
from jaxsusp.mechanics.posture.equilibrium import CONVERGED
from jaxsusp.mechanics.posture.load import Pose, angles, cables_at, tilt
from jaxsusp.mechanics.posture.potential import energy, stiffness
from jaxsusp.mechanics.posture.pseudoinverse import bounded_least_squares, least_squares_tensions
from jaxsusp.mechanics.posture.redundant import hang_within
from jaxsusp.mechanics.posture.structure import structure_matrix
from jaxsusp.suspension.hanging import hanging_trouble

moved = jax.jit(jax.vmap(Pose.moved))


def wrench_by_hand(pose, tensions, load, ends):
    """Force and moment about the centre of mass of cables and weight, written out in numpy."""
    R, p = np.asarray(pose.posture), np.asarray(pose.position)
    force, moment = np.asarray(load.mass * load.gravity).copy(), np.zeros(3)
    for attachment, end, tension in zip(load.attachments, ends, tensions, strict=True):
        arm = R @ np.asarray(attachment - load.center_of_mass)
        lower = p + R @ np.asarray(attachment)
        pull = float(tension) * (end - lower) / np.linalg.norm(end - lower)
        force, moment = force + pull, moment + np.cross(arm, pull)
    return force, moment


def test_every_random_pose_balances_to_1e_9(hung):
    assert (hung.found.code == CONVERGED).all()
    for i in range(0, 200, 7):
        force, moment = wrench_by_hand(
            hung.pose(i), hung.found.tensions[i], hung.load, np.asarray(hung.ends[i])
        )
        assert np.abs(force).max() < 1e-9
        assert np.abs(moment).max() < 1e-9
    assert np.asarray(hung.found.force).max() < 1e-9
    R = np.asarray(hung.found.pose.posture)
    np.testing.assert_allclose(
        R @ R.transpose(0, 2, 1), np.tile(np.eye(3), (200, 1, 1)), atol=1e-12
    )


def test_lengths_lead_back_to_the_pose_from_a_perturbed_start(hung):
    rng = np.random.default_rng(1)
    shift, turn = (jnp.asarray(rng.normal(scale=0.1, size=(200, 3))) for _ in range(2))
    start = moved(hung.found.pose, shift, turn)
    again = settle_all(hung.found.lengths, start, hung.load, hung.ends)
    gap = np.abs(again.pose.position - hung.found.pose.position).max(axis=1)
    turned = np.abs(again.pose.posture - hung.found.pose.posture).max(axis=(1, 2))
    assert (again.code == CONVERGED).all()
    np.testing.assert_allclose(again.lengths, hung.found.lengths, atol=1e-9)
    # Lengths may have several poses: nearly all starts lead back to theirs.
    back = (gap < 1e-6) & (turned < 1e-6)
    assert back.mean() > 0.98
    np.testing.assert_allclose(again.tensions[back], hung.found.tensions[back], atol=1e-6)


def test_a_level_symmetric_pose_is_the_hook_s(scenarios):
    """Straight below the middle nothing turns the load, and each cable holds a third."""
    azimuth = np.deg2rad([90, 210, 330])
    rim = np.stack([0.1 * np.cos(azimuth), 0.1 * np.sin(azimuth), np.full(3, 0.15)], axis=1)
    ends = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), np.full(3, 7.0)], axis=1)
    start = jnp.asarray(Rotation.from_euler("xyz", [0.2, -0.1, 0.1]).as_matrix())
    found = hang_all(jnp.asarray([[0, 0, 2.0]]), start[None], load_of(rim), jnp.asarray(ends)[None])
    np.testing.assert_allclose(found.pose.posture[0], np.eye(3), atol=1e-9)
    rise, out = 7 - 2.15, 5.9
    np.testing.assert_allclose(found.tensions[0], 98.1 / 3 * np.hypot(rise, out) / rise, atol=1e-8)


# The published equilibria of a laboratory platform.


class Published:
    def __init__(self, file: Path):
        rows = np.genfromtxt(file, delimiter=",", skip_header=5)
        assert rows.shape == (12, 24)
        self.position = jnp.asarray(rows[:, :3])
        self.posture = jnp.asarray(rows[:, 3:12].reshape(12, 3, 3))
        self.ends = jnp.asarray(rows[:, 12:21].reshape(12, 3, 3))
        self.tensions = rows[:, 21:]
        self.load = load_of(
            np.array(
                [
                    (-0.150426136072068, -0.236638780074145, 0.261684766873677),
                    (0.258285334330924, -0.00157568669576209, 0.26144660743489),
                    (-0.15068853868202, 0.238102702737854, 0.261410712475964),
                ]
            ),
            mass=8.0064,
            gravity=(0.06927058, -0.15351662, -9.80520364),
            center_of_mass=(-0.0142539991, -0.0017234921, 0.1732544608),
        )

    def perturbed(self) -> Pose:
        rng = np.random.default_rng(0)
        shift, turn = (jnp.asarray(rng.normal(scale=s, size=(12, 3))) for s in (0.1, 0.15))
        return moved(Pose(self.position, self.posture), shift, turn)


@pytest.fixture(scope="module")
def published() -> Published:
    folder = os.environ.get("JAXSUSP_REFERENCE_DATA")
    if not folder:
        pytest.skip("JAXSUSP_REFERENCE_DATA names no folder of reference data")
    return Published(Path(folder) / "grab_equilibria.csv")


def test_published_tensions_are_those_of_the_given_poses(published):
    found = jax.vmap(least_squares_tensions, in_axes=(0, None, 0))(
        Pose(published.position, published.posture), published.load, published.ends
    )
    np.testing.assert_allclose(found.tensions, published.tensions, atol=1e-4)
    assert np.asarray(found.moment).max() < 1e-6


@pytest.mark.parametrize("start", ["level", "perturbed"])
def test_published_postures_are_found_from_their_positions(published, start):
    level = jnp.broadcast_to(jnp.eye(3), (12, 3, 3))
    posture = level if start == "level" else published.perturbed().posture
    found = hang_all(published.position, posture, published.load, published.ends)
    np.testing.assert_allclose(found.pose.posture, published.posture, atol=1e-6)
    np.testing.assert_allclose(found.tensions, published.tensions, atol=1e-4)


def test_published_poses_are_found_from_their_lengths(published):
    poses = Pose(published.position, published.posture)
    _, lengths = jax.vmap(cables_at, in_axes=(0, None, 0))(poses, published.load, published.ends)
    found = settle_all(lengths, published.perturbed(), published.load, published.ends)
    np.testing.assert_allclose(found.pose.position, published.position, atol=1e-6)
    np.testing.assert_allclose(found.pose.posture, published.posture, atol=1e-6)
    np.testing.assert_allclose(found.tensions, published.tensions, atol=1e-4)


def test_published_equilibria_are_stable(published):
    poses = Pose(published.position, published.posture)
    modes = stiffness_all(poses, jnp.asarray(published.tensions), published.load, published.ends)
    assert np.asarray(modes).min() > 0


# Stability.


def constrained_energy(pose, load, ends, lengths):
    """Energy as a function of three of the pose's freedoms, the cables kept at their lengths.

    For a small turn the position follows from the lengths by Newton's method, in numpy.
    """
    ends, B = np.asarray(ends), np.asarray(load.attachments)

    def at(turn):
        R = Rotation.from_rotvec(turn).as_matrix() @ np.asarray(pose.posture)
        p = np.asarray(pose.position)
        for _ in range(20):
            vectors = ends - p - B @ R.T
            found = np.linalg.norm(vectors, axis=1)
            p = p - np.linalg.solve(-vectors / found[:, None], found - lengths)
        return float(energy(Pose(jnp.asarray(p), jnp.asarray(R)), load))

    return at


def curvatures(at, h=2e-3):
    """Eigenvalues of the Hessian of `at` by central differences."""
    e = h * np.eye(3)
    hessian = [
        [
            (at(e[i] + e[j]) - at(e[i] - e[j]) - at(e[j] - e[i]) + at(-e[i] - e[j])) / (4 * h * h)
            for j in range(3)
        ]
        for i in range(3)
    ]
    return np.linalg.eigvalsh(hessian)


def unstable_equilibria():
    """A load carried above its attachments: balanced, and ready to topple."""
    azimuth = np.deg2rad([90, 210, 330])
    low = np.stack([0.2 * np.cos(azimuth), 0.2 * np.sin(azimuth), np.full(3, -0.3)], axis=1)
    ends = np.stack([4 * np.cos(azimuth), 4 * np.sin(azimuth), np.full(3, 7.0)], axis=1)
    load = load_of(low)
    place = jnp.asarray([[0, 0, 1.0], [0.3, 0.1, 2.0], [-0.2, 0.2, 3.0]])
    ends = jnp.asarray(np.tile(ends, (3, 1, 1)))
    return load, ends, hang_all(place, jnp.broadcast_to(jnp.eye(3), (3, 3, 3)), load, ends)


def test_stability_agrees_with_finite_differences_of_the_energy(hung):
    load, ends, found = unstable_equilibria()
    unstable = stiffness_all(found.pose, found.tensions, load, ends)
    cases = [(hung.load, hung.ends, hung.found, hung.modes, i) for i in range(0, 200, 20)]
    cases += [(load, ends, found, unstable, i) for i in range(3)]
    verdicts = []
    for load, ends, found, all_modes, i in cases:
        pose, modes = jax.tree.map(lambda leaf, i=i: leaf[i], (found.pose, all_modes))
        assert int(found.code[i]) == CONVERGED
        at = constrained_energy(pose, load, ends[i], found.lengths[i])
        expected = curvatures(at)
        h = 1e-4  # stationary: the energy does not rise to first order
        slope = [(at(h * e) - at(-h * e)) / (2 * h) for e in np.eye(3)]
        np.testing.assert_allclose(slope, 0, atol=1e-4)
        # Same inertia (Sylvester): the freedoms are parametrised otherwise.
        np.testing.assert_array_equal(np.sign(modes), np.sign(expected))
        verdicts.append(bool((modes > 0).all()))
    assert 0 < sum(verdicts) < len(verdicts)


def test_a_stable_equilibrium_is_a_minimum_of_the_energy(hung):
    """scipy, sent off downhill on the constraint set, comes back."""
    for i in np.flatnonzero(hung.stable)[:3]:
        at = constrained_energy(hung.pose(i), hung.load, hung.ends[i], hung.found.lengths[i])
        found = minimize(at, [0.05, -0.04, 0.06], method="BFGS", options={"gtol": 1e-7})
        np.testing.assert_allclose(found.x, 0, atol=1e-4)


def test_a_hook_swings_like_a_pendulum_and_yaw_is_no_mode():
    """Both modes have the pendulum's stiffness m g h; below the centre of mass it is negative."""
    ends = jnp.asarray([[0, 6, 7], [-5, -3, 7], [5, -3, 7.0]])
    swing = jax.jit(functools.partial(stiffness, hook=True))
    for height in (0.15, -0.15):
        load = load_of(np.tile([0, 0, height], (3, 1)))
        pose = Pose(jnp.asarray([0.3, 0.2, 2.0]), jnp.eye(3))
        units, _ = cables_at(pose, load, ends)
        tensions = jnp.linalg.solve(units.T, jnp.asarray([0, 0, 98.1]))
        modes = swing(pose, tensions, load, ends)
        # Unit steps turn by ‖(shift, radius · turn)‖ = 1, so by 1/(√2 radius).
        expected = 98.1 * height / (2 * height**2)
        np.testing.assert_allclose(modes, [expected] * 2, rtol=1e-9)


# More cables than three.


def ring(cables: int, radius: float, height: float):
    azimuth = 2 * np.pi * np.arange(cables) / cables + 0.3
    return np.stack(
        [radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(cables, height)], axis=1
    )


@pytest.mark.parametrize("cables", [4, 6])
def test_redundant_cables_balance_within_their_limits_near_level(cables):
    load, ends = load_of(ring(cables, 0.3, 0.15)), jnp.asarray(ring(cables, 6, 7.0))
    rng = np.random.default_rng(2)
    place = jnp.asarray(rng.uniform([-1, -1, 0.5], [1, 1, 3], (20, 3)))
    low, high = jnp.asarray(1.0), jnp.asarray(100.0)
    find = jax.jit(jax.vmap(lambda p: hang_within(p, jnp.eye(3), load, ends, low, high)))
    found = find(place)
    assert (found.code == CONVERGED).all()
    assert np.asarray(found.force).max() < 1e-9
    assert np.asarray(found.tensions).min() >= 1 - 1e-9
    assert np.asarray(found.tensions).max() <= 100 + 1e-9
    assert np.asarray(jax.vmap(tilt)(found.pose.posture)).max() < np.deg2rad(25)


def test_bounded_least_squares_is_scipy_s():
    from scipy.optimize import lsq_linear

    rng = np.random.default_rng(0)
    low, high = jnp.asarray(20.0), jnp.asarray(40.0)
    for cables in (4, 8):
        load, ends = load_of(ring(cables, 0.4, 0.15)), jnp.asarray(ring(cables, 6, 7.0))
        place = rng.uniform([-3, -3, 0.3], [3, 3, 4], (40, 3))

        @jax.jit
        @jax.vmap
        def solve(p, load=load, ends=ends):
            pose = Pose(p, jnp.eye(3))
            matrix = structure_matrix(pose, load, ends)
            return bounded_least_squares(pose, load, ends, low, high), matrix

        found, matrices = jax.tree.map(np.asarray, solve(place))
        for i, matrix in enumerate(matrices):
            unit = 98.1 * np.array([1] * 3 + [float(load.radius)] * 3)
            scaled, needed = matrix / unit[:, None], np.array([0, 0, 1, 0, 0, 0])
            best = lsq_linear(scaled, needed, (20, 40), tol=1e-14).cost
            rest = scaled @ found.tensions[i] - needed
            assert rest @ rest / 2 <= best + 1e-9
            wrench = matrix @ found.tensions[i] - [0, 0, 98.1, 0, 0, 0]
            assert float(found.force[i]) == pytest.approx(np.linalg.norm(wrench[:3]), abs=1e-9)
            assert float(found.moment[i]) == pytest.approx(np.linalg.norm(wrench[3:]), abs=1e-9)


def test_a_level_pose_of_separate_attachments_leaves_a_moment():
    """The least squares of 6×3 is reported with what it cannot balance."""
    load, ends = load_of(ring(3, 0.1, 0.15)), jnp.asarray(ring(3, 6, 7.0))
    pose = Pose(jnp.asarray([1.0, 0.5, 2.0]), jnp.eye(3))
    found = least_squares_tensions(pose, load, ends)
    matrix = np.asarray(structure_matrix(pose, load, ends))
    unit = np.array([1] * 3 + [float(load.radius)] * 3)
    scaled, needed = matrix / unit[:, None], np.array([0, 0, 98.1, 0, 0, 0])
    expected = np.linalg.inv(scaled.T @ scaled) @ scaled.T @ needed  # (JᵀJ)⁻¹ JᵀF
    np.testing.assert_allclose(found.tensions, expected, rtol=1e-9)
    assert float(found.moment) > 0.5


# Scenarios.


def test_the_rim_example_turns_and_says_so():
    scenario = js.load_scenario("rim")
    found = js.equilibrium(scenario, [scenario.task.start, (0.0, 0.0, 1.0)])
    assert found.balanced.all()
    assert found.stable.all()
    assert 3 < np.rad2deg(found.turn[0]) < 10
    assert np.rad2deg(found.turn[1]) < 0.05  # nearly symmetric: the file rounds its numbers
    np.testing.assert_allclose(js.tensions(scenario, scenario.task.start), found.tensions[0])
    np.testing.assert_allclose(
        found.angles[0],
        Rotation.from_matrix(found.posture[0]).as_euler("xyz"),
        atol=1e-12,
    )
    np.testing.assert_allclose(angles(found.posture[0]), found.angles[0], atol=1e-12)
    np.testing.assert_allclose(
        found.turn, np.linalg.norm(Rotation.from_matrix(found.posture).as_rotvec(), axis=1)
    )


def test_a_hook_under_acceleration_reports_the_moment_that_a_level_load_leaves():
    scenario = js.load_scenario("scenario-1")
    found = js.equilibrium(scenario, [0.0, 0.0, 2.0], [1.0, 0.0, 0.0])
    assert float(found.moment) == pytest.approx(10 * 1.0 * 0.15)
    assert float(found.force) == 0
    np.testing.assert_allclose(
        found.tensions, js.tensions(scenario, [0.0, 0.0, 2.0], [1.0, 0.0, 0.0])
    )


@pytest.mark.fast
def test_a_tilted_posture_at_a_hook_is_refused():
    tilted = Rotation.from_euler("x", 5, degrees=True).as_matrix()
    with pytest.raises(js.InputError, match="at a hook the load hangs straight down"):
        js.equilibrium(js.load_scenario("scenario-1"), [0.0, 0.0, 2.0], posture=tilted)
    with pytest.raises(js.InputError, match="is no rotation"):
        js.equilibrium(js.load_scenario("rim"), [0.0, 0.0, 2.0], posture=2 * np.eye(3))


@pytest.mark.fast
def test_where_level_is_no_equilibrium_it_says_so():
    scenario = js.load_scenario("rim")
    assert hanging_trouble(scenario, scenario.task.start) == ""
    far = hanging_trouble(scenario, [0.0, 2.6, 3.5])
    assert far.startswith("level is no equilibrium: the load turns by ")
    assert far.endswith("more than limits.posture_deg = 10")
    assert hanging_trouble(js.load_scenario("scenario-1"), [0.0, 2.0, 1.0]) == ""
