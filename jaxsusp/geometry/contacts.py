"""Do straight cables at rest keep clear of obstacles?  Exact, elementwise over any shape."""

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Bool
from jaxsusp.geometry.obstacles import Obstacles
from jaxsusp.vec3 import Vec3


def segments_clear(a: Vec3, b: Vec3, margin: Array, obstacles: Obstacles) -> Bool[Array, "..."]:
    """Whether segments a-b stay out of all obstacles inflated by a margin (m)."""

    def keep(clear: Array, obstacle) -> tuple[Array, None]:
        return clear & ~obstacle.met_by(a, b, margin), None

    clear = jnp.ones(jnp.broadcast_shapes(a.x.shape, b.x.shape), bool)
    for kind in obstacles:
        clear = jax.lax.scan(keep, clear, kind)[0]
    return clear
