"""Equilibrium postures, lengths → pose, and stability against MuJoCo.

A load is released on three (or four) one-sided tendons at separate sites and settles under
damping. MuJoCo knows nothing of our equations. Its soft limits stretch the cables by a fraction of
a millimetre, so what is compared is the pose that our solver finds for the lengths that the
tendons have in the end, and the tensions there.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxsusp.mechanics.posture.equilibrium import CONVERGED, hang, settle
from jaxsusp.mechanics.posture.load import Load, Pose
from jaxsusp.mechanics.posture.potential import stiffness
from jaxsusp.mechanics.posture.redundant import hang_within

POSES = 12
TIMESTEP = 0.002  # s


class Rest(NamedTuple):
    """A load that hangs still."""

    position: np.ndarray
    posture: np.ndarray
    lengths: np.ndarray
    tensions: np.ndarray
    speed: float


def row(numbers) -> str:
    return " ".join(repr(float(number)) for number in np.ravel(numbers))


def release(
    load: Load, ends, lengths, position, posture, steps=15_000, damping=20.0, spin=2.0
) -> Rest:
    """Let a load settle on tendons of these lengths from a pose."""
    sites = "".join(f'<site name="end{k}" pos="{row(end)}"/>' for k, end in enumerate(ends))
    lower = "".join(
        f'<site name="low{k}" pos="{row(point)}"/>' for k, point in enumerate(load.attachments)
    )
    cables = "".join(
        f'<spatial limited="true" range="0 {float(length)!r}" solreflimit=".004 1" '
        f'solimplimit=".99 .9999 .001"><site site="end{k}"/><site site="low{k}"/></spatial>'
        for k, length in enumerate(lengths)
    )
    quaternion = Rotation.from_matrix(np.asarray(posture)).as_quat(scalar_first=True)
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option gravity="{row(load.gravity)}" timestep="{TIMESTEP}" tolerance="0" iterations="50"/>
      <worldbody>
        {sites}
        <body name="load" pos="{row(position)}" quat="{row(quaternion)}">
          <freejoint/>
          <inertial pos="{row(load.center_of_mass)}" mass="{float(load.mass)!r}"
            diaginertia="0.2 0.2 0.2"/>
          {lower}
        </body>
      </worldbody>
      <tendon>{cables}</tendon>
    </mujoco>""")
    model.dof_damping[:] = [damping] * 3 + [spin] * 3
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, steps)
    speed = float(np.abs(data.qvel).max())
    mujoco.mj_forward(model, data)
    limits = data.efc_type == mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON
    tensions = np.zeros(len(lengths))
    tensions[data.efc_id[limits]] = data.efc_force[limits]
    return Rest(
        data.body("load").xpos.copy(),
        data.body("load").xmat.reshape(3, 3).copy(),
        data.ten_length.copy(),
        tensions,
        speed,
    )


def random_load(rng) -> tuple[Load, np.ndarray]:
    """A rim of three attachments above an offset centre of mass, and ends around it."""
    azimuth = np.deg2rad([90, 210, 330]) + rng.uniform(-0.3, 0.3, 3)
    out = rng.uniform(0.15, 0.3, 3)
    rim = np.stack([out * np.cos(azimuth), out * np.sin(azimuth), rng.uniform(0.1, 0.2, 3)], axis=1)
    ends = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), rng.uniform(6.2, 7.8, 3)], axis=1)
    return (
        Load(
            jnp.asarray(rng.uniform(5, 15)),
            jnp.asarray(rng.normal(scale=0.1, size=3) + np.array([0, 0, -9.81])),
            jnp.asarray(rng.normal(scale=0.03, size=3)),
            jnp.asarray(rim),
        ),
        ends,
    )


find_posture = jax.jit(hang)
find_pose = jax.jit(settle)
modes_of = jax.jit(stiffness, static_argnames="hook")


@pytest.fixture(scope="module")
def settled():
    """Random equilibria of ours, perturbed and left to MuJoCo."""
    rng = np.random.default_rng(3)
    cases = []
    while len(cases) < POSES:
        load, ends = random_load(rng)
        place = jnp.asarray(rng.uniform([-1.5, -1.5, 0.8], [1.5, 1.5, 3.5]))
        ours = find_posture(place, jnp.eye(3), load, jnp.asarray(ends))
        if int(ours.code) != CONVERGED or float(ours.tensions.min()) < 5:
            continue
        tipped = Rotation.from_rotvec(rng.normal(scale=0.05, size=3)).as_matrix()
        start = tipped @ np.asarray(ours.pose.posture)
        rest = release(load, ends, np.asarray(ours.lengths), place + 0.02, start)
        cases.append((load, ends, ours, rest))
    return cases


