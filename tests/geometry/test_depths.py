"""Depths against the tests of the same names, closed forms, and convex hulls."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from jaxsusp.geometry.depths import DEPTHS
from jaxsusp.geometry.segments import MEETS
from jaxsusp.vec3 import Vec3

HALF = np.array([0.7, 0.3, 1.1])
RADIUS, HEIGHT = 0.6, 0.9
SIZES = {"box": (Vec3(*HALF),), "cylinder": (RADIUS, HEIGHT), "sphere": (RADIUS,)}
KINDS = [*SIZES, *(f"plane_{kind}" for kind in SIZES)]
NOTHING = 1e-9  # m; nearer to touching, rounding decides


def held(tests, kind: str):
    """One of the tests as a function of two points: a segment's ends, or a normal and a point."""
    size = SIZES[kind.removeprefix("plane_")]

    def function(a, b):
        own = jax.tree.map(lambda length: jnp.asarray(length, a.dtype), size)
        return getattr(tests, kind)(Vec3.from_array(a), Vec3.from_array(b), *own)

    return function


@jax.jit
def everything(a: jax.Array, b: jax.Array) -> dict[str, tuple[jax.Array, ...]]:
    """Whether the two meet, how deep, and the depth's gradients, by the name of the test."""
    found = {}
    for kind in KINDS:
        depth, back = jax.vjp(held(DEPTHS, kind), a, b)
        found[kind] = held(MEETS, kind)(a, b), depth, *back(jnp.ones_like(depth))
    return found


def random_pairs(count: int = 3000) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of points, a third of them along axes, in horizontal planes, or equal."""
    rng = np.random.default_rng(5)
    a, b = rng.normal(scale=0.8, size=(2, count, 3))
    twelfth = count // 12
    b[:twelfth, 2] = a[:twelfth, 2]
    b[twelfth : 2 * twelfth, :2] = a[twelfth : 2 * twelfth, :2]
    b[2 * twelfth : 3 * twelfth, 0] = a[2 * twelfth : 3 * twelfth, 0]
    b[3 * twelfth : 4 * twelfth] = a[3 * twelfth : 4 * twelfth]
    return a, b


@pytest.fixture(scope="module")
def pairs() -> tuple[np.ndarray, np.ndarray]:
    return random_pairs()


@pytest.fixture(scope="module")
def known(pairs) -> dict[str, tuple[np.ndarray, ...]]:
    """Everything about the pairs."""
    return jax.tree.map(np.asarray, everything(*map(jnp.asarray, pairs)))


coordinate = st.one_of(st.floats(-2, 2), st.sampled_from([0.0, 0.3, 0.6, -0.7, 0.9, -1.1, 1e-12]))
point = st.tuples(coordinate, coordinate, coordinate)


@given(a=point, b=point)
@settings(deadline=None, max_examples=150)
def test_a_depth_is_positive_where_the_two_meet(a, b):
    found = everything(jnp.asarray([a]), jnp.asarray([b]))
    for kind, (met, depth, *slopes) in found.items():
        short = kind.startswith("plane") and np.linalg.norm(a) <= NOTHING  # tells nothing
        if abs(depth[0]) > NOTHING and not short:
            assert bool(met[0]) == bool(depth[0] > 0), kind
        assert np.isfinite(slopes).all(), kind


def test_depths_of_many_pairs_tell_the_same(known):
    for kind, (met, depth, *slopes) in known.items():
        sure = np.abs(depth) > NOTHING
        np.testing.assert_array_equal(met[sure], depth[sure] > 0, err_msg=kind)
        assert 0.1 < met.mean() < 0.99
        assert np.isfinite(slopes).all()


def test_of_a_box_it_is_the_depth_of_penetration(pairs, known):
    """The shortest way out is the distance of the origin from the hull of all differences."""
    corners = HALF * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    met, depth, *_ = known["box"]
    for i in np.flatnonzero(met)[::3]:
        differences = np.concatenate([end[i] - corners for end in pairs])
        shortest = -ConvexHull(differences).equations[:, 3].max()
        assert depth[i] == pytest.approx(shortest, abs=1e-9)


def test_of_a_sphere_it_is_what_the_nearest_point_lacks(pairs, known):
    a, b = pairs
    t = np.linspace(0, 1, 4001)[:, None, None]
    middle = np.linalg.norm(a[:300] + t * (b - a)[:300], axis=-1).min(axis=0)
    np.testing.assert_allclose(known["sphere"][1][:300], RADIUS - middle, atol=1e-5)


def test_of_a_plane_it_is_what_its_distance_lacks_from_the_support(pairs, known):
    """Closed forms of the greatest coordinate of a body along the plane's normal."""
    normal, through = pairs
    unit = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    distance = np.abs((unit * through).sum(axis=-1))
    support = {
        "box": np.abs(unit) @ HALF,
        "cylinder": np.hypot(unit[:, 0], unit[:, 1]) * RADIUS + np.abs(unit[:, 2]) * HEIGHT,
        "sphere": RADIUS,
    }
    for kind, reach in support.items():
        np.testing.assert_allclose(known[f"plane_{kind}"][1], reach - distance, atol=1e-12)


