"""Strips hold what they say they hold, and get narrow as intervals get short."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from jaxsusp.verify.limits.strips import Strip, cross, dot, heading, least, norm, stacked

pytestmark = pytest.mark.fast
S = np.linspace(-1, 1, 81)
NUMBERS = st.floats(-2, 2)


def line(middle, slope, half=1.0) -> tuple[Strip, np.ndarray]:
    """A straight line with half the given slope per half an interval, and its values."""
    strip = Strip(*(np.array([value]) for value in (middle, slope * half, 0.0)))
    return strip, middle + slope * half * S


def assert_holds(strip: Strip, values: np.ndarray) -> None:
    """Also within the strip, not only between its bounds; but for rounding on our side."""
    rounding = 1e-14 * (1 + np.abs(values) + np.nan_to_num(strip.size))
    off = np.abs(values - strip.middle - strip.slope * S)
    assert (off <= strip.rest + rounding).all() or not np.isfinite(strip.rest).all()
    assert (strip.lower <= values + rounding).all()
    assert (values <= strip.upper + rounding).all()


@given(st.tuples(NUMBERS, NUMBERS), st.tuples(NUMBERS, NUMBERS))
@settings(deadline=None)
def test_sums_and_products_of_strips_hold_those_of_functions(one, other):
    (a, f), (b, g) = line(*one), line(*other)
    for strip, values in (
        (a + b, f + g),
        (a - b, f - g),
        (a * b, f * g),
        (3.0 - a * 0.7, 3.0 - f * 0.7),
        (a * b * a - b, f * g * f - g),
    ):
        assert_holds(strip, values)


@given(st.floats(0.2, 3), st.floats(-4, 4), st.floats(1e-3, 1))
@settings(deadline=None)
def test_functions_of_strips_hold_those_of_functions(middle, slope, half):
    with np.errstate(all="ignore"):
        a, f = line(middle, slope, half)
        square, g = a * a, f * f
        assert_holds(square.root(), np.abs(f))
        assert_holds(a.arc_tangent(), np.arctan(f))
        assert_holds(a.cube_root(), np.cbrt(np.clip(f, 0, 1)))
        assert_holds((a * 0.3).arc_cosine(), np.arccos(np.clip(0.3 * f, -1, 1)))
        assert_holds((square + 0.1).inverse(), 1 / (g + 0.1))
        if (np.abs(f) > 1e-9).all():
            assert_holds(a.inverse(), 1 / f)
        assert_holds(heading(a * 0 + 0.5, a), np.arctan2(f, 0.5))


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=3, max_size=3), st.floats(0.01, 1))
@settings(deadline=None)
def test_vectors_and_the_least_of_several(lines, half):
    strips, values = zip(*(line(*each, half) for each in lines), strict=True)
    vector, v = stacked(list(strips)), np.stack(values)
    with np.errstate(all="ignore"):
        assert_holds(norm(vector), np.linalg.norm(v, axis=0))
    assert_holds(least(vector), v.min(axis=0))
    turned = vector[..., [1, 2, 0]]
    w = v[[1, 2, 0]]
    assert_holds(dot(vector, turned), (v * w).sum(axis=0))
    for i, product in enumerate(np.cross(v, w, axis=0)):
        assert_holds(cross(vector, turned)[..., i], product)


def test_where_nothing_is_known_there_are_no_bounds():
    with np.errstate(all="ignore"):
        through_zero = line(0.1, 1.0)[0].inverse() * line(1.0, 0.0)[0]
    assert through_zero.lower == -np.inf
    assert through_zero.upper == np.inf


def test_half_the_interval_makes_a_strip_four_times_as_narrow():
    def width(half: float) -> float:
        a, _ = line(1.3, 0.8, half)
        b, _ = line(-0.7, 0.5, half)
        found = norm(stacked([a, b])) * (a * a + b).inverse() + heading(a, b)
        return found.rest.item()

    assert width(0.01) / width(0.005) == pytest.approx(4, rel=0.1)


@given(st.floats(-2e3, 2e3), st.floats(-2e3, 2e3))
@example(1.5e-158, 1.5e-158)  # whose squares underflow
@settings(deadline=None)
def test_rounding_is_part_of_a_strip(x, y):
    """(x + y)² - x² - 2 x y - y² is zero, and what is left of it is rounding."""
    a, b = (Strip(*(np.array([value]) for value in (v, 0.0, 0.0))) for v in (x, y))
    found = (a + b) * (a + b) - a * a - 2.0 * (a * b) - b * b
    assert abs(found.middle) <= found.rest
    assert found.rest <= 1e-13 * (abs(x) + abs(y)) ** 2 + 1e-298
