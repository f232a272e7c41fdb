"""The numbers of one instance of a function: where its optimum is, how its axes are turned.

Host work in NumPy. Every function has the same arrays, so that instances and functions stack: what
a function does not use is there and costs nothing but its space.
"""

from typing import NamedTuple

import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.errors import require, require_count
from jaxsusp.studies.bbob import draws
from jaxsusp.studies.bbob.transformations import shares

COUNT = 24
"""Functions of the suite, numbered from 1."""

SEEDS = {4: 3, 18: 17}
"""Functions that share the draws of another one."""

OTHER = 1_000_000
"""Distance of the seed of the matrix R from that of Q."""

PEAKS = 101
"""Most peaks that a function has (f21; f22 has 21)."""

SCHWEFEL = 4.2096874633
"""Twice the coordinates of the optimum of f20."""


class Instance(NamedTuple):
    """What makes an instance; a pytree of float64 arrays."""

    optimum: Float[Array, "*stack dim"]  # x_opt
    offset: Float[Array, "*stack"]  # f_opt
    R: Float[Array, "*stack dim dim"]
    Q: Float[Array, "*stack dim dim"]
    centers: Float[Array, "*stack peaks dim"]  # of peaks, in turned coordinates: Q y
    widths: Float[Array, "*stack peaks dim"]  # diagonal of C, a peak is exp(-zᵀ C z / 2D)
    heights: Float[Array, "*stack peaks"]  # w; 0 of peaks that only fill up


def instance(function: int, dim: int, number: int) -> Instance:
    """Draw an instance as COCO does.

    Args:
        function: its number, 1 to 24.
        dim: number D of variables, at least 2.
        number: which instance, from 1.

    Raises:
        InputError: there is no such function, dimension or instance.
    """
    require_count("function", function, most=COUNT)
    require_count("dimension", dim, least=2, most=40)  # COCO draws no larger matrices
    require_count("instance", number)
    seed = SEEDS.get(function, function) + 10_000 * number
    R, Q = draws.rotation(dim, seed + OTHER), draws.rotation(dim, seed)
    centers, widths, heights = _peaks(function, dim, seed, Q)
    place = _optimum(function, dim, seed, Q)
    return Instance(place, np.array(draws.offset(seed)), R, Q, centers, widths, heights)


def stacked(instances: list[Instance]) -> Instance:
    """Several of one dimension along a new leading axis."""
    require(len(instances) > 0, "instances: none given; name at least one")
    return Instance(*(np.stack(leaves) for leaves in zip(*instances, strict=True)))


def _optimum(function: int, dim: int, seed: int, Q: np.ndarray) -> np.ndarray:
    """x_opt, which some functions have in a place of their own."""
    usual = draws.optimum(dim, seed)
    if function == 4:  # every second coordinate, where the function is steeper, is positive
        usual[::2] = np.abs(usual[::2])
    elif function == 5:
        return np.where(usual > 0, 5.0, -5.0)
    elif function == 8:
        return 0.75 * usual
    elif function in (9, 19):  # where Q x is the middle of the valley
        return Q.T @ np.full(dim, 0.5 / max(1.0, dim**0.5 / 8))
    elif function == 12:
        return draws.optimum(dim, seed + OTHER)
    elif function == 20:
        return SCHWEFEL / 2 * np.where(draws.uniform(dim, seed) < 0.5, -1.0, 1.0)
    elif function in (21, 22):
        return 0.8 * _scattered(function, dim, seed)[0]
    elif function == 24:
        return 1.25 * np.where(draws.gaussian(dim, seed) < 0, -1.0, 1.0)
    return usual


def _scattered(function: int, dim: int, seed: int) -> np.ndarray:
    """Places of Gallagher's peaks: in [-5, 5]^D, of f22 in [-4.9, 4.9]^D."""
    count, reach = (PEAKS, 5.0) if function == 21 else (21, 4.9)
    return 2 * reach * draws.uniform(count * dim, seed).reshape(count, dim) - reach


def _peaks(function: int, dim: int, seed: int, Q: np.ndarray) -> tuple[np.ndarray, ...]:
    """Centres, widths and heights of the peaks of f21 and f22; zeros of other functions."""
    centers, widths = np.zeros((PEAKS, dim)), np.zeros((PEAKS, dim))
    heights = np.zeros(PEAKS)
    if function not in (21, 22):
        return centers, widths, heights
    places = _scattered(function, dim, seed)
    count = len(places)
    places[0] *= 0.8  # the highest one, well inside the box
    ladder = np.arange(count - 1) / (count - 2)
    condition = np.empty(count)
    condition[0] = 1000**0.5 if function == 21 else 1000.0
    condition[1:] = 1000.0 ** ladder[draws.permutation(count - 1, seed)]
    for i in range(count):
        order = shares(dim)[draws.permutation(dim, seed + 1000 * i)]
        widths[i] = condition[i] ** (order - 0.5)
    centers[:count] = places @ Q.T
    heights[0], heights[1:count] = 10, 1.1 + 8 * ladder
    return centers, widths, heights
