"""CMA-ES: the tutorial's equations step by step in plain NumPy, and what its forms are for."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.errors import InputError
from jaxsusp.optim.algorithms import cmaes
from jaxsusp.optim.algorithms.cmaes import draw, gaussian, learn, parameters

DIM, COUNT = 6, 12


def warm(random: np.random.Generator) -> cmaes.Gaussian:
    """A distribution that has learned something."""
    root = random.normal(size=(DIM, DIM))
    first = gaussian(jnp.zeros(DIM), jnp.full(DIM, 0.3), False)
    return first._replace(
        covariance=jnp.asarray(root @ root.T + np.eye(DIM)), generation=jnp.asarray(3, jnp.int32),
        path_sigma=jnp.asarray(random.normal(size=DIM)),
        path_c=jnp.asarray(random.normal(size=DIM)),
    )  # fmt: skip


@pytest.mark.fast
@pytest.mark.parametrize("seed", range(5))
def test_a_generation_is_that_of_the_tutorial(seed):
    """Eq. 41-47 written out, with C^-½ replaced by A⁻¹ where A Aᵀ = C (Krause et al. 2016)."""
    random = np.random.default_rng(seed)
    g, p = warm(random), parameters(DIM, COUNT, diagonal=False)
    x, fitness = random.normal(size=(COUNT, DIM)), random.normal(size=COUNT)
    new = learn(g, jnp.asarray(x), jnp.asarray(fitness))

    C, sigma = np.asarray(g.covariance), float(g.sigma)
    inverse = np.linalg.inv(np.linalg.cholesky(C))
    y = x[np.argsort(fitness)] / sigma
    step = sum(w * each for w, each in zip(p.weights[: p.parents], y, strict=False))
    path = (1 - p.c_sigma) * np.asarray(g.path_sigma)
    path = path + np.sqrt(p.c_sigma * (2 - p.c_sigma) * p.mass) * inverse @ step
    grown = np.exp(p.c_sigma / p.d_sigma * (np.linalg.norm(path) / p.length - 1))
    fresh = np.sqrt(1 - (1 - p.c_sigma) ** (2 * 4))
    h = float(np.linalg.norm(path) / fresh < (1.4 + 2 / (DIM + 1)) * p.length)
    path_c = (1 - p.c_c) * np.asarray(g.path_c)
    path_c = path_c + h * np.sqrt(p.c_c * (2 - p.c_c) * p.mass) * step
    wanted = (1 + p.c_1 * (1 - h) * p.c_c * (2 - p.c_c) - p.c_1 - p.c_mu * p.weights.sum()) * C
    wanted = wanted + p.c_1 * np.outer(path_c, path_c)
    for w, each in zip(p.weights, y, strict=True):
        scale = 1 if w >= 0 else DIM / np.sum((inverse @ each) ** 2)
        wanted = wanted + p.c_mu * w * scale * np.outer(each, each)

    np.testing.assert_allclose(new.mean, sigma * step, rtol=1e-9)
    np.testing.assert_allclose(new.sigma, sigma * grown, rtol=1e-9)
    np.testing.assert_allclose(new.path_sigma, path, rtol=1e-9)
    np.testing.assert_allclose(new.path_c, path_c, rtol=1e-9)
    np.testing.assert_allclose(new.covariance, wanted, rtol=1e-9, atol=1e-12)


@pytest.mark.fast
def test_candidates_are_drawn_from_the_distribution():
    g = warm(np.random.default_rng(0))
    x = np.asarray(draw(jax.random.key(0), g, 200_000))
    wanted = float(g.sigma) ** 2 * np.asarray(g.covariance)
    np.testing.assert_allclose(np.cov(x.T), wanted, atol=0.02 * np.abs(wanted).max())
    np.testing.assert_allclose(x.mean(axis=0), g.mean, atol=0.01)


@pytest.mark.fast
def test_a_diagonal_learns_what_the_diagonal_of_a_full_one_would():
    random = np.random.default_rng(1)
    x, fitness = (
        jnp.asarray(random.normal(size=(COUNT, DIM))),
        jnp.asarray(random.normal(size=COUNT)),
    )
    spread = jnp.asarray(random.uniform(0.1, 1, DIM))
    new = learn(gaussian(jnp.zeros(DIM), spread, True), x, fitness)
    assert new.covariance.shape == (DIM,)
    p = parameters(DIM, COUNT, diagonal=True)
    assert p.c_mu == pytest.approx(parameters(DIM, COUNT, False).c_mu * (DIM + 2) / 3)
    assert (np.asarray(new.covariance) > 0).all()


def rotated_ellipsoid(x):
    """Condition 1e6, axes askew."""
    dim = x.shape[-1]
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(dim, dim)))[0]
    along = jnp.asarray(turn, x.dtype) @ x
    return (jnp.asarray(10.0 ** np.linspace(0, 6, dim), x.dtype) * along**2).sum()


def test_a_full_covariance_learns_axes_that_are_askew():
    limit = np.full(8, 3.0)
    problem = js.Problem(rotated_ellipsoid, -limit, limit)
    settings = {"runs": 4, "iterations": 250, "population": 16}
    full = js.minimize(problem, js.cmaes(), **settings).fitness
    diagonal = js.minimize(problem, js.cmaes(separable=True), **settings).fitness
    assert full.max() < 1e-8
    assert diagonal.min() > 1e-2


def test_above_a_hundred_variables_the_covariance_is_diagonal():
    for dim, separable in ((100, False), (101, True)):
        problem = js.Problem(lambda x: (x**2).sum(), -np.ones(dim), np.ones(dim))
        state = jax.eval_shape(
            lambda key, problem=problem: js.cmaes().init(key, problem, 8, 10), jax.random.key(0)
        )
        assert (state.gaussian.covariance.ndim == 1) == separable


@pytest.mark.fast
@pytest.mark.parametrize("name", ["cmaes", "jde", "routed"])
def test_a_population_that_is_too_small_is_refused(name):
    problem = js.Problem(lambda x: (x**2).sum(), -np.ones(2), np.ones(2))
    with pytest.raises(InputError, match=f"population of {name} = 3: .*at least 4"):
        js.minimize(problem, name, population=3)


@pytest.mark.parametrize("wide", [False, True])
def test_a_covariance_that_rounding_made_indefinite_still_has_a_factor(wide):
    """Its columns beside a lost variance would be taken for spread of any size."""
    with jax.enable_x64(wide):
        C = jnp.asarray([[1.0, 1.0, 0.5], [1.0, 1.0, 0.3], [0.5, 0.3, 1.0]])  # λ of -0.02, 0.9, 2.1
        candidates = draw(jax.random.key(0), gaussian(jnp.zeros(3), jnp.ones(3), False)._replace(
            covariance=C), 10_000)  # fmt: skip
    np.testing.assert_allclose(np.std(candidates, axis=0), [1, 1, 1], atol=0.1)
