"""Covariance matrix adaptation (Hansen 2016, "The CMA Evolution Strategy: A Tutorial", Fig. 6).

Numbers of equations are the tutorial's (arXiv:1604.00772), with its default parameters (Table 1)
and negative weights. Variables are measured in shares of their ranges. Above `SEPARABLE` variables
the covariance is diagonal (Ros & Hansen 2008): a full one takes D² numbers and as many generations
to be learned.

The square root of the covariance is its Cholesky factor rather than the symmetric one (Krause,
Arbonès & Igel 2016): LAPACK's eigenvectors, called matrix by matrix, cost more than the search.

A candidate is repaired before it is evaluated, and the distribution learns from the repaired
point: otherwise it would drift to where every candidate is repaired to the same place.
"""

import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxsusp._types import Array, Float, Key
from jaxsusp.errors import require_count
from jaxsusp.optim.base import Best, Clock, NoInfo, Optimizer, best_of, better, chosen_of
from jaxsusp.problem.problem import Problem

SEPARABLE = 100
"""Variables above which the covariance is diagonal unless asked otherwise."""

LEAST = 4
"""Smallest population: two parents."""


class CmaCoefficients(NamedTuple):
    """What the tutorial leaves to the user."""

    step: float = 0.3  # σ at first, in shares of the range (its appendix B.2)


class Parameters(NamedTuple):
    """Default strategy parameters of a dimension and a population (Table 1)."""

    weights: np.ndarray  # w_i, the best candidate's first; those of the worse half negative
    parents: int  # μ
    mass: float  # μ_eff
    c_sigma: float
    d_sigma: float
    c_c: float
    c_1: float
    c_mu: float
    length: float  # E‖N(0, I)‖


class Gaussian(NamedTuple):
    """The search distribution N(m, σ² C) and what its adaptation remembers."""

    mean: Float[Array, "dim"]  # m, in shares of the range
    sigma: Float[Array, ""]
    covariance: Float[Array, "*square"]  # C, (dim, dim), or its diagonal (dim,)
    path_sigma: Float[Array, "dim"]  # p_σ
    path_c: Float[Array, "dim"]  # p_c
    generation: Array  # g


class CmaState(NamedTuple):
    """The distribution and the best candidate so far."""

    gaussian: Gaussian
    fitness: Float[Array, "pop"]  # of the latest candidates
    best: Best
    clock: Clock


def cmaes(separable: bool | None = None, **coefficients: float) -> Optimizer:
    """Covariance matrix adaptation evolution strategy (Hansen 2016).

    Args:
        separable: whether the covariance is diagonal; default above 100 variables.
        **coefficients: any field of `CmaCoefficients`.

    Returns:
        The optimiser named "cmaes" ("cmaes-separable" or "cmaes-full" where that was asked for).
    """
    name, init = _FORMS[separable]
    chosen = chosen_of("cmaes", CmaCoefficients, coefficients)
    return Optimizer(name, Partial(init, chosen), Partial(_step, chosen))


def _init(coefficients, key, problem: Problem, population: int, iterations, diagonal=None):
    """The best of a uniform population is the first mean."""
    require_count("population of cmaes", population, least=LEAST)
    x = problem.sample(key, population)
    fitness = problem.evaluate(x)
    best = best_of(x, fitness)
    diagonal = problem.dim > SEPARABLE if diagonal is None else diagonal
    mean = to_unit(problem, best.x[None])[0]
    first = gaussian(mean, jnp.full_like(mean, coefficients.step), diagonal)
    return CmaState(first, fitness, best, Clock.start(iterations))


def _init_diagonal(*arguments) -> CmaState:
    return _init(*arguments, diagonal=True)


def _init_full(*arguments) -> CmaState:
    return _init(*arguments, diagonal=False)


_FORMS = {
    None: ("cmaes", _init),
    True: ("cmaes-separable", _init_diagonal),
    False: ("cmaes-full", _init_full),
}