@pytest.mark.parametrize("kind", SIZES)
def test_along_the_gradient_a_segment_comes_out(pairs, known, kind):
    """By the depth; of a cylinder along what is level of it, unless it comes out at a cap."""
    a, b = pairs
    met, depth, by_a, by_b = known[kind]
    out = -(by_a + by_b)
    if kind == "cylinder":
        side = np.abs(out[:, :2]).sum(axis=1) > 0
        out[side, 2] = 0
    sure = met & (np.linalg.norm(out, axis=1) > 0.5)  # none through the very middle
    np.testing.assert_allclose(np.linalg.norm(out[sure], axis=1), 1, atol=1e-9)
    assert sure.sum() > 500
    for share, still in ((0.999, True), (1.001, False)):
        moved = share * (depth[:, None] + NOTHING) * out
        again = np.asarray(everything(jnp.asarray(a + moved), jnp.asarray(b + moved))[kind][0])
        again = again[sure]
        if not still:
            assert not again.any()
        elif kind == "box":
            assert again.all()


@pytest.mark.parametrize("kind", ["box", "sphere"])
def test_apart_it_is_never_more_than_the_distance(pairs, known, kind):
    a, b = pairs
    t = np.linspace(0, 1, 401)[:, None, None]
    p = a + t * (b - a)
    beyond = {
        "box": np.linalg.norm(np.maximum(np.abs(p) - HALF, 0), axis=-1),
        "sphere": np.linalg.norm(p, axis=-1) - RADIUS,
    }[kind].min(axis=0)
    met, depth, *_ = known[kind]
    assert (-depth[~met] <= beyond[~met] + 1e-12).all()


def test_gradients_are_finite_in_single_precision_too():
    """Of segments of hardly any length or slope, whose squares are none in float32."""
    rng = np.random.default_rng(6)
    a = rng.normal(size=(3000, 3)).astype(np.float32)
    a[::3] = 0
    sizes = rng.choice([0, 1e-38, 1e-25, 1e-18, 1e-10, 1e-9, 1e-7, 1], (3000, 3))
    b = a + (sizes * rng.normal(size=(3000, 3))).astype(np.float32)
    for kind, (_, depth, *slopes) in everything(jnp.asarray(a), jnp.asarray(b)).items():
        assert depth.dtype == np.float32
        assert np.isfinite(slopes).all(), kind
        short = everything(jnp.asarray(b - a), jnp.asarray(a))[kind]  # as normals
        assert np.isfinite(short[2:]).all(), kind


@pytest.mark.fast
def test_depths_of_points_and_of_planes_by_hand():
    at, inside, up = jnp.asarray([[0.6, 0.0, 0.5], [0.2, 0.0, 0.8], [0.0, 0.0, 3.0]])
    assert float(held(DEPTHS, "box")(at, at)) == pytest.approx(0.1)
    assert float(held(DEPTHS, "cylinder")(inside, inside)) == pytest.approx(0.1)
    assert float(held(DEPTHS, "plane_box")(up, at)) == pytest.approx(0.6)
