"""f15 to f24: many optima, with a structure that leads to the best one, and with little of it.

As `unimodal`: pure functions of one point and an `Instance`, 0 at the optimum, formulas of RR-6829.
"""

import jax.numpy as jnp
import numpy as np

from jaxsusp.studies.bbob.instances import PEAKS, SCHWEFEL, Instance
from jaxsusp.studies.bbob.transformations import oscillated, penalty, skewed, stretched
from jaxsusp.studies.bbob.unimodal import Point, Value, nearest, valley, waved, widening


def rastrigin_rotated(x: Point, at: Instance) -> Value:
    """f15: as f3 with z = R Λ¹⁰ Q T_asy^0.2(T_osz(R (x - x_opt)))."""
    bumpy = skewed(oscillated(at.R @ (x - at.optimum)), 0.2)
    return waved(at.R @ stretched(at.Q @ bumpy, 10.0))


def weierstrass(x: Point, at: Instance) -> Value:
    """f16: 10 (1/D ΣΣ_(k<12) cos(2π 3^k (z + ½))/2^k - f₀)³ + 10/D f_pen(x).

    z = R Λ^(1/100) Q T_osz(R (x - x_opt)); f₀ = Σ cos(π 3^k)/2^k = -Σ 1/2^k.
    """
    z = at.R @ stretched(at.Q @ oscillated(at.R @ (x - at.optimum)), 0.01)
    k = np.arange(12)
    halves, thirds = (jnp.asarray(row[:, None], x.dtype) for row in (0.5**k, 3.0**k))
    sums = (jnp.cos(2 * jnp.pi * (z + 0.5)[None] * thirds) * halves).sum()
    return 10 * (sums / len(z) + float((0.5**k).sum())) ** 3 + 10 / len(z) * penalty(x)


def schaffers(x: Point, at: Instance) -> Value:
    """f17: (1/(D - 1) Σ √s + √s sin²(50 s^0.2))² + 10 f_pen(x), s = √(z_i² + z_(i+1)²).

    z = Λ¹⁰ Q T_asy^0.5(R (x - x_opt)).
    """
    return _schaffers(x, at, 10.0)


def schaffers_ill_conditioned(x: Point, at: Instance) -> Value:
    """f18: as f17 with Λ¹⁰⁰⁰."""
    return _schaffers(x, at, 1000.0)


def griewank_rosenbrock(x: Point, at: Instance) -> Value:
    """f19: 10/(D - 1) Σ (s/4000 - cos s) + 10, s Rosenbrock's terms of z of f9."""
    s = valley(widening(len(x)) * (at.Q @ x) + 0.5)
    return 10 * (s / 4000 - jnp.cos(s)).sum() / len(s) + 10


def schwefel(x: Point, at: Instance) -> Value:
    """f20: 4.1898… - 1/(100 D) Σ z sin √|z| + 100 f_pen(z/100).

    x̂ = 2 sign(x_opt) x; ẑ_i = x̂_i + ¼ (x̂_(i-1) - 2|x_opt|); z = 100 (Λ¹⁰(ẑ - 2|x_opt|) + 2|x_opt|).
    """
    middle = _SCHWEFEL
    flipped = 2 * jnp.sign(at.optimum) * x
    leaning = jnp.concatenate([flipped[:1], flipped[1:] + 0.25 * (flipped[:-1] - middle)])
    z = 100 * (stretched(leaning - middle, 10.0) + middle)
    waves = (z * jnp.sin(jnp.sqrt(jnp.abs(z)))).sum() / len(z)
    return 0.01 * (penalty(z, 500.0) + 418.9828872724339 - waves)


def gallagher_101(x: Point, at: Instance) -> Value:
    """f21: T_osz(10 - max w exp(-zᵀ C z / 2D))² + f_pen(x), z = Q (x - y), over 101 peaks y."""
    return _gallagher(x, at, PEAKS)


def gallagher_21(x: Point, at: Instance) -> Value:
    """f22: as f21 with 21 peaks, and a narrow highest one."""
    return _gallagher(x, at, 21)


def katsuura(x: Point, at: Instance) -> Value:
    """f23: 10/D² (Π (1 + (i + 1) Σ_(j=1…32) |2^j z - [2^j z]|/2^j)^(10/D^1.2) - 1) + f_pen(x).

    z = R Λ¹⁰⁰ Q (x - x_opt).
    """
    z = at.R @ stretched(at.Q @ (x - at.optimum), 100.0)
    dim = len(z)
    powers = jnp.asarray(2.0 ** np.arange(1, 33), z.dtype)[:, None]
    teeth = powers * z[None]
    rough = (jnp.abs(teeth - nearest(teeth)) / powers).sum(axis=0)
    product = (1 + jnp.arange(1, dim + 1).astype(z.dtype) * rough).prod()
    return 10 / dim**2 * (product ** (10 / dim**1.2) - 1) + penalty(x)


def lunacek(x: Point, at: Instance) -> Value:
    """f24: min(Σ (x̂ - μ₀)², D + s Σ (x̂ - μ₁)²) + 10 (D - Σ cos 2πz) + 10⁴ f_pen(x).

    x̂ = 2 sign(x_opt) x; z = R Λ¹⁰⁰ Q (x̂ - μ₀); μ₀ = 2.5, μ₁ = -√((μ₀² - 1)/s),
    s = 1 - 1/(2 √(D + 20) - 8.2).
    """
    dim, near = len(x), 2.5
    s = 1 - 1 / (2 * (dim + 20) ** 0.5 - 8.2)
    far = -(((near**2 - 1) / s) ** 0.5)
    flipped = 2 * jnp.sign(at.optimum) * x
    z = at.R @ stretched(at.Q @ (flipped - near), 100.0)
    funnels = jnp.minimum(((flipped - near) ** 2).sum(), dim + s * ((flipped - far) ** 2).sum())
    return funnels + 10 * (dim - jnp.cos(2 * jnp.pi * z).sum()) + 1e4 * penalty(x)


_SCHWEFEL = SCHWEFEL + 4e-10
"""2|x_opt| as f20 is computed with, a digit away from where COCO says that its optimum is."""


def _schaffers(x: Point, at: Instance, condition: float) -> Value:
    z = stretched(at.Q @ skewed(at.R @ (x - at.optimum), 0.5), condition)
    squares = z[:-1] ** 2 + z[1:] ** 2
    terms = squares**0.25 * (1 + jnp.sin(50 * squares**0.1) ** 2)
    return terms.mean() ** 2 + 10 * penalty(x)


def _gallagher(x: Point, at: Instance, count: int) -> Value:
    z = (at.Q @ x)[None] - at.centers[:count]
    exponents = (at.widths[:count] * z**2).sum(axis=1) / (-2 * len(x))
    peak = (at.heights[:count] * jnp.exp(exponents)).max()
    return oscillated(10 - peak) ** 2 + penalty(x)
