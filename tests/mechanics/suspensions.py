"""Suspensions that several tests of the mechanics hang their loads from."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.mechanics.posture.equilibrium import hang, settle
from jaxsusp.mechanics.posture.load import Load, Pose, tilt
from jaxsusp.mechanics.posture.potential import is_stable, stiffness

DOWN = (0.0, 0.0, -9.81)


def load_of(attachments, mass=10.0, gravity=DOWN, center_of_mass=(0.0, 0.0, 0.0)) -> Load:
    return Load(*map(jnp.asarray, (mass, gravity, center_of_mass, attachments)))


COUNT = 200


def for_all(function):
    """For many equilibria of a load at once; fewer are repeated, so that all share one program."""
    compiled = jax.jit(jax.vmap(function, in_axes=(0, 0, None, 0)))

    def each(one, other, load: Load, ends):
        count = len(ends)
        every = np.resize(np.arange(count), COUNT)
        one, other, ends = jax.tree.map(lambda leaf: np.asarray(leaf)[every], (one, other, ends))
        found = compiled(one, other, load, ends)
        return jax.tree.map(lambda leaf: np.asarray(leaf)[:count], found)

    return each


hang_all, settle_all, stiffness_all = map(for_all, (hang, settle, stiffness))


class Hung:
    """Random equilibria of three separate cables: 200 positions under random ends."""

    def __init__(self):
        rng = np.random.default_rng(7)
        azimuth = np.deg2rad([90, 210, 330])
        rim = np.stack([0.25 * np.cos(azimuth), 0.25 * np.sin(azimuth), [0.2, 0.15, 0.2]], axis=1)
        ring = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), [7, 7, 7]], axis=1)
        self.load = load_of(rim, center_of_mass=(0.02, -0.01, 0.03))
        self.ends = jnp.asarray(ring + rng.uniform(-0.8, 0.8, (COUNT, 3, 3)))
        self.position = jnp.asarray(rng.uniform([-2, -2, 0.5], [2, 2, 4], (COUNT, 3)))
        self.level = jnp.broadcast_to(jnp.eye(3), (COUNT, 3, 3))
        self.found = hang_all(self.position, self.level, self.load, self.ends)
        modes = stiffness_all(self.found.pose, self.found.tensions, self.load, self.ends)
        self.modes, self.stable = modes, np.asarray(is_stable(modes))
        self.tilt = np.asarray(jax.vmap(tilt)(self.found.pose.posture))

    def pose(self, i: int) -> Pose:
        return jax.tree.map(lambda leaf: leaf[i], self.found.pose)
