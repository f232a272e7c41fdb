"""Segment tests against constructions whose answer is known and against dense sampling."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxsusp.geometry.segments import (
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_sphere,
)
from jaxsusp.vec3 import Vec3

HALF = np.array([0.7, 0.3, 1.1])
RADIUS, HEIGHT = 0.6, 0.9
MEETS = {
    "box": lambda a, b: segment_meets_box(a, b, Vec3(*HALF)),
    "cylinder": lambda a, b: segment_meets_cylinder(a, b, RADIUS, HEIGHT),
    "sphere": lambda a, b: segment_meets_sphere(a, b, RADIUS),
}
INSIDE = {  # how far a point is inside (> 0) or outside (< 0), by any increasing measure
    "box": lambda p: (HALF - np.abs(p)).min(axis=-1),
    "cylinder": lambda p: np.minimum(
        RADIUS - np.hypot(p[..., 0], p[..., 1]), HEIGHT - np.abs(p[..., 2])
    ),
    "sphere": lambda p: RADIUS - np.linalg.norm(p, axis=-1),
}


def meets(kind: str, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(jax.jit(MEETS[kind])(Vec3(*jnp.asarray(a.T)), Vec3(*jnp.asarray(b.T))))


def segments(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random segments, a third of them along axes, in horizontal planes, or of no length."""
    rng = np.random.default_rng(5)
    a, b = rng.normal(scale=1.0, size=(2, count, 3))
    b[: count // 12, 2] = a[: count // 12, 2]
    b[count // 12 : count // 6, :2] = a[count // 12 : count // 6, :2]
    b[count // 6 : count // 4, 0] = a[count // 6 : count // 4, 0]
    b[count // 4 : count // 3] = a[count // 4 : count // 3]
    return a, b


@pytest.mark.parametrize("kind", MEETS)
def test_agrees_with_dense_sampling(kind):
    """A sample inside proves a hit; a hit needs a sample that is nearly inside."""
    a, b = segments(3000)
    t = np.linspace(0, 1, 2001)[:, None, None]
    depth = np.max([INSIDE[kind](a + s * (b - a)) for s in t[:, 0]], axis=0)
    found = meets(kind, a, b)
    assert found[depth > 0].all()
    assert not found[depth < -2e-3].any()
    assert 0.15 < found.mean() < 0.85


@pytest.mark.fast
@pytest.mark.parametrize("kind", MEETS)
def test_touching_counts(kind):
    """Segments that end exactly on the surface, seen from outside."""
    touch = {"box": [0.7, 0.0, 0.0], "cylinder": [0.0, 0.0, 0.9], "sphere": [0.0, 0.6, 0.0]}[kind]
    a = np.array([touch])
    assert meets(kind, a, 3 * a).all()
    assert not meets(kind, (1 + 1e-12) * a, 3 * a).any()


@pytest.mark.fast
@pytest.mark.parametrize("cap", [HEIGHT, -HEIGHT])
def test_a_level_segment_in_the_plane_of_a_cap_touches(cap):
    a, b = np.array([[-2, 0.25, cap]]), np.array([[2, 0.25, cap]])
    assert meets("cylinder", a, b).all()
    assert not meets("cylinder", a + np.array([0, 1, 0]), b + np.array([0, 1, 0])).any()
    assert not meets("cylinder", a * np.array([1, 1, 1.001]), b * np.array([1, 1, 1.001])).any()


def test_zero_length_segments_are_points():
    points = np.random.default_rng(0).normal(scale=0.8, size=(500, 3))
    for kind, depth in INSIDE.items():
        np.testing.assert_array_equal(meets(kind, points, points), depth(points) >= 0)
