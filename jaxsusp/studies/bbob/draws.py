"""COCO's own random numbers: what makes an instance of a function the same on every machine.

The generators are those of BBOB-2009, which COCO keeps so that results of all years compare: a
minimal-standard Lehmer generator behind a shuffling table of 32, and Box and Muller's Gaussians.
"""

import math

import numpy as np

from jaxsusp._types import Float

MODULUS = 2**31 - 1
"""Of the Lehmer generator; its multiplier is 16807."""

_TABLE, _WARMUP = 32, 40


def uniform(count: int, seed: int) -> Float[np.ndarray, "count"]:
    """Uniform numbers in (0, 1)."""
    state = max(1, abs(seed))
    table = []
    for _ in range(_WARMUP):
        state = 16807 * state % MODULUS
        table.append(state)
    table = table[: -_TABLE - 1 : -1]  # the last 32, the latest first
    latest, drawn = table[0], []
    for _ in range(count):
        state = 16807 * state % MODULUS
        place = latest // 67108865
        latest, table[place] = table[place], state
        drawn.append(latest / MODULUS)
    numbers = np.array(drawn)
    return np.where(numbers == 0, 1e-99, numbers)


def gaussian(count: int, seed: int) -> Float[np.ndarray, "count"]:
    """Standard normal numbers; the second half of the uniform ones are the angles."""
    radius, angle = uniform(2 * count, seed).reshape(2, count)
    numbers = np.sqrt(-2 * np.log(radius)) * np.cos(2 * np.pi * angle)
    return np.where(numbers == 0, 1e-99, numbers)


def rotation(dim: int, seed: int) -> Float[np.ndarray, "dim dim"]:
    """An orthogonal matrix: Gaussian columns, made orthonormal one after the other.

    Sums are taken in COCO's order: nearly dependent columns magnify what another order rounds
    otherwise, and f19 magnifies it again.
    """
    columns = gaussian(dim * dim, seed).reshape(dim, dim)
    for i, column in enumerate(columns):
        for earlier in columns[:i]:
            column -= _in_order(column * earlier) * earlier
        column /= math.sqrt(_in_order(column**2))
    return columns.T.copy()


def _in_order(terms: Float[np.ndarray, "terms"]) -> float:
    """Their sum, one after the other; `sum` takes them in pairs."""
    return np.add.accumulate(terms)[-1]


def optimum(dim: int, seed: int) -> Float[np.ndarray, "dim"]:
    """A place in [-4, 4]^D, in steps of 0.0008, with no coordinate 0."""
    place = 8 * np.floor(1e4 * uniform(dim, seed)) / 1e4 - 4
    return np.where(place == 0, -1e-5, place)


def offset(seed: int) -> float:
    """The least value f_opt: a Cauchy number in steps of 0.01, within ±1000."""
    ratio = gaussian(1, seed).item() / gaussian(1, seed + 1).item()
    return min(1000.0, max(-1000.0, math.floor(100 * 100 * ratio + 0.5) / 100))


def permutation(count: int, seed: int) -> np.ndarray:
    """The indices of uniform numbers, those of the smallest first."""
    return np.argsort(uniform(count, seed), kind="stable")
