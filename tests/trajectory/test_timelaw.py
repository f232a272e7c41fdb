"""The smooth path and the time law against finite differences, dense sums and each other."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from jaxsusp.errors import InputError
from jaxsusp.trajectory.smoothpath import SmoothPath
from jaxsusp.trajectory.timelaw import TimeLaw

COORDINATES = st.floats(-3, 3, allow_nan=False, width=32)
POINTS = hnp.arrays(np.float64, st.tuples(st.integers(3, 9), st.just(3)), elements=COORDINATES)


def wave(count: int = 25) -> np.ndarray:
    s = np.linspace(0, 1, count)
    return np.column_stack([2 * np.sin(3 * s), 4 * s, 1 + np.cos(5 * s)])


@pytest.fixture(scope="module")
def law() -> TimeLaw:
    return TimeLaw.through(wave(), 40.0)


def test_the_path_goes_through_its_points_and_is_c4(law):
    path = law.path
    knots = np.append(0, np.cumsum(np.linalg.norm(np.diff(wave(), axis=0), axis=1)))
    np.testing.assert_allclose(path.curve(knots), wave(), atol=1e-12)
    inner, step = knots[1:-1], 1e-7
    for order in range(5):
        left, right = path.curve(inner - step, nu=order), path.curve(inner + step, nu=order)
        scale = np.abs(path.curve(inner, nu=order + 1)).max()
        np.testing.assert_allclose(left, right, atol=4 * step * (1 + scale))
    fifth = path.curve(inner - step, nu=5) - path.curve(inner + step, nu=5)
    assert np.abs(fifth).max() > 1  # and no smoother than that: the test above can fail


def test_arc_length_is_that_of_a_fine_polyline_and_its_inverse_inverts(law):
    u = np.linspace(*law.path.span, 200_001)
    polyline = np.linalg.norm(np.diff(law.path.curve(u), axis=0), axis=1).sum()
    assert law.path.length == pytest.approx(polyline, rel=1e-8)
    assert law.path.length > np.linalg.norm(np.diff(wave(), axis=0), axis=1).sum()
    u = u[::1000]
    np.testing.assert_allclose(law.path.parameter(law.path.arc(u)), u, atol=1e-10)


def test_every_derivative_is_the_rate_of_the_one_before(law):
    step = 1e-3
    times = np.linspace(0.01, 39.99, 400)
    before, now, after = (law.at(times + shift) for shift in (-step, 0, step))
    for rate, low, high in zip(now[1:], before[:3], after[:3], strict=True):
        scale = np.abs(rate).max()
        np.testing.assert_allclose((high - low) / (2 * step), rate, atol=1e-4 * scale)


def test_it_begins_and_ends_at_rest_and_stays_there(law):
    motion = law.at(np.array([-1.0, 0.0, 40.0, 50.0]))
    np.testing.assert_allclose(motion.position[[0, 1]], wave()[[0, 0]], atol=1e-12)
    np.testing.assert_allclose(motion.position[[2, 3]], wave()[[-1, -1]], atol=1e-12)
    np.testing.assert_allclose(motion.velocity, 0, atol=1e-12)
    np.testing.assert_allclose(motion.acceleration, 0, atol=1e-12)
    np.testing.assert_array_equal(motion.jerk[[0, 3]], 0)


def test_speed_follows_the_minimum_jerk_law(law):
    times = np.linspace(0, 40, 101)
    speed = np.linalg.norm(law.at(times).velocity, axis=1)
    expected = law.path.length / 40 * 30 * (times / 40) ** 2 * (1 - times / 40) ** 2
    np.testing.assert_allclose(speed, expected, atol=1e-9)
    assert speed.max() == pytest.approx(15 / 8 * law.path.length / 40, rel=1e-6)
    share = times / 40
    way = share**3 * (10 + share * (6 * share - 15))
    np.testing.assert_allclose(law.law(times), law.path.length * way, atol=1e-12)


def test_time_and_parameter_agree(law):
    u = np.linspace(*law.path.span, 20)
    np.testing.assert_allclose(law.at(law.time_of(u)).position, law.path.curve(u), atol=2e-3)


@given(POINTS)
@settings(max_examples=40, deadline=None)
def test_bounds_of_derivatives_bound_them(points):
    path = SmoothPath(points)
    u = np.linspace(*path.span, 400)
    low, high = u[:-1:7], u[1::7]
    speed, bend = path.spline.bounds(low, high)
    for a, b, most_speed, most_bend in zip(low, high, speed, bend, strict=True):
        inside = np.linspace(a, b, 9)
        first, second, _ = (d(inside) for d in path.derivatives)
        assert np.linalg.norm(first, axis=1).max() <= most_speed * (1 + 1e-9) + 1e-9
        assert np.linalg.norm(second, axis=1).max() <= most_bend * (1 + 1e-9) + 1e-9


@pytest.mark.fast
def test_a_load_that_stays_where_it_is_stays_there():
    law = TimeLaw.through(np.tile([1.0, 2.0, 3.0], (5, 1)), 10.0)
    motion = law.at(np.linspace(0, 10, 11))
    np.testing.assert_allclose(motion.position, np.tile([1.0, 2.0, 3.0], (11, 1)), atol=1e-13)
    for rate in motion[1:]:
        np.testing.assert_allclose(rate, 0, atol=1e-13)


@pytest.mark.fast
def test_points_that_repeat_count_once():
    points = wave()
    path = SmoothPath(np.repeat(points, 2, axis=0))
    assert path.length == pytest.approx(SmoothPath(points).length, rel=1e-12)


@pytest.mark.fast
def test_a_point_that_is_no_point_is_refused():
    with pytest.raises(InputError, match="not finite"):
        SmoothPath(np.array([[0, 0, 0], [np.nan, 0, 0]]))
    with pytest.raises(InputError, match="two or more"):
        SmoothPath(np.zeros((1, 3)))
