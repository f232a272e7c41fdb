"""Hooks with more than three cables against scipy: quadratic program, linear program, balance."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import linprog, lsq_linear

import jaxsusp as js
from jaxsusp.mechanics.tensiondistribution import distribute
from jaxsusp.vec3 import Vec3

LOW, HIGH = 1.0, 100.0
MOST = 4096
"""Systems that are solved together: fewer are repeated, so that all tests share a program per K."""

solve = jax.jit(distribute)


def systems(cables: int, count: int, seed: int = 0):
    """Unit vectors (n, K, 3) to random ends and forces (n, 3): some have a balance, some none."""
    rng = np.random.default_rng(seed)
    ends = rng.uniform([-6, -6, 4], [6, 6, 9], (count, cables, 3))
    vectors = ends - rng.uniform([-4, -4, 0.3], [4, 4, 4], (count, 1, 3))
    units = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return units, rng.normal((0, 0, 98.1), 5, (count, 3))


def tensions_of(units, force, dtype=np.float64):
    every = np.resize(np.arange(len(units)), MOST)
    given = np.concatenate([units, force[:, None]], axis=1)[every].astype(dtype)
    *rows, pull = (Vec3(*np.ascontiguousarray(given[:, k].T)) for k in range(given.shape[1]))
    return np.stack(solve(rows, pull, dtype(LOW), dtype(HIGH)), axis=-1)[: len(units)]


@pytest.mark.parametrize("cables", [4, 6])
def test_an_admissible_balance_is_found_wherever_one_exists(cables):
    units, force = systems(cables, 400)
    found = tensions_of(units, force)
    within = ((found >= LOW - 1e-9) & (found <= HIGH + 1e-9)).all(axis=-1)
    exists = np.array(
        [
            linprog(np.zeros(cables), A_eq=u.T, b_eq=f, bounds=[(LOW, HIGH)] * cables).success
            for u, f in zip(units, force, strict=True)
        ]
    )
    assert 0.2 < exists.mean() < 0.8
    np.testing.assert_array_equal(within, exists)


@pytest.mark.parametrize("cables", [4, 5, 6, 8])
def test_forces_balance_even_where_no_tension_is_admissible(cables):
    units, force = systems(cables, 2000)
    supplied = np.einsum("nki,nk->ni", units, tensions_of(units, force))
    # Nearly coplanar cables give tensions of any size; the balance is as good as they allow.
    spread = np.linalg.svd(units, compute_uv=False)[:, 2]
    np.testing.assert_allclose(supplied[spread > 0.05], force[spread > 0.05], atol=1e-9)


@pytest.mark.parametrize("cables", [4, 6])
def test_it_is_the_admissible_balance_nearest_to_the_middle_of_the_range(cables):
    units, force = systems(cables, 150, seed=1)
    found = tensions_of(units, force)
    middle, checked = (LOW + HIGH) / 2, 0
    for u, f, t in zip(units, force, found, strict=True):
        if t.min() < LOW - 1e-9 or t.max() > HIGH + 1e-9:
            continue
        # scipy: the balance as a heavily weighted least-squares row block, polished by its scale.
        weight = 1e5
        rows = np.vstack([weight * u.T, np.eye(cables)])
        goal = np.concatenate([weight * f, np.full(cables, middle)])
        nearest = lsq_linear(rows, goal, (LOW, HIGH), method="bvls", tol=1e-14).x
        assert np.linalg.norm(t - middle) <= np.linalg.norm(nearest - middle) + 1e-4
        np.testing.assert_allclose(t, nearest, atol=2e-3)
        checked += 1
    assert checked > 30


def test_away_from_all_limits_it_is_the_right_inverse_plus_the_null_space_part(scenarios):
    """T = A⁺F + (I - A⁺A) T_mid (Eq. 7 read for K > 3)."""
    units, force = systems(5, 500)
    found = tensions_of(units, force)
    inside = ((found > LOW + 1) & (found < HIGH - 1)).all(axis=-1)
    assert inside.sum() > 20
    for u, f, t in zip(units[inside], force[inside], found[inside], strict=True):
        inverse = u @ np.linalg.inv(u.T @ u)  # Aᵀ(AAᵀ)⁻¹ with A = uᵀ
        middle = np.full(5, (LOW + HIGH) / 2)
        expected = inverse @ f + (np.eye(5) - inverse @ u.T) @ middle
        np.testing.assert_allclose(t, expected, atol=1e-8)


def test_three_cables_leave_no_choice(scenarios):
    units, force = systems(3, 200)
    exact = np.linalg.solve(units.transpose(0, 2, 1), force[..., None])[..., 0]
    good = np.linalg.svd(units, compute_uv=False)[:, 2] > 0.1
    np.testing.assert_allclose(tensions_of(units, force)[good], exact[good], atol=1e-7)


def test_it_is_continuous_where_limits_come_and_go():
    """Along a way on which cables reach and leave their limits no tension jumps."""
    angle = np.deg2rad([45, 135, 225, 315, 0])
    ends = np.stack([6 * np.cos(angle), 6 * np.sin(angle), [7, 7, 7, 7, 6]], axis=1)
    s = np.linspace(0, 1, 4001)[:, None]
    hook = (1 - s) * [-2.6, 1.5, 1.0] + s * [2.6, -1.0, 4.0]
    vectors = ends - hook[:, None]
    units = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    found = tensions_of(units, np.tile([0, 0, 180.0], (len(s), 1)))
    at_limit = np.isclose(found, LOW) | np.isclose(found, HIGH)
    assert (at_limit.any(axis=0) & ~at_limit.all(axis=0)).sum() >= 2
    assert np.abs(np.diff(found, axis=0)).max() < 0.5


def test_single_precision_agrees():
    units, force = systems(4, 1000)
    double, single = tensions_of(units, force), tensions_of(units, force, np.float32)
    within = ((double >= LOW - 1e-9) & (double <= HIGH + 1e-9)).all(axis=-1)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single[within], double[within], atol=2e-3)


def test_its_gradient_is_that_of_finite_differences():
    units, force = systems(5, 40, seed=3)
    rows = [Vec3.from_array(jnp.asarray(units[:, k])) for k in range(5)]

    def total(scale):
        pull = Vec3.from_array(jnp.asarray(force) * scale)
        found = distribute(rows, pull, jnp.asarray(LOW), jnp.asarray(HIGH))
        return jnp.stack(found, axis=-1)

    values, slopes = jax.jvp(jax.jit(total), (jnp.asarray(1.0),), (jnp.asarray(1.0),))
    h = 1e-6
    more, less = (tensions_of(units, force * scale) for scale in (1 + h, 1 - h))
    within = np.asarray(((values >= LOW) & (values <= HIGH)).all(axis=-1))
    assert within.sum() > 8
    np.testing.assert_allclose(slopes[within], ((more - less) / (2 * h))[within], atol=1e-3)


def test_a_scenario_with_four_robots_balances_within_its_limits():
    scenario = js.load_scenario("four-robots")
    line = np.linspace(scenario.task.start, scenario.task.goal, 40)
    found = np.asarray(js.tensions(scenario, line))
    hook = np.add(line, (0, 0, scenario.payload.height / 2))
    vectors = np.array([robot.end for robot in scenario.robots]) - hook[:, None]
    units = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    supplied = np.einsum("nki,nk->ni", units, found)
    np.testing.assert_allclose(supplied - [0, 0, 16 * 9.81], 0, atol=1e-9)
    assert found.min() >= 1
    assert found.max() <= 100
