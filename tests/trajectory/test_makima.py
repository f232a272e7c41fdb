"""Makima against scipy's implementation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.interpolate import Akima1DInterpolator

from jaxsusp.trajectory.makima import makima, makima_slopes

sample = jax.jit(makima, static_argnums=1)


def reference(values: np.ndarray, samples: int) -> np.ndarray:
    knots = np.arange(len(values), dtype=float)
    interpolant = Akima1DInterpolator(knots, values, method="makima")
    return interpolant(np.linspace(0, knots[-1], samples))


# Multiples of 2⁻¹⁰ up to 100: sums and differences are exact, so that a tie of secants (where the
# weights switch) is a tie in both implementations.
coordinates = st.integers(-(100 * 1024), 100 * 1024).map(lambda i: i / 1024)


@given(arrays(np.float64, (7, 3), elements=coordinates))
@settings(deadline=None, max_examples=300)
def test_equals_scipy(values):
    np.testing.assert_allclose(sample(values, 40), reference(values, 40), rtol=0, atol=1e-12 * 100)


@pytest.mark.fast
@pytest.mark.parametrize("knots", [3, 4, 5, 9, 20])
@pytest.mark.parametrize("samples", [3, 40, 801])
def test_equals_scipy_to_1e_12_for_any_number_of_knots(knots, samples):
    values = np.random.default_rng(knots).normal(size=(knots, 4))
    np.testing.assert_allclose(sample(values, samples), reference(values, samples), atol=1e-12)


def test_passes_through_the_knots_and_is_straight_on_a_line():
    values = np.random.default_rng(0).normal(size=(7, 3))
    np.testing.assert_allclose(sample(values, 7), values, atol=1e-14)
    line = np.linspace([0.0, 1.0], [3.0, -2.0], 7)
    np.testing.assert_allclose(sample(line, 40), np.linspace(line[0], line[-1], 40), atol=1e-14)


def test_level_knots_have_level_slopes_and_finite_gradients():
    """All weights vanish where neighbouring secants do: slope 0, not NaN (MATLAB's choice)."""
    level = jnp.ones(7)
    np.testing.assert_array_equal(jax.jit(makima_slopes)(level), np.zeros(7))
    assert np.isfinite(jax.jit(jax.grad(lambda v: makima(v, 40).sum()))(level)).all()


def test_keeps_the_dtype_and_trailing_axes():
    values = jnp.zeros((7, 3, 5), jnp.float32)
    assert sample(values, 11).shape == (11, 3, 5)
    assert sample(values, 11).dtype == jnp.float32
