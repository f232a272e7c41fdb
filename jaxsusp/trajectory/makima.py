"""Makima interpolation between waypoints (the paper's Sect. 3.2, step 6).

Makima is MATLAB's "modified Akima" piecewise cubic: C1, local, and free of the overshoot of
natural splines. Knots and samples are uniform and fixed, so sampling is a constant linear map of
the knot values and slopes.
"""

import functools

import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float


def makima_slopes(values: Float[Array, "knots *batch"]) -> Float[Array, "knots *batch"]:
    """Slopes dv/du at uniformly spaced knots (spacing 1) of the modified Akima interpolant.

    The weight of a secant slope is |d[i+1] - d[i]| + |d[i+1] + d[i]| / 2 of its neighbours on the
    other side (MATLAB `makima`); two secants beyond each end are extrapolated quadratically.

    Args:
        values: the interpolated quantity at K >= 3 knots, any unit; trailing axes are batch.

    Returns:
        Slopes per unit of u, of the same shape.
    """
    inner = jnp.diff(values, axis=0)
    left = 2 * inner[0] - inner[1]
    right = 2 * inner[-1] - inner[-2]
    secants = jnp.concatenate(
        [
            (2 * left - inner[0])[None],
            left[None],
            inner,
            right[None],
            (2 * right - inner[-1])[None],
        ]
    )
    change = jnp.abs(jnp.diff(secants, axis=0)) + jnp.abs(secants[1:] + secants[:-1]) / 2
    before, after = change[2:], change[:-2]
    total = before + after
    flat = total == 0  # all four secants vanish: the curve is level here
    weight = jnp.where(flat, 0, before / jnp.where(flat, 1, total))
    return weight * secants[1:-2] + jnp.where(flat, 0, 1 - weight) * secants[2:-1]


@functools.cache
def hermite_matrices(knots: int, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Constant matrices (H_p, H_m), each (samples, knots): position = H_p·values + H_m·slopes.

    Knots are u = 0 … knots-1; samples are uniform in u and include both ends.
    """
    u = np.linspace(0.0, knots - 1.0, samples)
    left = np.clip(np.floor(u).astype(int), 0, knots - 2)
    s = u - left
    h_values = np.zeros((samples, knots))
    h_slopes = np.zeros((samples, knots))
    rows = np.arange(samples)
    h_values[rows, left] = (1 + 2 * s) * (1 - s) ** 2
    h_values[rows, left + 1] = s**2 * (3 - 2 * s)
    h_slopes[rows, left] = s * (1 - s) ** 2
    h_slopes[rows, left + 1] = -(s**2) * (1 - s)
    return h_values, h_slopes


def makima(values: Float[Array, "knots *batch"], samples: int) -> Float[Array, "samples *batch"]:
    """Sample the Makima interpolant of uniformly spaced knots at uniformly spaced parameters.

    Args:
        values: knot values, knots on axis 0, any trailing batch axes; the unit is kept.
        samples: number of samples, both ends included.

    Returns:
        The samples on axis 0, in the dtype of `values`.
    """
    h_values, h_slopes = hermite_matrices(values.shape[0], samples)
    table = jnp.asarray(np.concatenate([h_values, h_slopes], axis=1), values.dtype)
    data = jnp.concatenate([values, makima_slopes(values)])
    return jnp.tensordot(table, data, axes=1, precision="highest")
