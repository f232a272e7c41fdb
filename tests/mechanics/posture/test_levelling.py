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
    return np.stack([np.stack(v, axis=-1) for v in vectors], axis=1)


@pytest.fixture(scope="module")
def found():
    """A load with an offset centre of mass at 50 random places under random ends."""
    rng = np.random.default_rng(3)
    load = load_of(RIM, center_of_mass=(0.004, -0.003, 0.02))
    place = Vec3(*rng.uniform([-1, -1, 0.5], [1, 1, 3], (50, 3)).T)
    lower = [place + Vec3(*at) for at in np.asarray(load.attachments)]
    azimuth = np.deg2rad([90, 210, 330]) + rng.uniform(-0.3, 0.3, (50, 3))
    ends = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), np.full((50, 3), 7.0)], axis=-1)
    ends += rng.uniform(-0.5, 0.5, ends.shape)
    vectors = [Vec3(*ends[:, k].T) - lower[k] for k in range(3)]
    units = rows(vectors) / np.linalg.norm(rows(vectors), axis=-1, keepdims=True)
    needed = np.array([0, 0, 98.1])
    tensions = np.stack([np.linalg.solve(u.T, needed) for u in units])
    held = jax.jit(level_ends)(lower, vectors, list(tensions.T), load)
    wished = units * tensions[..., None]
    return load, np.stack(place, axis=-1), rows(lower), rows(vectors), wished, rows(held)


def test_a_level_load_is_balanced_in_forces_and_moments(found):
    load, places, lower, _, _, ends = found
    units = (ends - lower) / np.linalg.norm(ends - lower, axis=-1, keepdims=True)
    tensions = np.stack([np.linalg.solve(u.T, [0, 0, 98.1]) for u in units])
    assert tensions.min() > 0
    rest = jax.vmap(
        lambda place, tensions, ends: imbalance(Pose(place, LEVEL), tensions, load, ends)
    )
    np.testing.assert_allclose(jax.jit(rest)(places, tensions, ends), 0, atol=1e-9)


def test_lengths_are_kept_and_forces_are_the_nearest(found):
    load, places, lower, vectors, wished, ends = found
    cables = ends - lower
    lengths = np.linalg.norm(cables, axis=-1)
    np.testing.assert_allclose(lengths, np.linalg.norm(vectors, axis=-1), rtol=1e-12)
    nearest = jax.jit(nearest_forces)
    for i in range(0, len(places), 7):
        force = np.asarray(nearest(wished[i], Pose(places[i], LEVEL), load))
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
    place = Vec3(*way.T)
    at = jax.jit(lambda world, place: tensions_at(world, place, ends_at(world, place, drive)))
    lengths, tensions = at(world, place)
    np.testing.assert_allclose(np.stack(tensions, axis=-1), hung.tensions, rtol=1e-9)
    if drive == "end":
        lengths = np.stack(lengths)
        np.testing.assert_allclose(lengths, np.broadcast_to(lengths[:, :1], lengths.shape))