def _step(coefficients, key, problem: Problem, state: CmaState) -> tuple[CmaState, NoInfo]:
    del coefficients
    drawn = draw(key, state.gaussian, len(state.fitness))
    x = problem.repair(from_unit(problem, drawn))
    fitness = problem.evaluate(x)
    learned = learn(state.gaussian, to_unit(problem, x), fitness)
    best = better(best_of(x, fitness), state.best)
    return CmaState(learned, fitness, best, state.clock.tick()), NoInfo()


def to_unit(problem: Problem, x: Float[Array, "pop dim"]) -> Float[Array, "pop dim"]:
    """Points in shares of the range of every variable."""
    return (x - problem.low) / (problem.high - problem.low)


def from_unit(problem: Problem, share: Float[Array, "pop dim"]) -> Float[Array, "pop dim"]:
    """Points of the problem from shares of the range."""
    return problem.low + share * (problem.high - problem.low)


def gaussian(mean: Float[Array, "dim"], spread: Float[Array, "dim"], diagonal: bool) -> Gaussian:
    """A distribution about a point with a standard deviation for every variable."""
    sigma = jnp.sqrt((spread**2).mean())
    squares, still = (spread / sigma) ** 2, jnp.zeros_like(mean)
    C = squares if diagonal else jnp.diag(squares)
    return Gaussian(mean, sigma, C, still, still, jnp.asarray(0, jnp.int32))


def draw(key: Key[Array, ""], g: Gaussian, count: int) -> Float[Array, "pop dim"]:
    """Candidates m + σ y with y = A z ~ N(0, C), A Aᵀ = C (Eq. 38-40)."""
    z = jax.random.normal(key, (count, g.mean.shape[-1]), g.mean.dtype)
    return g.mean[None] + g.sigma * _root(g.covariance).colour(z)


def learn(g: Gaussian, x: Float[Array, "pop dim"], fitness: Float[Array, "pop"]) -> Gaussian:
    """The distribution after candidates have been evaluated (Eq. 41-47)."""
    count, dim = x.shape
    p = parameters(dim, count, g.covariance.ndim == 1)
    dtype, root = x.dtype, _root(g.covariance)
    y = (x[jnp.argsort(fitness, stable=True)] - g.mean[None]) / g.sigma
    weights = jnp.asarray(p.weights, dtype)
    step = weights[: p.parents] @ y[: p.parents]  # Eq. 41
    mean = g.mean + g.sigma * step  # Eq. 42

    keep = p.c_sigma * (2 - p.c_sigma) * p.mass
    path_sigma = (1 - p.c_sigma) * g.path_sigma + keep**0.5 * root.whiten(step)  # Eq. 43
    length = jnp.sqrt((path_sigma**2).sum())
    sigma = g.sigma * jnp.exp(p.c_sigma / p.d_sigma * (length / p.length - 1))  # Eq. 44

    generation = g.generation + 1
    fresh = 1 - (1 - p.c_sigma) ** (2 * generation.astype(dtype))
    # h_σ: the evolution path stands still while the step size is growing fast
    h = (length < (1.4 + 2 / (dim + 1)) * p.length * jnp.sqrt(fresh)).astype(dtype)
    keep = p.c_c * (2 - p.c_c) * p.mass
    path_c = (1 - p.c_c) * g.path_c + h * keep**0.5 * step  # Eq. 45
    lost = p.c_1 * (1 - h) * p.c_c * (2 - p.c_c)  # δ(h_σ)
    squares = (root.whiten(y) ** 2).sum(axis=1)
    scaled = jnp.where(weights < 0, weights * dim / jnp.maximum(squares, 1e-12), weights)  # Eq. 46
    old = 1 + lost - p.c_1 - p.c_mu * float(p.weights.sum())
    C = (
        old * g.covariance + p.c_1 * root.outer(path_c[None], jnp.ones(1, dtype))
        + p.c_mu * root.outer(y, scaled)
    )  # Eq. 47  # fmt: skip
    return Gaussian(
        mean, jnp.clip(sigma, _RESOLVED[dtype.name], 1.0), C, path_sigma, path_c, generation
    )


