"""Rolling bases hold a load on three attachments level: balance by the general statics."""

import jax
import jax.numpy as jnp
import numpy as np
from suspensions import load_of

import jaxsusp as js
from jaxsusp.mechanics.drives import Anchors
from jaxsusp.mechanics.posture.load import Pose
from jaxsusp.mechanics.posture.rolling import rolled_level_ends, upward_shares
from jaxsusp.mechanics.posture.structure import imbalance
from jaxsusp.vec3 import Vec3

LEVEL = jnp.eye(3)


def drawn(rng: np.random.Generator) -> tuple:
    """Attachments of one height round a centre of mass, and ends of other heights round both."""
    azimuth = np.deg2rad([90, 210, 330]) + rng.uniform(-0.4, 0.4, 3)
    radius = rng.uniform(0.1, 0.4, 3)
    height = rng.uniform(-0.2, 0.2)
    rim = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(3, height)], 1)
    load = load_of(rim.tolist(), center_of_mass=(0.01, -0.02, 0.05))
    ends = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), rng.uniform(6.5, 7.5, 3)], 1)
    if rng.random() < 0.5:  # the other way round
        rim, ends = rim * [1, -1, 1], ends * [1, -1, 1]
        load = load_of(rim.tolist(), center_of_mass=(0.01, -0.02, 0.05))
    return load, rim, ends, rng.uniform([-1, -1, 0.5], [1, 1, 2])


def test_a_load_is_balanced_at_lengths_and_heights_that_stay():
    rng = np.random.default_rng(0)
    rule, rest = jax.jit(rolled_level_ends), jax.jit(imbalance)
    closed = 0
    for _ in range(25):
        load, rim, ends, start = drawn(rng)
        shares = upward_shares(jnp.asarray(rim), load.center_of_mass)
        np.testing.assert_allclose(shares @ rim[:, :2], load.center_of_mass[:2], atol=1e-12)
        anchors = Anchors(Vec3(*start), Vec3(*rim.T), Vec3(*ends.T))
        way = start + rng.uniform([-2, -2, -0.4], [2, 2, 0.6], (8, 3))
        center = Vec3(*load.center_of_mass)
        found = np.stack(rule(Vec3(*way.T), anchors, shares, center), axis=-1)
        before = np.linalg.norm(ends - start - rim, axis=1)
        for place, held in zip(way, np.moveaxis(found, 0, 1), strict=True):
            if np.isnan(held).any():
                continue  # the pulls close to no triangle
            closed += 1
            cables = held - place - rim
            np.testing.assert_allclose(np.linalg.norm(cables, axis=1), before, rtol=1e-12)
            np.testing.assert_array_equal(held[:, 2], ends[:, 2])
            tensions = shares * 98.1 * before / cables[:, 2]
            off = rest(Pose(jnp.asarray(place), LEVEL), tensions, load, held)
            np.testing.assert_allclose(off, 0, atol=1e-9)
    assert closed > 100


def test_the_load_hangs_stably_where_the_rule_holds_it():
    scenario = js.load_scenario("level-rim").model_copy(update={"drive": "base"})
    way = np.linspace(scenario.task.start, scenario.task.goal, 12)
    hung = js.equilibrium(scenario, way)
    assert hung.balanced.all()
    assert hung.stable.all()
    assert float(jnp.abs(hung.turn).max()) < 1e-9


def test_where_no_cable_reaches_there_are_no_ends():
    load, rim, ends, start = drawn(np.random.default_rng(1))
    anchors = Anchors(Vec3(*start), Vec3(*rim.T), Vec3(*ends.T))
    shares = upward_shares(jnp.asarray(rim), load.center_of_mass)
    places, center = Vec3(*np.array([[0, 0, 1.0], [0, 0, -30.0]]).T), Vec3(*load.center_of_mass)
    found = np.stack(jax.jit(rolled_level_ends)(places, anchors, shares, center))
    assert np.isfinite(found[..., 0]).all()
    assert np.isnan(found[:2, :, 1]).all()
