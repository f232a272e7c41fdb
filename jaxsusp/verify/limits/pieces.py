"""Piecewise polynomials about given places: Taylor coefficients, and what bounds them nearby."""

from functools import cached_property
from math import factorial

import numpy as np
from scipy.interpolate import BSpline

from jaxsusp._types import Float


class Pieces:
    """Polynomials piece by piece, several beside each other.

    Args:
        coefficients: of the powers of the distance from a piece's beginning, the highest first:
            (degree + 1, pieces, parts).
        breaks: where pieces begin, and the end of the last.
    """

    def __init__(self, coefficients: np.ndarray, breaks: np.ndarray):
        self.breaks = breaks
        self.degree = len(coefficients) - 1
        self._rising = np.ascontiguousarray(coefficients[::-1])
        # What coefficients about any place of a piece are put together from, in size: they are
        # exact but for some roundings of that.
        self._sizes = _about(np.abs(self._rising), np.diff(breaks)[:, None])

    @classmethod
    def of_splines(cls, curves: list[BSpline]) -> "Pieces":
        """Splines with the same knots and degree."""
        knots, degree = np.unique(curves[0].t), curves[0].k
        taylor = [
            np.concatenate([curve(knots[:-1], nu=n) for curve in curves], axis=-1) / factorial(n)
            for n in range(degree, -1, -1)
        ]
        return cls(np.stack(taylor), knots)

    def at(self, places: Float[np.ndarray, "places"]) -> tuple[np.ndarray, np.ndarray]:
        """The pieces that places are in, and Taylor coefficients there.

        Returns:
            Numbers of the pieces; f, f', f''/2, … as (degree + 1, places, parts).
        """
        which = self._which(places)
        return which, _about(self._rising[:, which], (places - self.breaks[which])[:, None])

    def _which(self, places: np.ndarray) -> np.ndarray:
        found = np.searchsorted(self.breaks, places, side="right") - 1
        return np.clip(found, 0, len(self.breaks) - 2)

    def rounding(self, which: np.ndarray) -> np.ndarray:
        """What every Taylor coefficient in given pieces can be wrong by."""
        return 1e-14 * self._sizes[:, which]

    def jump(
        self, which: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> Float[np.ndarray, "places parts"]:
        """How far the highest coefficient between places can be from that of given pieces.

        It is the only one that jumps at the knots of a spline.
        """
        first, last = self._which(low), self._which(high)
        there = self._greatest[first, last] + np.abs(self._rising[-1, which])
        return np.where((first == last)[:, None], 0.0, there)

    @cached_property
    def _greatest(self) -> np.ndarray:
        """[i, j]: the maxima over pieces i … j."""
        sizes = np.abs(self._rising[-1])
        found = np.zeros((len(sizes), *sizes.shape))
        for first in range(len(sizes)):
            np.maximum.accumulate(sizes[first:], axis=0, out=found[first, first:])
        return found


def _about(rising: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Coefficients of the same polynomials about another place (repeated synthetic division)."""
    found = rising.copy()
    for low in range(len(found) - 1):
        for power in range(len(found) - 2, low - 1, -1):
            found[power] += found[power + 1] * place
    return found
