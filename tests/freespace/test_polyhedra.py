"""Nearest points, proofs of emptiness, hulls and volumes against solvers and closed forms."""

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from jaxsusp.freespace.polyhedra import (
    Body,
    HalfSpaces,
    corners_of,
    irredundant,
    nearest_point,
    volume,
)

seeds = st.integers(0, 2**32 - 1)


def random_polytope(random: np.random.Generator, faces: int = 12) -> HalfSpaces:
    normals = random.normal(size=(faces, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    center = random.uniform(-3, 3, 3)
    around = HalfSpaces.box(center - 2, center + 2)
    return around & HalfSpaces(normals, normals @ center + random.uniform(0.1, 1.5, faces))


@given(seeds)
@settings(deadline=None, max_examples=60)
def test_nearest_point_is_that_of_a_quadratic_program(seed):
    random = np.random.default_rng(seed)
    halves, to = random_polytope(random), random.uniform(-6, 6, 3)
    found = nearest_point(halves, to).point
    x = cp.Variable(3)
    best = cp.Problem(cp.Minimize(cp.norm(x - to)), [halves.A @ x <= halves.b]).solve("CLARABEL")
    assert halves.excess(found) < 1e-9
    assert np.linalg.norm(found - to) == pytest.approx(best, abs=1e-6)


@given(seeds, st.floats(1e-6, 3))
@example(58, 2**-9)  # multipliers of 512, whose rounding once hid the proof
@settings(deadline=None, max_examples=60)
def test_emptiness_comes_with_a_proof(seed, gap):
    """Two polytopes on either side of a slab: multipliers u >= 0 with Aᵀu = 0 and b·u < 0."""
    random = np.random.default_rng(seed)
    one, two = random_polytope(random), random_polytope(random)
    normal = random.normal(size=3)
    normal /= np.linalg.norm(normal)
    both = one & two & HalfSpaces(np.array([normal, -normal]), np.array([0.0, -gap]))
    found = nearest_point(both, np.zeros(3))
    assert found.point is None
    assert (found.multipliers >= 0).all()
    scale = found.multipliers.sum()
    np.testing.assert_allclose(both.A.T @ found.multipliers, 0, atol=1e-9 * scale)
    assert both.b @ found.multipliers < 0


@pytest.mark.fast
def test_a_far_point_is_exact_with_a_scale():
    halves = HalfSpaces.box(np.full(3, -0.5), np.full(3, 0.5))
    found = nearest_point(halves, np.array([4e4, 0.1, -3e4]), scale=5e4).point
    np.testing.assert_allclose(found, [0.5, 0.1, -0.5], atol=1e-9)


@pytest.mark.fast
def test_hull_of_a_box_has_six_faces_and_eight_corners():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    body = Body.hull("box", np.concatenate([corners, [[0.5, 1.0, 1.0]]]))
    assert len(body.corners) == 8
    assert len(body.faces.b) == 6
    assert body.faces.excess(corners).max() <= 0
    assert body.faces.excess(np.array([0.5, 1.0, 1.5])) == pytest.approx(-0.5)


@given(seeds)
@settings(deadline=None, max_examples=30)
def test_what_adds_nothing_goes_and_the_body_stays(seed):
    random = np.random.default_rng(seed)
    halves = random_polytope(random, faces=30)
    x, r = cp.Variable(3), cp.Variable()
    cp.Problem(cp.Maximize(r), [halves.A @ x + r <= halves.b]).solve("CLARABEL")
    inside = x.value
    fewer = irredundant(halves, inside)
    assert len(fewer.b) <= len(halves.b)
    assert volume(fewer, inside) == pytest.approx(volume(halves, inside), rel=1e-9)
    for normal, offset in zip(fewer.A, fewer.b, strict=True):  # every face is touched by a corner
        assert np.abs(corners_of(fewer, inside) @ normal - offset).min() < 1e-6


@pytest.mark.fast
def test_volume_of_a_tetrahedron():
    halves = HalfSpaces(
        np.array([[-1.0, 0, 0], [0, -1, 0], [0, 0, -1], [1, 1, 1] / np.sqrt(3)]),
        np.array([0.0, 0, 0, 1 / np.sqrt(3)]),
    )
    assert volume(halves, np.full(3, 0.2)) == pytest.approx(1 / 6)
