"""Classical test functions, moved about: how much do algorithms owe to where an optimum lies?

As they are printed, four of the five have their optimum at the origin, which is the middle of their
bounds as well. Moving function and bounds together changes the origin's place alone; moving the
optimum within the bounds, the middle's as well; turning the function takes away that its variables
can be improved one by one.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.errors import require_known
from jaxsusp.problem.problem import Problem

CASES = ("printed", "moved", "shifted", "turned")
"""As printed; with its bounds away from the origin; with its optimum elsewhere within the bounds;
the last, and turned about its optimum."""

AWAY = 4.0
"""Half widths of the bounds by which "moved" goes, up in every second variable, down in the others:
the origin is far outside."""

WITHIN = 0.6
"""Greatest distance of a shifted optimum from the middle, in half widths of the bounds."""


class Function(NamedTuple):
    """A function whose least value is 0, its optimum and its bounds, −half … half."""

    of: Callable[[Float[Array, "dim"]], Float[Array, ""]]
    half: float
    optimum: float = 0.0  # in every variable


def _ackley(x: Array) -> Array:
    waves = jnp.exp(jnp.mean(jnp.cos(2 * jnp.pi * x)))
    return -20 * jnp.exp(-0.2 * jnp.sqrt(jnp.mean(x**2))) - waves + 20 + jnp.e


FUNCTIONS: Mapping[str, Function] = {
    "sphere": Function(lambda x: jnp.sum(x**2), 100),
    "Schwefel 2.22": Function(lambda x: jnp.sum(jnp.abs(x)) + jnp.prod(jnp.abs(x)), 10),
    "Rosenbrock": Function(
        lambda x: jnp.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (x[:-1] - 1) ** 2), 30, 1.0
    ),
    "Rastrigin": Function(lambda x: jnp.sum(x**2 - 10 * jnp.cos(2 * jnp.pi * x) + 10), 5.12),
    "Ackley": Function(_ackley, 32),
}
"""Bounds are those of the authors of DBO."""


class Moved(NamedTuple):
    """One of the functions, elsewhere: a pytree, so that all of them are one compiled program."""

    kind: Any  # number of the function
    optimum: Any  # of the printed function, in every variable
    place: Float[Any, "dim"]  # of the optimum
    turn: Float[Any, "dim dim"]

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """The value at x."""
        there = self.turn @ (x - self.place) + self.optimum
        return jax.lax.select_n(self.kind, *(each.of(there) for each in FUNCTIONS.values()))


def classical(name: str, case: str, dim: int = 30, seed: int = 0) -> Problem:
    """One of the functions in one of the cases, float64.

    Args:
        name: one of `FUNCTIONS`.
        case: one of `CASES`.
        dim: number D of variables.
        seed: of shift and turn, which are the same for all functions of one D.

    Raises:
        InputError: an unknown name or case.
    """
    require_known("function", name, FUNCTIONS)
    require_known("case", case, CASES)
    function, random = FUNCTIONS[name], np.random.default_rng(seed)
    middle = AWAY * function.half * (-1.0) ** np.arange(dim) * (case == "moved")
    shift = WITHIN * function.half * random.uniform(-1, 1, dim)
    turn = _turned(random, dim)
    elsewhere = case in ("shifted", "turned")
    place = shift if elsewhere else np.full(dim, function.optimum) + middle
    return Problem(
        Moved(
            np.int32([*FUNCTIONS].index(name)),
            np.float64(function.optimum),
            place,
            turn if case == "turned" else np.eye(dim),
        ),
        middle - function.half,
        middle + function.half,
    )


def _turned(random: np.random.Generator, dim: int) -> Float[np.ndarray, "dim dim"]:
    """A rotation drawn evenly (Stewart 1980)."""
    q, r = np.linalg.qr(random.normal(size=(dim, dim)))
    q = q * np.sign(np.diag(r))
    q[0] *= np.linalg.det(q)
    return q
