"""Smoothed samples against quadrature, their room, and what is known of straight lines."""

import numpy as np
import pytest

from jaxsusp.trajectory.makima import makima
from jaxsusp.trajectory.smoothing import Planes, smoothed, third_derivative_energy
from jaxsusp.trajectory.smoothpath import SmoothPath, natural_quintic
from jaxsusp.trajectory.timelaw import TimeLaw

KNOTS = np.array([[0, 0, 0], [1, 0.2, 0], [1.2, 1.2, 0.3], [2.2, 1.4, 0.2], [2.3, 2.5, 1.0]])


@pytest.fixture(scope="module")
def points() -> np.ndarray:
    return np.asarray(makima(KNOTS, 40))


def peak_jerk(points: np.ndarray) -> float:
    motion = TimeLaw.through(points, 40.0).at(np.linspace(0, 40, 2001))
    return float(np.linalg.norm(motion.jerk, axis=1).max())


def bending(points: np.ndarray) -> float:
    u = SmoothPath(points).marks[0]
    return float(np.trace(points.T @ third_derivative_energy(u) @ points))


@pytest.mark.fast
def test_the_energy_is_the_integral_of_the_third_derivative_squared():
    u = np.array([0.0, 0.3, 1.0, 1.1, 2.0, 2.6])
    values = np.sin(2 * u)[:, None]
    fine = np.linspace(0, u[-1], 200_001)
    third = natural_quintic(u, values).derivative(3)(fine)[:, 0]
    expected = np.trapezoid(third**2, fine)
    energy = third_derivative_energy(u)
    assert float((values.T @ energy @ values).item()) == pytest.approx(expected, rel=1e-6)


@pytest.mark.fast
@pytest.mark.parametrize("radius", [0.003, 0.02])
def test_points_stay_in_their_room_and_jerk_falls(points, radius):
    found = smoothed(points, radius)
    np.testing.assert_array_equal(found[[0, -1]], points[[0, -1]])
    assert radius / 2 < np.abs(found - points).max() <= radius * (1 + 1e-6)
    assert peak_jerk(found) < peak_jerk(points) / 2


@pytest.mark.fast
def test_points_stay_above_planes(points):
    free = smoothed(points, 0.02)
    row = int((free - points)[:, 2].argmin())
    fell = float((free - points)[row, 2])
    up = Planes(np.array([row]), np.array([[0.0, 0.0, 1.0]]), np.array([fell / 2]))
    held = smoothed(points, 0.02, up)
    assert fell < -1e-4
    assert (held - points)[row, 2] >= fell / 2 - 1e-6
    assert bending(free) < bending(held) < bending(points)


@pytest.mark.fast
def test_a_straight_line_and_points_that_repeat_stay_what_they_are(points):
    line = np.linspace([0.0, 1.0, 2.0], [3.0, 1.0, 1.0], 12)
    np.testing.assert_allclose(smoothed(line, 0.05), line, atol=1e-4)
    pausing = np.insert(points, 20, points[20], axis=0)
    found = smoothed(pausing, 0.02)
    np.testing.assert_array_equal(found[20], found[21])
    np.testing.assert_allclose(np.delete(found, 21, axis=0), smoothed(points, 0.02), atol=1e-6)
