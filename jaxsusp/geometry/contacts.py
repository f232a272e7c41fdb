"""Do straight cables at rest keep clear of obstacles?  Exact, elementwise over any shape."""

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Bool
from jaxsusp.geometry.obstacles import Obstacles
from jaxsusp.geometry.segments import (
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_sphere,
)
from jaxsusp.vec3 import Vec3


def segments_clear(a: Vec3, b: Vec3, margin: Array, obstacles: Obstacles) -> Bool[Array, "..."]:
    """Whether segments a-b stay out of all obstacles inflated by a margin (m)."""
    wide = Vec3(margin, margin, margin)

    def with_box(box) -> Array:
        return segment_meets_box(box.to_own_frame(a), box.to_own_frame(b), box.half + wide)

    def with_cylinder(it) -> Array:
        low, high = a - it.center, b - it.center
        return segment_meets_cylinder(low, high, it.radius + margin, it.half_height + margin)

    def with_sphere(ball) -> Array:
        return segment_meets_sphere(a - ball.center, b - ball.center, ball.radius + margin)

    clear = jnp.ones(jnp.broadcast_shapes(a.x.shape, b.x.shape), bool)
    for kind, meets in zip(obstacles, (with_box, with_cylinder, with_sphere), strict=True):

        def keep(clear, obstacle, meets=meets):
            return clear & ~(obstacle.active & meets(obstacle)), None

        clear = jax.lax.scan(keep, clear, kind)[0]
    return clear
