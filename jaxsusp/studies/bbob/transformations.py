"""What makes functions less regular than their formulas (Hansen et al. 2009, RR-6829, Sect. 0.2).

Every transformation takes one point (D,) and keeps its dtype. Indices i run from 0 to D - 1.
"""

import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float


def shares(dim: int) -> Float[np.ndarray, "dim"]:
    """Numbers i / (D - 1), from 0 to 1."""
    return np.arange(dim) / (dim - 1)


def stretched(z: Float[Array, "dim"], condition: float) -> Float[Array, "dim"]:
    """Λ^α z, with the diagonal α^(i / 2(D - 1))."""
    return z * jnp.asarray(condition ** (shares(len(z)) / 2), z.dtype)


def oscillated(z: Float[Array, "*dim"]) -> Float[Array, "*dim"]:
    """T_osz: sign(z) exp(ẑ + 0.049 (sin c₁ẑ + sin c₂ẑ)), ẑ = log|z|, elementwise.

    c₁, c₂ are 10 and 7.9 above zero, 5.5 and 3.1 below. It is smooth nowhere but monotone: it keeps
    optima and makes the way to them bumpy.
    """
    there = z != 0
    log = jnp.log(jnp.where(there, jnp.abs(z), 1))
    above = z > 0
    waves = jnp.sin(jnp.where(above, 10, 5.5) * log) + jnp.sin(jnp.where(above, 7.9, 3.1) * log)
    return jnp.where(there, jnp.sign(z) * jnp.exp(log + 0.049 * waves), 0)


def skewed(z: Float[Array, "dim"], beta: float) -> Float[Array, "dim"]:
    """T_asy^β: z^(1 + β √z i/(D - 1)) where z is positive, elsewhere z."""
    base = jnp.where(z > 0, z, 1)
    power = 1 + beta * jnp.asarray(shares(len(z)), z.dtype) * jnp.sqrt(base)
    return jnp.where(z > 0, base**power, z)


def penalty(x: Float[Array, "dim"], bound: float = 5.0) -> Float[Array, ""]:
    """f_pen: Σ max(0, |x| - 5)², what it costs to leave the box."""
    return (jnp.maximum(0, jnp.abs(x) - bound) ** 2).sum()
