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


hang_all = jax.jit(jax.vmap(hang, in_axes=(0, 0, None, 0)))
settle_all = jax.jit(jax.vmap(settle, in_axes=(0, 0, None, 0)))
stiffness_all = jax.jit(jax.vmap(stiffness, in_axes=(0, 0, None, 0)))


class Hung:
    """Random equilibria of three separate cables: 200 positions under random ends."""

    def __init__(self):
        rng = np.random.default_rng(7)
        azimuth = np.deg2rad([90, 210, 330])
        rim = np.stack([0.25 * np.cos(azimuth), 0.25 * np.sin(azimuth), [0.2, 0.15, 0.2]], axis=1)
        ring = np.stack([6 * np.cos(azimuth), 6 * np.sin(azimuth), [7, 7, 7]], axis=1)
        count = 200
        self.load = load_of(rim, center_of_mass=(0.02, -0.01, 0.03))
        self.ends = jnp.asarray(ring + rng.uniform(-0.8, 0.8, (count, 3, 3)))
        self.position = jnp.asarray(rng.uniform([-2, -2, 0.5], [2, 2, 4], (count, 3)))
        self.level = jnp.broadcast_to(jnp.eye(3), (count, 3, 3))
        self.found = hang_all(self.position, self.level, self.load, self.ends)
        modes = stiffness_all(self.found.pose, self.found.tensions, self.load, self.ends)
        self.modes, self.stable = np.asarray(modes), np.asarray(is_stable(modes))
        self.tilt = np.asarray(jax.vmap(tilt)(self.found.pose.posture))

    def pose(self, i: int) -> Pose:
        return jax.tree.map(lambda leaf: leaf[i], self.found.pose)
