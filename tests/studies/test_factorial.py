"""Effects of factors that come on and off, against what they were made of."""

import numpy as np
import pytest

from jaxsusp.studies.factorial import effect

pytestmark = pytest.mark.fast


def table(of) -> np.ndarray:
    """One number per combination of three factors, in binary order."""
    return np.array([[of(a, b, c) for a in (0, 1) for b in (0, 1) for c in (0, 1)]], float)


def test_effects_are_what_the_numbers_were_made_of():
    y = table(lambda a, b, c: 7 + 3 * a - 2 * c)
    assert effect(y, [0], 3) == pytest.approx(3)
    assert effect(y, [1], 3) == pytest.approx(0)
    assert effect(y, [2], 3) == pytest.approx(-2)
    assert effect(y, [0, 2], 3) == pytest.approx(0)


def test_two_that_change_each_other():
    """With b on, a is worth 5 more; in the mean over b its effect is half of that more."""
    y = table(lambda a, b, c: a + 5 * a * b)
    assert effect(y, [0, 1], 3) == pytest.approx(5)
    assert effect(y, [0], 3) == pytest.approx(1 + 5 / 2)
    assert effect(y, [0, 1, 2], 3) == pytest.approx(0)


def test_leading_axes_are_kept():
    y = np.random.default_rng(0).normal(size=(4, 5, 16))
    found = effect(y, [3], 4)
    assert found.shape == (4, 5)
    np.testing.assert_allclose(found, (y[..., 1::2] - y[..., ::2]).mean(axis=-1))
