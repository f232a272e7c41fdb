"""Stability factor S_c of a load position (Eq. 18).

The paper cites its four factors without printing them. These are our reading: each lies in [0, 1]
and is the cube root of a margin, which puts about 40 % of the admissible workspace inside the
paper's window [0.6, 0.9].
"""

from typing import NamedTuple

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.vec3 import Vec3

WINDOW = (0.6, 0.9)
"""Values of S_c between which Eq. 19 acts."""


class StabilityFactors(NamedTuple):
    """The four factors of Eq. 18."""

    horizontal: Array  # λ_p: hook inside the polygon of the ends
    vertical: Array  # λ_q: load far below the ends
    balance: Array  # τ_p: equal tensions
    tension_margin: Array  # τ_q: tensions far from both limits


def stability_factors(
    hook: Vec3,
    ends: Vec3,
    tensions: list[Array],
    load_height: Array,
    floor: Array,
    tension_limits: tuple[Array, Array],
) -> StabilityFactors:
    """λ_p, λ_q, τ_p, τ_q of Eq. 18, in our reading.

    Args:
        hook: hook position (m), any shape.
        ends: P_k packed along the first axis (m); behind it nothing, or the hook's shape.
        tensions: T_k (N), shape of the hook's components.
        load_height: z of the load's centre (m).
        floor: bottom of the workspace (m).
        tension_limits: T_lo, T_hi (N).
    """
    low, high = tension_limits
    least, most = jnp.minimum, jnp.maximum
    t_min, t_max = tensions[0], tensions[0]
    for tension in tensions[1:]:
        t_min, t_max = least(t_min, tension), most(t_max, tension)
    top = ends.z.min(axis=0)
    taut = t_min > 0
    return StabilityFactors(
        horizontal=_root(1 - polygon_gauge(hook, ends)),
        vertical=_root((top - load_height) / (top - floor)),
        balance=jnp.where(taut, _root(t_min / jnp.where(taut, t_max, 1)), 0),
        tension_margin=_root(least(t_min - low, high - t_max) / ((high - low) / 2)),
    )


def stability(factors: StabilityFactors) -> Array:
    """S_c = (μ1 λ_p + ν1 τ_p)(μ2 λ_q + ν2 τ_q), all weights ½ (Eq. 18); NaN margins give 0."""
    first = (factors.horizontal + factors.balance) / 2
    second = (factors.vertical + factors.tension_margin) / 2
    return first * second


def polygon_gauge(point: Vec3, ends: Vec3) -> Array:
    """Gauge ρ of a horizontal position in the convex hull of the ends about its area centroid.

    0 at the centroid, 1 on the boundary, larger outside. Every ordered pair of ends with all
    others to its left is a hull edge; K is small, so trying all pairs beats any cleverer hull.

    Args:
        point: positions (m); only x and y matter.
        ends: K ends packed along the first axis (m); behind it nothing, or the points' shape.
    """
    x, y = ends.x, ends.y
    span_x, span_y = x[None, :] - x[:, None], y[None, :] - y[:, None]  # [i, j]: from i to j
    # side[i, j, k] > 0: end k lies to the left of the directed line i → j
    side = span_x[:, :, None] * span_y[:, None, :] - span_y[:, :, None] * span_x[:, None, :]
    along = span_x[:, :, None] * span_x[:, None, :] + span_y[:, :, None] * span_y[:, None, :]
    square = (span_x**2 + span_y**2)[:, :, None]
    # A compiler that fuses a product with a sum rounds equal things differently: what is within
    # rounding of a hull edge's line lies on it.
    rounding = 4 * float(jnp.finfo(x.dtype).eps)
    scale = jnp.abs(span_x)[:, :, None] * jnp.abs(span_y)[:, None, :]
    side = jnp.where(jnp.abs(side) <= rounding * (scale + scale.swapaxes(1, 2)), 0, side)
    longest = square * (1 + rounding)
    beyond = (side == 0) & ((along < 0) | (along > longest))  # keep only the longest of collinear
    edge = (square[:, :, 0] > 0) & jnp.all((side >= 0) & ~beyond, axis=2)

    area = jnp.where(edge, x[:, None] * y[None, :] - y[:, None] * x[None, :], 0)
    total = 3 * area.sum(axis=(0, 1))
    center_x = (area * (x[:, None] + x[None, :])).sum(axis=(0, 1)) / total
    center_y = (area * (y[:, None] + y[None, :])).sum(axis=(0, 1)) / total

    gauge = jnp.zeros_like(point.x)
    for i in range(x.shape[0]):
        for j in range(x.shape[0]):
            if i == j:
                continue
            # Distances to the edge's line, up to its common length.
            inside = span_x[i, j] * (center_y - y[i]) - span_y[i, j] * (center_x - x[i])
            gone = span_x[i, j] * (point.y - center_y) - span_y[i, j] * (point.x - center_x)
            ratio = -gone / jnp.where(edge[i, j], inside, 1)
            gauge = jnp.maximum(gauge, jnp.where(edge[i, j], ratio, 0))
    return gauge


def _root(margin: Array) -> Float[Array, "..."]:
    """Cube root of a margin clipped to [0, 1]; NaN counts as no margin.

    In single precision by a logarithm, which is vectorised: `cbrt` is a call of the C library.
    """
    margin = jnp.clip(jnp.where(margin > 0, margin, 0), 0, 1)
    return jnp.exp(jnp.log(margin) / 3) if margin.dtype == jnp.float32 else jnp.cbrt(margin)
