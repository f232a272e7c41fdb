"""Ends that keep a load level: balance by the general statics, and the nearest forces."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from suspensions import load_of

import jaxsusp as js
from jaxsusp.mechanics.posture.graspmap import nearest_forces
from jaxsusp.mechanics.posture.levelling import level_ends
from jaxsusp.mechanics.posture.load import Pose
from jaxsusp.mechanics.posture.structure import imbalance
from jaxsusp.scenario.world import build_world, cast_world
from jaxsusp.suspension.levelload import ends_at, tensions_at
from jaxsusp.vec3 import Vec3

RIM = [[0.0, 0.1, 0.15], [-0.087, -0.05, 0.15], [0.087, -0.05, 0.1]]
LEVEL = jnp.eye(3)


def rows(vectors: list[Vec3]) -> np.ndarray:
    """(positions, K, 3)."""
    return np.stack([np.asarray(v.to_array()) for v in vectors], axis=1)


@pytest.fixture(scope="module")
def found():
    """A load with an offset centre of mass at 50 random places under random ends."""
    rng = np.random.default_rng(3)
    load = load_of(RIM, center_of_mass=(0.004, -0.003, 0.02))
    place = Vec3.from_array(jnp.asarray(rng.uniform([-1, -1, 0.5], [1, 1, 3], (50, 3))))
    lower = [place + Vec3.from_array(at) for at in load.attachments]
    azimuth = np.deg2rad([90, 210, 330]) + rng.uniform(-0.3, 0.3, (50, 3))
    ends = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), np.full((50, 3), 7.0)], axis=-1)
    ends += rng.uniform(-0.5, 0.5, ends.shape)
    vectors = [Vec3.from_array(jnp.asarray(ends[:, k])) - lower[k] for k in range(3)]
    units = rows(vectors) / np.linalg.norm(rows(vectors), axis=-1, keepdims=True)
    needed = np.array([0, 0, 98.1])
    tensions = np.stack([np.linalg.solve(u.T, needed) for u in units])
    held = level_ends(lower, vectors, list(jnp.asarray(tensions).T), load)
    wished = units * tensions[..., None]
    return load, np.asarray(place.to_array()), rows(lower), rows(vectors), wished, rows(held)


def test_a_level_load_is_balanced_in_forces_and_moments(found):
    load, places, lower, _, _, ends = found
    for i in range(len(places)):
        units = (ends[i] - lower[i]) / np.linalg.norm(ends[i] - lower[i], axis=1, keepdims=True)
        tensions = np.linalg.solve(units.T, [0, 0, 98.1])
        assert tensions.min() > 0
        rest = imbalance(Pose(places[i], LEVEL), jnp.asarray(tensions), load, jnp.asarray(ends[i]))
        np.testing.assert_allclose(rest, 0, atol=1e-9)


def test_lengths_are_kept_and_forces_are_the_nearest(found):
    load, places, lower, vectors, wished, ends = found
    cables = ends - lower
    lengths = np.linalg.norm(cables, axis=-1)
    np.testing.assert_allclose(lengths, np.linalg.norm(vectors, axis=-1), rtol=1e-12)
    for i in range(0, len(places), 7):
        pose = Pose(jnp.asarray(places[i]), LEVEL)
        force = np.asarray(nearest_forces(jnp.asarray(wished[i]), pose, load))
        direction = force / np.linalg.norm(force, axis=1, keepdims=True)
        np.testing.assert_allclose(cables[i] / lengths[i, :, None], direction, atol=1e-9)


@pytest.mark.parametrize("drive", ["end", "hybrid"])
def test_the_rule_of_a_drive_mode_holds_the_load_level(drive):
    scenario = js.load_scenario("level-rim").model_copy(update={"drive": drive})
    way = np.linspace(scenario.task.start, scenario.task.goal, 12)
    hung = js.equilibrium(scenario, way)
    assert hung.balanced.all()
    assert hung.stable.all()
    assert float(jnp.abs(hung.turn).max()) < 1e-9
    world = cast_world(build_world(scenario), jnp.float64)
    ends = ends_at(world, Vec3.from_array(jnp.asarray(way)), drive)
    lengths, tensions = jax.jit(tensions_at)(world, Vec3.from_array(jnp.asarray(way)), ends)
    np.testing.assert_allclose(jnp.stack(tensions, axis=-1), hung.tensions, rtol=1e-9)
    if drive == "end":
        lengths = np.stack(lengths)
        np.testing.assert_allclose(lengths, np.broadcast_to(lengths[:, :1], lengths.shape))
