"""Rounded ways: clear by construction, smooth, and hardly longer than the taut ones."""

from math import comb

import numpy as np
import pytest

from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.polylines import length
from jaxsusp.freespace.rounding import _energy, rounded, rounded_ways
from jaxsusp.freespace.space import Route, assemble

CORNER = np.array([1.0, 1.0, 0.0])


def box(lower, upper) -> Region:
    lower, upper = np.array(lower, float), np.array(upper, float)
    faces = HalfSpaces(np.concatenate([np.eye(3), -np.eye(3)]), np.concatenate([upper, -lower]))
    return Region(faces, Ellipsoid(np.diag(upper - lower) / 2, (upper + lower) / 2))


@pytest.fixture(scope="module")
def bend():
    """Two corridors that meet at a right angle, and the taut way round the inner corner."""
    regions = [box([0, 0, -0.5], [3, 1, 0.5]), box([0, 0, -0.5], [1, 3, 0.5])]
    line = np.array([[2.8, 0.5, 0.0], CORNER, [0.5, 2.8, 0.0]])
    return assemble(
        regions, adjacency=~np.eye(2, dtype=bool), route=np.arange(2), polyline=line, bound=0.0,
        coverage=1.0, routes=(Route(line, (0, 1), length(line), ()),),
    )  # fmt: skip


@pytest.mark.fast
def test_the_curve_stays_in_the_regions_between_its_points_too(bend):
    curve = rounded(bend, bend.polyline, 2000)
    assert bend.contains(curve - 1e-7 * np.sign(curve - CORNER)).all()
    np.testing.assert_allclose(curve[[0, -1]], bend.polyline[[0, -1]], atol=1e-6)
    assert length(bend.polyline) < length(curve) < 1.05 * length(bend.polyline)


def test_it_turns_gently_and_its_points_are_evenly_spaced(bend):
    curve = rounded(bend, bend.polyline, 400)
    steps = np.diff(curve, axis=0)
    each = np.linalg.norm(steps, axis=1)
    np.testing.assert_allclose(each, each.mean(), rtol=1e-2)
    turns = np.linalg.norm(np.diff(steps / each[:, None], axis=0), axis=1)
    assert turns.max() / each.mean() < 1 / 0.1, "no sharper than a radius of 0.1 m"


def test_a_margin_keeps_it_off_the_faces_or_leaves_no_curve(bend):
    inner = rounded(bend, bend.polyline, 500, margin=0.1)
    beside = inner[(np.abs(inner - CORNER)[:, :2] < 0.4).all(axis=1)]
    assert (np.minimum(beside[:, 0], beside[:, 1]) < 0.9 + 1e-6).all()
    assert rounded(bend, bend.polyline, 500, margin=0.6) is None
    assert len([*rounded_ways(bend, 40)]) == 2


def test_a_way_in_one_region_is_straight():
    room = box([-1, -1, -1], [1, 1, 1])
    line = np.array([[-0.9, -0.5, 0.1], [0.8, 0.7, -0.3]])
    space = assemble(
        [room], adjacency=np.zeros((1, 1), bool), route=np.array([0]), polyline=line, bound=0.0,
        coverage=1.0,
    )  # fmt: skip
    share = np.linspace(0, 1, 30)[:, None]
    np.testing.assert_allclose(
        rounded(space, line, 30), (1 - share) * line[0] + share * line[1], atol=1e-5
    )


def test_a_way_that_leaves_the_regions_has_no_curve(bend):
    outside = np.array([[2.8, 0.5, 0.0], [2.8, 2.8, 0.0], [0.5, 2.8, 0.0]])
    assert rounded(bend, outside, 40) is None


@pytest.mark.parametrize("order", [1, 2])
def test_the_energy_is_that_of_the_polynomial(order):
    control = np.random.default_rng(order).normal(size=6)
    u, rest = np.polynomial.Polynomial([0, 1]), np.polynomial.Polynomial([1, -1])
    bernstein = [comb(5, i) * u**i * rest ** (5 - i) for i in range(6)]
    curve = sum(c * each for c, each in zip(control, bernstein, strict=True))
    whole = (curve.deriv(order) ** 2).integ()
    assert control @ _energy(order) @ control == pytest.approx(whole(1.0) - whole(0.0))
