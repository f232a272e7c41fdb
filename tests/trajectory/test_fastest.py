"""The least time on a path against closed forms, and against integration in the phase plane."""

import numpy as np
import pytest
from lifts import GRAVITY, demands_of, straight, winding

from jaxsusp.trajectory.fastest import Demands, Profile, least_time
from jaxsusp.trajectory.smoothpath import SmoothPath

LENGTH = 3.0


def bound(path: SmoothPath, grid: int = 200, **limits) -> Profile | None:
    def demanded(arc):
        many = {name: each(arc) if callable(each) else each for name, each in limits.items()}
        return demands_of(path, arc, **many)

    return least_time(np.linspace(0, path.length, grid + 1), demanded)


def faces(*pulls: float):
    """Faces up and down, of masses."""
    return lambda arc: np.tile(np.array([[0, 0, each] for each in pulls]), (len(arc), 1, 1))


@pytest.mark.fast
def test_a_straight_lift_is_driven_with_all_acceleration_there_is():
    found = bound(straight(LENGTH), acceleration=0.7)
    assert found is not None
    assert found.duration == pytest.approx(2 * np.sqrt(LENGTH / 0.7), rel=1e-4)
    np.testing.assert_allclose(np.abs(found.acceleration), 0.7, rtol=1e-3)


@pytest.mark.fast
def test_a_straight_lift_with_a_limit_of_speed_has_a_stretch_of_it():
    speed = 0.8
    found = bound(
        straight(LENGTH), acceleration=0.7, square=lambda arc: np.full(len(arc), speed**2)
    )
    assert found is not None
    assert found.duration == pytest.approx(LENGTH / speed + speed / 0.7, rel=1e-3)


@pytest.mark.fast
def test_a_lift_by_one_cable_is_bang_bang_between_its_tensions():
    """T = m (g + a): up to T_hi first, then down to T_lo."""
    mass, low, high = 10.0, 60.0, 120.0
    up, down = high / mass - GRAVITY, GRAVITY - low / mass
    found = bound(
        straight(LENGTH), faces=faces(mass, -mass),
        room=lambda arc: np.tile([high - mass * GRAVITY, mass * GRAVITY - low], (len(arc), 1)),
    )  # fmt: skip
    assert found is not None
    assert found.duration == pytest.approx(np.sqrt(2 * LENGTH * (1 / up + 1 / down)), rel=1e-3)
    assert found.acceleration[0] == pytest.approx(up, rel=1e-3)
    assert found.acceleration[-1] == pytest.approx(-down, rel=1e-3)


@pytest.mark.fast
def test_without_room_there_is_no_motion():
    """A place where a cable can neither hold the load nor let it fall fast enough."""
    found = bound(
        straight(LENGTH), faces=faces(1.0, -1.0),
        room=lambda arc: np.where((np.abs(arc - 1.0) < 0.1)[:, None], -0.1, [[1.0, 1.0]]),
    )  # fmt: skip
    assert found is None


@pytest.mark.parametrize("seed", range(4))
def test_the_bound_is_what_integration_in_the_phase_plane_finds(seed):
    path, most = winding(seed), 0.6
    found = bound(path, 400, acceleration=most)
    assert found is not None
    fine = np.linspace(0, path.length, 20_001)
    assert found.duration == pytest.approx(
        integrated(demands_of(path, fine, acceleration=most)), rel=1e-3
    )


def integrated(demands: Demands) -> float:
    """Both ways along the path with all acceleration that curvature leaves: the lower of the two.

    |p_s a + p_ss b| <= A with p_ss across p_s: a² + (κ b)² <= A².
    """
    step, most = np.diff(demands.arc), demands.acceleration
    bend = np.maximum(np.linalg.norm(demands.bend, axis=1), 1e-12)
    square = most / bend
    square[[0, -1]] = 0
    for order in (range(1, len(square)), range(len(square) - 2, -1, -1)):
        back = 1 if order.step > 0 else -1
        for i in order:
            known = square[i - back]
            left = np.sqrt(max(most**2 - (bend[i - back] * known) ** 2, 0.0))
            square[i] = min(square[i], known + 2 * step[min(i, i - back)] * left)
    root = np.sqrt(square)
    return float((2 * step / (root[1:] + root[:-1])).sum())
