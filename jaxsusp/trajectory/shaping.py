"""Laws after which nothing swings on: a law played several times at once, each a little later.

A pendulum answers two equal pushes half a period apart with swings that cancel. A law that is the
mean of itself now and half a period later leaves no swing of that period, whatever it was (Singer
and Seering 1990, J. Dyn. Syst. Meas. Control 112:76). Done twice (ZVD) hardly any is left either
where the period is a little off.
"""

import math

import numpy as np
from scipy.interpolate import PPoly

from jaxsusp.trajectory.timelaw import TimeLaw


def impulses(damping: float) -> tuple[tuple[float, float], ...]:
    """ZVD: shares of the law, and by how much of a period each comes later.

    Args:
        damping: of the swing, as a share of critical damping: later pushes meet less of it.
    """
    left = math.exp(-damping * math.pi / math.sqrt(1 - damping**2))  # of a swing, half a period on
    return tuple(
        (share * left**i / (1 + left) ** 2, i / 2) for i, share in enumerate((1.0, 2.0, 1.0))
    )


def shaped(law: TimeLaw, period: float, damping: float = 0.0) -> TimeLaw:
    """A law that leaves no swing of a period (s) and damping; it takes one period longer."""
    parts = [(share, late * period) for share, late in impulses(damping)]
    delays = [delay for _, delay in parts]
    breaks = np.unique(np.concatenate([law.law.x + delay for delay in delays]))
    breaks = breaks[np.append(True, np.diff(breaks) > 1e-9 * breaks[-1])]
    breaks[-1] = law.duration + max(delays)
    middle, left = (breaks[1:] + breaks[:-1]) / 2, breaks[:-1]
    degree = len(law.law.c) - 1
    pieces = np.zeros((degree + 1, len(left)))
    for share, delay in parts:
        pieces += share * _moved(law.law, left - delay, middle - delay, degree)
    return TimeLaw(law.path, PPoly(pieces, breaks, extrapolate=False))


def _moved(law: PPoly, left: np.ndarray, inside: np.ndarray, degree: int) -> np.ndarray:
    """Coefficients of a law about times left, of the pieces in which the times inside lie."""
    piece = np.clip(np.searchsorted(law.x, inside, side="right") - 1, 0, law.c.shape[1] - 1)
    ahead = left - law.x[piece]
    about = np.zeros((degree + 1, len(left)))
    for power in range(degree + 1):  # of (t - left), from a Taylor expansion
        for higher in range(power, degree + 1):
            factor = math.comb(higher, power) * ahead ** (higher - power)
            about[degree - power] += law.c[degree - higher, piece] * factor
    level = np.zeros_like(about)
    level[degree] = float(law(law.x[-1]))
    about = np.where(inside > law.x[-1], level, about)
    return np.where(inside < law.x[0], 0.0, about)
