"""Power laws of what something costs: exponents with intervals, and where a fixed part ends."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import f as f_distribution
from scipy.stats import t as t_distribution

LEVEL = 0.95

GROWS = 1.2
"""Ratio of the greatest to the least cost below which no exponent is told."""


class Law(NamedTuple):
    """cost = fixed + factor sizeᵖ."""

    exponent: float
    low: float
    high: float
    factor: float
    fixed: float  # 0 where a power alone explains the points as well
    grows: bool = True

    def at(self, size: np.ndarray) -> np.ndarray:
        """The cost of some sizes."""
        return self.fixed + self.factor * np.asarray(size, float) ** self.exponent

    @property
    def bend(self) -> float:
        """The size at which the fixed part is half of the cost; 0 where there is none."""
        if self.fixed <= 0 or self.exponent <= 0:
            return 0.0
        return (self.fixed / self.factor) ** (1 / self.exponent)


def fitted(sizes: Sequence[float], costs: Sequence[float]) -> Law:
    """Least squares of the logarithms; a fixed part only where an F test asks for it.

    The interval of the exponent is that of the linearised problem, with Student's t for as many
    degrees of freedom as points are left over.
    """
    x, y = np.asarray(sizes, float), np.asarray(costs, float)
    if y.max() < GROWS * y.min():
        return Law(0.0, 0.0, 0.0, float(np.exp(np.log(y).mean())), 0.0, False)
    slope, intercept = np.polyfit(np.log(x), np.log(y), 1)
    plain = np.array([math.exp(intercept), slope])
    left = np.log(y) - np.log(plain[0] * x ** plain[1])
    best, jacobian, error = plain, np.column_stack([np.ones_like(x), np.log(x)]), float(left @ left)
    fixed = 0.0
    if len(x) >= 5:
        found = _with_fixed(x, y)
        more, spare = 2 * found.cost, len(x) - 3
        gain = (error - more) / (more / spare) if more > 0 else math.inf
        if f_distribution.sf(gain, 1, spare) < 1 - LEVEL:
            fixed, *best = np.exp(found.x[:2]).tolist(), found.x[2]
            fixed, best = fixed[0], np.array([fixed[1], found.x[2]])
            jacobian, error = found.jac, more
    spare = len(x) - jacobian.shape[1]
    spread = np.linalg.pinv(jacobian.T @ jacobian)[-1, -1] * error / max(spare, 1)
    half = t_distribution.ppf((1 + LEVEL) / 2, spare) * math.sqrt(spread) if spare > 0 else math.inf
    p = float(best[1])
    return Law(p, p - half, p + half, float(best[0]), float(fixed))


def _with_fixed(x: np.ndarray, y: np.ndarray):
    """Log fixed, log factor and exponent."""

    def residual(values: np.ndarray) -> np.ndarray:
        return np.log(np.exp(values[0]) + np.exp(values[1] + values[2] * np.log(x))) - np.log(y)

    steep = math.log(y[-1] / y[-2]) / math.log(x[-1] / x[-2])
    begin = [math.log(0.9 * y[0]), math.log(y[-1]) - steep * math.log(x[-1]), steep]
    return least_squares(residual, begin)


def tenfold(sizes: Sequence[float], costs: Sequence[float]) -> np.ndarray:
    """What ten times the work costs, from every size to the next: 10 where cost is proportional."""
    x, y = np.log(np.asarray(sizes, float)), np.log(np.asarray(costs, float))
    return 10 ** (np.diff(y) / np.diff(x))


def surely_above(
    sizes: Sequence[float], least: Sequence[float], most: Sequence[float], limit: float
) -> np.ndarray:
    """Whether ten times the work costs more, even by the quickest of one and slowest of another."""
    x, low, high = (np.log(np.asarray(each, float)) for each in (sizes, least, most))
    return 10 ** ((low[1:] - high[:-1]) / np.diff(x)) > limit
