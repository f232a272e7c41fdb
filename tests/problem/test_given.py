"""A fitness that is none is refused in one sentence; float64 bounds are taken without a word."""

import os
import subprocess
import sys

import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js

pytestmark = pytest.mark.fast


def two(x, y):
    return x.sum() + y


@pytest.mark.parametrize(
    ("fitness", "said"),
    [
        (lambda x: x**2, r"returns an array of shape \(3,\) .* return one number"),
        (lambda x: x[:1], r"returns an array of shape \(1,\)"),
        (lambda x: np.sin(x).sum(), "use jax.numpy in place of numpy"),
        (lambda x: x.sum() if x[0] > 0 else 0.0, "jnp.where in place of if"),
        (lambda x: float(x[0]), r"neither float\(…\) nor"),
        (lambda x: x[x > 0].sum(), "needs the values of x"),
        (lambda _: None, "returns nothing; return one number"),
        (lambda _: "much", "returns a str; return one number"),
        (lambda x: (x[0], x[1]), "returns a tuple; return one number"),
        (lambda x: x.sum().astype(complex), "returns complex numbers"),
        (lambda x: x @ jnp.ones(4), r"fails for a vector x of 3 numbers \(.*\); give"),
        (two, r"cannot be called with one vector x \(missing a required argument: 'y'\)"),
        (lambda: 1.0, "cannot be called with one vector x"),
    ],
)
def test_what_is_no_fitness_is_refused_in_one_sentence(fitness, said):
    with pytest.raises(js.InputError, match=said) as caught:
        js.Problem(fitness, -np.ones(3), np.ones(3))
    assert "\n" not in str(caught.value)
    assert "racer" not in str(caught.value)


@pytest.mark.parametrize("fitness", [jnp.sum, lambda _: 1.0, lambda x: jnp.argmin(x), np.sum])
def test_what_is_one_is_taken(fitness):
    assert js.Problem(fitness, -np.ones(3), np.ones(3)).dim == 3


QUIET = """
import numpy as np, jax, jaxsusp as js
problem = js.Problem(lambda x: (x**2).sum(), -np.ones(3), np.ones(3))
found = js.minimize(problem, "pso", runs=1, iterations=2, population=4)
assert found.x.dtype == np.float64
x = problem.sample(jax.random.key(0), 3)
problem.evaluate(np.float64(x)), problem.twin(np.float64(x)), problem.origin
"""


def test_float64_bounds_pass_without_a_warning_where_it_is_not_enabled():
    """A search in them is in double precision all the same, as they ask for."""
    plain = {name: value for name, value in os.environ.items() if name != "JAX_ENABLE_X64"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", QUIET],
        env=plain, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
