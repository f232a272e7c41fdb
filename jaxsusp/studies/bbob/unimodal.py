"""f1 to f14: separable functions, and ones of low, moderate and high condition.

Each is a pure function of one point x (D,) and an `Instance`, in the dtype of x, and is 0 at the
optimum; the suite adds f_opt. Formulas are those of Hansen, Finck, Ros and Auger (2009), INRIA
RR-6829; R and Q are the matrices of `Instance`, Λ, T_osz, T_asy and f_pen in `transformations`.
"""

import jax.numpy as jnp

from jaxsusp._types import Array, Float
from jaxsusp.studies.bbob.instances import Instance
from jaxsusp.studies.bbob.transformations import oscillated, penalty, shares, skewed, stretched

Point = Float[Array, "dim"]
Value = Float[Array, ""]


def sphere(x: Point, at: Instance) -> Value:
    """f1: ‖x - x_opt‖²."""
    return ((x - at.optimum) ** 2).sum()


def ellipsoid(x: Point, at: Instance) -> Value:
    """f2: Σ 10^(6 i/(D - 1)) z², z = T_osz(x - x_opt)."""
    return _ellipsoid(oscillated(x - at.optimum))


def rastrigin(x: Point, at: Instance) -> Value:
    """f3: 10 (D - Σ cos 2πz) + ‖z‖², z = Λ¹⁰ T_asy^0.2(T_osz(x - x_opt))."""
    return waved(stretched(skewed(oscillated(x - at.optimum), 0.2), 10.0))


def bueche_rastrigin(x: Point, at: Instance) -> Value:
    """f4: as f3 with z = s T_osz(x - x_opt), plus 100 f_pen(x).

    s is that of Λ¹⁰, ten times as much for every second coordinate, from the first, where positive.
    """
    z = oscillated(x - at.optimum)
    steep = (z > 0) & (jnp.arange(len(z)) % 2 == 0)
    return waved(stretched(z, 10.0) * jnp.where(steep, 10, 1).astype(z.dtype)) + 100 * penalty(x)


def linear_slope(x: Point, at: Instance) -> Value:
    """f5: Σ 5|s| - s z, s = sign(x_opt) 10^(i/(D - 1)); z = x, beyond the optimum x_opt.

    Computed as |s| (5 - |z|) signed, which is 0 at the optimum without any rounding.
    """
    steepness = jnp.asarray(10 ** shares(len(x)), x.dtype)
    return (steepness * jnp.maximum(5 - jnp.sign(at.optimum) * x, 0)).sum()


def attractive_sector(x: Point, at: Instance) -> Value:
    """f6: T_osz(Σ (s z)²)^0.9, z = R Λ¹⁰ Q (x - x_opt); s = 100 where z x_opt > 0, else 1."""
    z = at.R @ stretched(at.Q @ (x - at.optimum), 10.0)
    scaled = jnp.where(z * at.optimum > 0, 100 * z, z)
    return oscillated((scaled**2).sum()) ** 0.9


def step_ellipsoid(x: Point, at: Instance) -> Value:
    """f7: 0.1 max(|ẑ₁|/10⁴, Σ 10^(2 i/(D - 1)) z²) + f_pen(x), plateaus of an ellipsoid.

    ẑ = Λ¹⁰ Q (x - x_opt), rounded to whole numbers, within ±0.5 to tenths, and then z = R z̃.
    """
    steep = stretched(at.Q @ (x - at.optimum), 10.0)
    rounded = jnp.where(jnp.abs(steep) > 0.5, nearest(steep), nearest(10 * steep) / 10)
    z = at.R @ rounded
    weights = jnp.asarray(100 ** shares(len(z)), z.dtype)
    return 0.1 * jnp.maximum(jnp.abs(steep[0]) / 1e4, (weights * z**2).sum()) + penalty(x)


def rosenbrock(x: Point, at: Instance) -> Value:
    """f8: Σ 100 (z_i² - z_(i+1))² + (z_i - 1)², z = max(1, √D/8) (x - x_opt) + 1."""
    return valley(widening(len(x)) * (x - at.optimum) + 1).sum()


def rosenbrock_rotated(x: Point, at: Instance) -> Value:
    """f9: as f8 with z = max(1, √D/8) Q x + ½."""
    return valley(widening(len(x)) * (at.Q @ x) + 0.5).sum()


def ellipsoid_rotated(x: Point, at: Instance) -> Value:
    """f10: as f2 with z = T_osz(R (x - x_opt))."""
    return _ellipsoid(oscillated(at.R @ (x - at.optimum)))


def discus(x: Point, at: Instance) -> Value:
    """f11: 10⁶ z₁² + Σ_(i>1) z_i², z = T_osz(R (x - x_opt))."""
    squares = oscillated(at.R @ (x - at.optimum)) ** 2
    return 1e6 * squares[0] + squares[1:].sum()


def bent_cigar(x: Point, at: Instance) -> Value:
    """f12: z₁² + 10⁶ Σ_(i>1) z_i², z = R T_asy^0.5(R (x - x_opt))."""
    squares = (at.R @ skewed(at.R @ (x - at.optimum), 0.5)) ** 2
    return squares[0] + 1e6 * squares[1:].sum()


def sharp_ridge(x: Point, at: Instance) -> Value:
    """f13: z₁² + 100 √Σ_(i>1) z_i², z = R Λ¹⁰ Q (x - x_opt)."""
    squares = (at.R @ stretched(at.Q @ (x - at.optimum), 10.0)) ** 2
    return squares[0] + 100 * jnp.sqrt(squares[1:].sum())


def different_powers(x: Point, at: Instance) -> Value:
    """f14: √Σ |z|^(2 + 4 i/(D - 1)), z = R (x - x_opt)."""
    z = at.R @ (x - at.optimum)
    return jnp.sqrt((jnp.abs(z) ** jnp.asarray(2 + 4 * shares(len(z)), z.dtype)).sum())


def waved(z: Point) -> Value:
    """Rastrigin's sum, 10 (D - Σ cos 2πz) + ‖z‖²."""
    return 10 * (len(z) - jnp.cos(2 * jnp.pi * z).sum()) + (z**2).sum()


def valley(z: Point) -> Float[Array, "dim-1"]:
    """Rosenbrock's terms, 100 (z_i² - z_(i+1))² + (z_i - 1)²."""
    return 100 * (z[:-1] ** 2 - z[1:]) ** 2 + (z[:-1] - 1) ** 2


def widening(dim: int) -> float:
    """max(1, √D/8): keeps Rosenbrock's valley inside the box in many dimensions."""
    return max(1.0, dim**0.5 / 8)


def nearest(z: Array) -> Array:
    """Nearest whole number, halves up."""
    return jnp.floor(z + 0.5)


def _ellipsoid(z: Point) -> Value:
    return (jnp.asarray(1e6 ** shares(len(z)), z.dtype) * z**2).sum()
