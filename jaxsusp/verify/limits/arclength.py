"""Arc lengths of a path with proven errors: they say how exactly it is known where the load is.

Gauss's rule of n nodes integrates an analytic function over [-1, 1] with an error of at most
64/15 M ρ^(-2n)/(1 - ρ^-2), M the greatest size of the function on the ellipse with foci ±1 and
half-axes that add up to ρ (Trefethen 2013, Thm. 19.3). On a piece of the path p' is a polynomial,
so |p'|² is one, also of complex parameters, and σ = √(|p'|²) is analytic wherever that keeps away
from zero: in any disc in which p' changes by less than (√2 - 1) σ.
"""

import numpy as np

from jaxsusp._types import Float
from jaxsusp.verify.limits.pieces import Pieces

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_DISCS = np.array([2.0, 4.0, 8.0, 16.0])
"""Radii of the discs that are tried, in half parts."""

_PARTS, _SMALLER = 4, 4
"""Parts of a piece to begin with, and of a part that has to be smaller."""

_EXACT = 1e-13
"""Error of a part, as a share of the chords' length, with which it stays as it is."""

_ROUNDS = 12  # of making parts smaller, before errors are left as they are


class ArcLength:
    """Arc lengths along a path.

    Args:
        path: its pieces, three parts.
    """

    def __init__(self, path: Pieces):
        self._path = path
        nodes, exact = path.breaks, _EXACT * (path.breaks[-1] - path.breaks[0])
        nodes = _finer(nodes, np.ones(len(nodes) - 1, bool), _PARTS)
        for _ in range(_ROUNDS):
            errors = self._error(nodes[:-1], nodes[1:])
            if not (errors > exact).any():
                break
            nodes = _finer(nodes, errors > exact, _SMALLER)
        self._nodes, self._errors = nodes, self._error(nodes[:-1], nodes[1:])
        self._lengths = np.append(0.0, np.cumsum(self._between(nodes[:-1], nodes[1:])))
        self._wrong = np.append(0.0, np.cumsum(self._errors)) + 1e-14 * self._lengths

    def at(self, u: Float[np.ndarray, "places"]) -> tuple[np.ndarray, np.ndarray]:
        """Arc lengths from the start to parameters u (m), and what they can be wrong by."""
        part = np.clip(np.searchsorted(self._nodes, u, side="right") - 1, 0, len(self._errors) - 1)
        more = self._between(self._nodes[part], u)
        return self._lengths[part] + more, self._wrong[part + 1]

    def _between(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Gauss's rule within one piece."""
        middle, half = (low + high) / 2, (high - low) / 2
        u = middle[:, None] + half[:, None] * _NODES
        taylor = self._path.at(u.ravel())[1][1]
        speed = np.sqrt((taylor**2).sum(-1)).reshape(u.shape)
        return half * (speed @ _WEIGHTS)

    def _error(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Bounds of its errors."""
        middle, half = (low + high) / 2, (high - low) / 2
        taylor = np.sqrt((self._path.at(middle)[1] ** 2).sum(-1))
        speed = taylor[1]
        radius = _DISCS[:, None] * half
        change = np.zeros_like(radius)
        for power in range(2, self._path.degree + 1):
            change += power * taylor[power] * radius ** (power - 1)
        rho = (_DISCS + np.sqrt(_DISCS**2 - 1))[:, None]
        share = 64 / 15 * rho ** (-2 * len(_NODES)) / (1 - rho**-2)
        error = np.where(change < 0.414 * speed, share * (speed + change) * half, np.inf)
        plain = 2 * half * (speed + change[0])  # the length itself is no more than that
        return np.minimum(error.min(axis=0), plain)


def _finer(nodes: np.ndarray, rough: np.ndarray, parts: int) -> np.ndarray:
    """Nodes with rough parts between them cut into equal ones."""
    low, width = nodes[:-1][rough], np.diff(nodes)[rough]
    more = low[:, None] + width[:, None] * np.arange(1, parts) / parts
    return np.sort(np.append(nodes, more.ravel()))
