"""Do straight cables at rest keep clear of obstacles?  Exact, elementwise over any shape."""

import jax.numpy as jnp

from jaxsusp._types import Array, Bool
from jaxsusp.geometry.obstacles import Obstacles, over_bodies
from jaxsusp.vec3 import Vec3


def segments_clear(a: Vec3, b: Vec3, margin: Array, obstacles: Obstacles) -> Bool[Array, "..."]:
    """Whether segments a-b stay out of all obstacles inflated by a margin (m)."""

    def keep(clear: Array, obstacle) -> Array:
        return clear & ~obstacle.met_by(a, b, margin)

    clear = jnp.ones(jnp.broadcast_shapes(a.x.shape, b.x.shape), bool)
    for kind in obstacles:
        clear = over_bodies(keep, kind, clear)
    return clear
