"""Eq. 23 against closed forms: boxes, affine images of the regular simplex, and by inclusion."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxsusp.errors import InputError
from jaxsusp.freespace.ellipsoid import Ellipsoid, largest_ellipsoid, require_solver
from jaxsusp.freespace.polyhedra import HalfSpaces

lengths = st.floats(0.05, 5)


def mapped(halves: HalfSpaces, M: np.ndarray, shift: np.ndarray) -> HalfSpaces:
    """The image of a polytope under x → M x + shift."""
    A = halves.A @ np.linalg.inv(M)
    size = np.linalg.norm(A, axis=1)
    return HalfSpaces(A / size[:, None], (halves.b + A @ shift) / size)


@given(st.tuples(lengths, lengths, lengths), st.tuples(*[st.floats(-5, 5)] * 3))
@settings(deadline=None, max_examples=40)
def test_a_box_holds_the_ellipsoid_of_its_half_lengths(half, center):
    half, center = np.array(half), np.array(center)
    found = largest_ellipsoid(HalfSpaces.box(center - half, center + half))
    assert found.volume == pytest.approx(4 / 3 * np.pi * half.prod(), rel=1e-5)
    np.testing.assert_allclose(found.d, center, atol=1e-4)
    np.testing.assert_allclose(found.C @ found.C.T, np.diag(half**2), atol=1e-3 * half.max() ** 2)


@given(st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=30)
def test_affine_images_of_a_regular_simplex(seed):
    """The inscribed ellipsoid of a simplex is the image of the inscribed ball of a regular one."""
    random = np.random.default_rng(seed)
    M = np.eye(3) + random.uniform(-0.4, 0.4, (3, 3))
    normals = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    image = mapped(HalfSpaces(normals, np.ones(4)), M, random.uniform(-2, 2, 3))
    found = largest_ellipsoid(image)
    assert found.volume == pytest.approx(4 / 3 * np.pi * abs(np.linalg.det(M)), rel=1e-5)


@given(st.integers(0, 2**32 - 1), st.integers(0, 40))
@settings(deadline=None, max_examples=40)
def test_it_never_sticks_out(seed, faces):
    random = np.random.default_rng(seed)
    normals = random.normal(size=(faces, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    box = HalfSpaces.box(np.full(3, -1.0), np.full(3, 1.0))
    halves = box & HalfSpaces(normals, random.uniform(0.01, 1, faces))
    found = largest_ellipsoid(halves)
    reach = np.linalg.norm(halves.A @ found.C, axis=1) + halves.A @ found.d
    assert (reach <= halves.b + 1e-12).all()


@pytest.mark.fast
def test_no_room_gives_no_ellipsoid():
    flat = HalfSpaces.box(np.zeros(3), np.array([1.0, 1.0, 0.0]))
    empty = HalfSpaces.box(np.zeros(3), np.array([1.0, 1.0, -1.0]))
    assert largest_ellipsoid(empty) is None
    found = largest_ellipsoid(flat)
    assert found is None or found.volume < 1e-6


@pytest.mark.fast
def test_volume():
    assert Ellipsoid(np.diag([1.0, 2.0, 3.0]), np.zeros(3)).volume == pytest.approx(8 * np.pi)


@pytest.mark.fast
def test_an_unknown_solver_is_refused():
    with pytest.raises(InputError, match=r"solver = 'MOSEC' is not known.*CLARABEL"):
        require_solver("MOSEC")