class _Full(NamedTuple):
    """C = A Aᵀ, A lower triangular."""

    factor: Float[Array, "dim dim"]

    def colour(self, z: Array) -> Array:
        """A z of rows."""
        return z @ self.factor.T

    def whiten(self, y: Array) -> Array:
        """A⁻¹ y of rows, by forward substitution."""

        def solve(j, z):
            rest = y[..., j] - z @ self.factor[j]
            return z.at[..., j].set(rest / self.factor[j, j])

        return jax.lax.fori_loop(0, y.shape[-1], solve, jnp.zeros_like(y))

    @staticmethod
    def outer(rows: Array, weights: Array) -> Array:
        """Σ w y yᵀ."""
        return (rows.T * weights[None]) @ rows


class _Diagonal(NamedTuple):
    """C = D²."""

    lengths: Float[Array, "dim"]

    def colour(self, z: Array) -> Array:
        """D z of rows."""
        return z * jnp.broadcast_to(self.lengths, z.shape)

    def whiten(self, y: Array) -> Array:
        """D^-1 y of rows."""
        return y / jnp.broadcast_to(self.lengths, y.shape)

    @staticmethod
    def outer(rows: Array, weights: Array) -> Array:
        """The diagonal of Σ w y yᵀ."""
        return weights @ rows**2


def _root(C: Array) -> _Full | _Diagonal:
    """A square root of a covariance."""
    if C.ndim == 1:
        return _Diagonal(jnp.sqrt(jnp.maximum(C, _TINY)))
    dim, least = len(C), jnp.maximum(_RESOLVED[C.dtype.name] * jnp.diagonal(C).max(), _TINY)

    def column(j, factor):  # LAPACK's would be called matrix by matrix, outside the program
        rest = C[:, j] - factor @ factor[j]
        # What rounding has left of a variance says nothing of those that go with it.
        beside = jnp.where(rest[j] < least, 0, rest)
        rest = jnp.where(jnp.arange(dim) == j, jnp.maximum(rest[j], least), beside)
        rest = jnp.where(jnp.arange(dim) < j, 0, rest)
        return factor.at[:, j].set(rest / jnp.sqrt(rest[j]))

    return _Full(jax.lax.fori_loop(0, dim, column, jnp.zeros_like(C)))


_TINY = 1e-20
"""What a variance is at least."""

_RESOLVED = {"float32": 1e-7, "float64": 1e-14}
"""What σ is at least, and a variance as a share of the greatest: as much as numbers resolve."""


def parameters(dim: int, population: int, diagonal: bool) -> Parameters:
    """Table 1 and Eq. 49-58; a diagonal learns (D + 2) / 3 times as fast (Ros & Hansen 2008)."""
    n, count = dim, population
    raw = np.log((count + 1) / 2) - np.log(np.arange(1, count + 1))  # Eq. 49
    parents = count // 2
    mass = float(raw[:parents].sum() ** 2 / (raw[:parents] ** 2).sum())
    behind = float(raw[parents:].sum() ** 2 / (raw[parents:] ** 2).sum())  # of the worse half
    c_sigma = (mass + 2) / (n + mass + 5)
    d_sigma = 1 + 2 * max(0.0, math.sqrt((mass - 1) / (n + 1)) - 1) + c_sigma
    c_c = (4 + mass / n) / (n + 4 + 2 * mass / n)
    c_1 = 2 / ((n + 1.3) ** 2 + mass)
    c_mu = min(1 - c_1, 2 * (0.25 + mass + 1 / mass - 2) / ((n + 2) ** 2 + mass))
    if diagonal:
        c_1, c_mu = (min(0.5, c * (n + 2) / 3) for c in (c_1, c_mu))
    negative = min(1 + c_1 / c_mu, 1 + 2 * behind / (mass + 2), (1 - c_1 - c_mu) / (n * c_mu))
    better, worse = raw[raw >= 0].sum(), -raw[raw < 0].sum()
    weights = np.where(raw >= 0, raw / better, negative * raw / worse)  # Eq. 53
    length = math.sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n**2))
    return Parameters(weights, parents, mass, c_sigma, d_sigma, c_c, c_1, c_mu, length)