def test_poses_and_tensions_are_where_mujoco_settles(settled):
    worst_pose = worst_turn = worst_tension = drift = 0.0
    for load, ends, ours, rest in settled:
        assert rest.speed < 1e-5
        guess = Pose(ours.pose.position, ours.pose.posture)
        again = find_pose(jnp.asarray(rest.lengths), guess, load, jnp.asarray(ends))
        assert int(again.code) == CONVERGED
        worst_pose = max(worst_pose, np.abs(again.pose.position - rest.position).max())
        worst_turn = max(worst_turn, np.abs(again.pose.posture - rest.posture).max())
        worst_tension = max(worst_tension, np.abs(again.tensions / rest.tensions - 1).max())
        drift = max(drift, np.abs(rest.position - ours.pose.position).max())
    print(
        f"\n{len(settled)} poses: off by {worst_pose:.1e} m, {worst_turn:.1e} in R, tensions by "
        f"{worst_tension:.1e}; soft cables let the load sink by up to {1e3 * drift:.2f} mm"
    )
    assert drift < 1e-3  # before any correction for the stretch: within 1 mm of our pose
    assert worst_pose < 1e-4
    assert worst_turn < 1e-4
    assert worst_tension < 1e-3


def test_stable_equilibria_stay_and_unstable_ones_leave():
    azimuth = np.deg2rad([90, 210, 330])
    ends = np.stack([4 * np.cos(azimuth), 4 * np.sin(azimuth), np.full(3, 7.0)], axis=1)
    verdicts = []
    for height, place in [
        (0.3, (0, 0, 1.0)),
        (0.1, (0.5, 0.2, 2.0)),
        (-0.3, (0, 0, 1.0)),
        (-0.2, (0.4, -0.2, 2.0)),
        (-0.03, (0, 0.1, 3.0)),
        (0.0, (0.2, 0.1, 2.0)),
    ]:
        rim = np.stack([0.2 * np.cos(azimuth), 0.2 * np.sin(azimuth), np.full(3, height)], axis=1)
        load = Load(*map(jnp.asarray, (10.0, (0.0, 0.0, -9.81), (0.0, 0.0, 0.0), rim)))
        ours = find_posture(jnp.asarray(place, float), jnp.eye(3), load, jnp.asarray(ends))
        assert int(ours.code) == CONVERGED
        modes = modes_of(ours.pose, ours.tensions, load, jnp.asarray(ends))
        nudge = Rotation.from_rotvec([0.01, -0.008, 0.006]).as_matrix()
        rest = release(
            load, ends, np.asarray(ours.lengths), place, nudge @ np.asarray(ours.pose.posture)
        )
        turn = Rotation.from_matrix(rest.posture @ np.asarray(ours.pose.posture).T).magnitude()
        stable = bool((np.asarray(modes) > 0).all())
        print(
            f"height {height:+.2f}: softest mode {float(modes[0]):+.1f} N/m, MuJoCo {turn:.4f} rad"
        )
        assert stable == (turn < 5e-3)
        verdicts.append(stable)
    assert 1 < sum(verdicts) < len(verdicts)


def test_four_taut_cables_settle_where_the_lengths_say():
    """K = 4: ten equations for ten unknowns; MuJoCo shares its tensions by its own softness."""
    azimuth = np.deg2rad([45, 135, 225, 315])
    rim = np.stack([0.3 * np.cos(azimuth), 0.3 * np.sin(azimuth), np.full(4, 0.15)], axis=1)
    ends = np.stack([5 * np.cos(azimuth), 5 * np.sin(azimuth), [7, 7.3, 6.9, 7.1]], axis=1)
    load = Load(*map(jnp.asarray, (10.0, (0.0, 0.0, -9.81), (0.02, 0.01, 0.0), rim)))
    place, limits = jnp.asarray([0.3, 0.2, 2.0]), (jnp.asarray(1.0), jnp.asarray(100.0))
    ours = hang_within(place, jnp.eye(3), load, jnp.asarray(ends), *limits)
    assert int(ours.code) == CONVERGED
    rest = release(load, ends, np.asarray(ours.lengths), place, np.asarray(ours.pose.posture))
    assert rest.tensions.min() > 0
    found = find_pose(jnp.asarray(rest.lengths), ours.pose, load, jnp.asarray(ends))
    assert int(found.code) == CONVERGED
    np.testing.assert_allclose(found.pose.position, rest.position, atol=1e-4)
    np.testing.assert_allclose(found.pose.posture, rest.posture, atol=1e-4)
    np.testing.assert_allclose(found.tensions, rest.tensions, rtol=1e-2)
