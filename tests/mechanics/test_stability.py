"""Stability factor S_c against its definition and scipy's convex hull."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from jaxsusp.mechanics.stability import polygon_gauge, stability, stability_factors
from jaxsusp.problem.fitness import waypoint_stability
from jaxsusp.scenario.world import build_world
from jaxsusp.suspension.levelload import tensions_at
from jaxsusp.vec3 import Vec3


def vec(rows) -> Vec3:
    return Vec3(*np.moveaxis(np.asarray(rows, np.float64), -1, 0))


gauge = polygon_gauge
POINTS = 200
"""How many positions are looked at, everywhere, so that polygons of one size share a program."""


def test_gauge_of_a_triangle_is_barycentric():
    """1 - ρ = 3 min_k w_k for three ends."""
    ends = np.array([[0, 6, 7], [-5, -3, 7], [5.5, -2, 7.0]])
    points = np.random.default_rng(0).uniform(-3, 3, (POINTS, 3))
    system = np.vstack([ends[:, :2].T, np.ones(3)])
    weights = np.linalg.solve(system, np.vstack([points[:, :2].T, np.ones(POINTS)]))
    np.testing.assert_allclose(
        gauge(vec(points), vec(ends)), 1 - 3 * weights.min(axis=0), atol=1e-12
    )


@given(st.integers(0, 10_000), st.integers(3, 7))
@settings(deadline=None, max_examples=40)
def test_gauge_of_any_polygon_about_its_area_centroid(seed, count):
    rng = np.random.default_rng(seed)
    ends = rng.uniform(-5, 5, (count, 3))
    hull = ConvexHull(ends[:, :2])
    assume(hull.volume > 1)
    corners = ends[hull.vertices, :2]
    fan = [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    areas = [float(np.linalg.det([b - a, c - a])) / 2 for a, b, c in fan]
    centroid = sum(w * (a + b + c) / 3 for w, (a, b, c) in zip(areas, fan, strict=True)) / sum(
        areas
    )
    points = rng.uniform(-6, 6, (POINTS, 3))
    normals, offsets = hull.equations[:, :2], hull.equations[:, 2]
    reach = -(normals @ centroid + offsets)
    expected = np.maximum(0, (normals @ (points[:, :2] - centroid).T / reach[:, None]).max(axis=0))
    np.testing.assert_allclose(gauge(vec(points), vec(ends)), expected, rtol=1e-8, atol=1e-9)


def test_four_ends_with_one_on_an_edge_count_the_edge_once():
    square = [[0, 0, 7], [2, 0, 7], [2, 2, 7], [0, 2, 7.0]]
    middle = [1.0, 0.0, 7.0]
    points = np.random.default_rng(0).uniform(0, 2, (POINTS, 3))
    np.testing.assert_allclose(
        gauge(vec(points), vec([*square, middle])),
        gauge(vec(points), vec(square)),
        atol=1e-12,
    )


@pytest.mark.parametrize("dtype", ["float32", "float64"])
def test_compiled_as_one_program_no_edge_is_lost_to_rounding(dtype):
    """A compiler fuses products with sums: what is equal step by step differs in the last digit."""
    rng = np.random.default_rng(2)
    benchmark = [[0, 6, 7], [-5.1961524, -3, 7], [5.1961524, -3, 7.0]]
    fused = jax.jit(gauge)
    for ends in (benchmark, *rng.uniform(-5, 5, (4, 3, 3))):
        cast = [
            vec(rows).each(lambda c: jnp.asarray(c, dtype))
            for rows in (rng.uniform(-1, 1, (POINTS, 3)), ends)
        ]
        np.testing.assert_allclose(fused(*cast), gauge(*cast), rtol=1e-3)


def test_factors_by_hand():
    """At the centroid under level ends with equal tensions of half the range."""
    ends = vec([[0, 6, 7], [-(27**0.5), -3, 7], [27**0.5, -3, 7]])
    at = jnp.asarray(0.0)
    factors = stability_factors(
        Vec3(at, at, jnp.asarray(1.15)),
        ends,
        [jnp.asarray(50.5)] * 3,
        jnp.asarray(1.0),
        jnp.asarray(0.2),
        (jnp.asarray(1.0), jnp.asarray(100.0)),
    )
    assert float(factors.horizontal) == pytest.approx(1)
    assert float(factors.vertical) == pytest.approx((6 / 6.8) ** (1 / 3))
    assert float(factors.balance) == pytest.approx(1)
    assert float(factors.tension_margin) == pytest.approx(1)
    assert float(stability(factors)) == pytest.approx((1 + (6 / 6.8) ** (1 / 3)) / 2)


@pytest.mark.fast
def test_slack_unequal_and_undefined_tensions_earn_nothing():
    ends = vec([[0, 6, 7], [-5, -3, 7], [5, -3, 7.0]])
    at = jnp.asarray(0.0)
    for slack in (-1.0, 0.0, np.nan):
        tensions = [jnp.asarray(slack), jnp.asarray(50.0), jnp.asarray(60.0)]
        limits = (jnp.asarray(1.0), jnp.asarray(100.0))
        factors = stability_factors(Vec3(at, at, at), ends, tensions, at, jnp.asarray(-1.0), limits)
        assert float(factors.balance) == 0
        assert float(factors.tension_margin) == 0
        assert 0 <= float(stability(factors)) <= 1


def test_about_forty_per_cent_of_the_admissible_workspace_is_in_the_window(scenarios):
    """The share that `mechanics.stability` gives as the reason for its cube roots."""
    world = build_world(scenarios[0])
    rng = np.random.default_rng(0)
    points = rng.uniform(scenarios[0].workspace.lower, scenarios[0].workspace.upper, (20000, 3))
    _, tensions = jax.jit(tensions_at)(world, vec(points))
    tensions = np.array(tensions)
    admissible = ((tensions >= 1) & (tensions <= 100)).all(axis=0)
    factor = np.asarray(jax.jit(waypoint_stability)(world, points.ravel()))
    share = ((factor >= 0.6) & (factor <= 0.9))[admissible].mean()
    assert 0.35 < share < 0.45
    assert ((factor >= 0) & (factor <= 1)).all()
