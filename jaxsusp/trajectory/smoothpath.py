"""A smooth curve through the samples of a trajectory, measured by its length.

Makima is only C1: along it the acceleration jumps at every knot. A finished plan therefore runs
on a quintic spline (C4, so that the jerk is continuous) through the Makima samples, or through
samples beside them (`smoothing`). The curve is not the one that was searched: whoever uses it
checks it again.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline, CubicHermiteSpline, make_interp_spline

from jaxsusp._types import Float, Int
from jaxsusp.errors import require

_PIECES = 32
"""Parts of a span in the table of arc lengths."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)


def natural_quintic(
    u: Float[np.ndarray, "knots"], values: Float[np.ndarray, "knots parts"]
) -> BSpline:
    """The quintic spline whose third and fourth derivative vanish at both ends.

    Of all curves through the values it is the one of least ∫ |v'''|² du.
    """
    still = [(order, np.zeros(values.shape[1])) for order in (3, 4)]
    return make_interp_spline(u, values, k=5, bc_type=(still, still))


class Spline:
    """A quintic spline v(u) through values at knots u, with proven bounds of its derivatives.

    The third and fourth derivative vanish at both ends (the natural quintic spline).

    Args:
        u: knots, at least four, increasing (m).
        values: (knots, components).
    """

    def __init__(self, u: Float[np.ndarray, "knots"], values: Float[np.ndarray, "knots parts"]):
        self.u = u
        self.curve: BSpline = natural_quintic(u, values)
        first = self.curve.derivative()
        second = first.derivative()
        self.derivatives = first, second, second.derivative()

    @cached_property
    def _bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Greatest |v'| and |v''| over spans i … j, as matrices [i, j]."""
        speed, bend = self.derivatives[:2]
        return (
            _running_maximum(_bernstein_bound(speed, self.u, degree=4)),
            _running_maximum(_bernstein_bound(bend, self.u, degree=3)),
        )

    def bounds(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Proven upper bounds of |v'| and |v''| over parameter intervals.

        On a span of the spline a derivative is a polynomial, and its values lie in the convex
        hull of its Bernstein coefficients.
        """
        first = np.clip(np.searchsorted(self.u, low, side="right") - 1, 0, len(self.u) - 2)
        last = np.clip(np.searchsorted(self.u, high, side="left") - 1, first, len(self.u) - 2)
        speed, bend = self._bounds
        return speed[first, last], bend[first, last]


@dataclass(frozen=True, eq=False)
class SmoothPath:
    """A quintic spline p(u) through given points; u is the length along their chords (m).

    Args:
        points: positions (m), in order. Consecutive points that coincide count once.

    Raises:
        InputError: fewer than two points, or one that is not finite.
    """

    points: Float[np.ndarray, "samples xyz"]

    def __post_init__(self):
        require(len(self.points) >= 2, f"{len(self.points)} points: give two or more")
        require(bool(np.isfinite(self.points).all()), "a point of the path is not finite")

    @cached_property
    def _chords(self) -> tuple[np.ndarray, np.ndarray]:
        """Lengths up to every point, and which points are not where the one before is."""
        chord = np.linalg.norm(np.diff(np.asarray(self.points, np.float64), axis=0), axis=1)
        moves = np.append(True, chord > 1e-9 * max(1.0, float(chord.sum())))
        return np.append(0.0, np.cumsum(chord)), moves

    @cached_property
    def _knots(self) -> tuple[np.ndarray, np.ndarray]:
        """Parameters, at least four of them, and the (fractional) numbers of the points there."""
        u, moves = self._chords
        u, number = u[moves], np.flatnonzero(moves).astype(np.float64)
        number[-1] = len(moves) - 1
        if len(u) == 1:  # a path that stays where it is
            u, number = np.array([0.0, 1.0]), np.array([0.0, 0.0])
        while len(u) < 4:  # the natural quintic spline needs four
            halves = np.linspace(0, len(u) - 1, 2 * len(u) - 1)
            rows = np.arange(len(u))
            number, u = np.interp(halves, rows, number), np.interp(halves, rows, u)
        return u, number

    @property
    def marks(self) -> tuple[Float[np.ndarray, "samples"], Int[np.ndarray, "distinct"]]:
        """The parameter of every point, and which points are not where the one before is."""
        u, moves = self._chords
        return u, np.flatnonzero(moves)

    def beside(self, rows: Float[np.ndarray, "samples *parts"]) -> Spline:
        """A spline in this path's parameter, through one row of values per point."""
        u, number = self._knots
        flat = np.asarray(rows, np.float64).reshape(len(rows), -1)
        pauses = np.flatnonzero(~self._chords[1])
        require(
            bool((np.abs(flat[pauses] - flat[pauses - 1]) <= 1e-6).all()),
            f"values change at point {pauses[:1]} of the path, where it does not move; what goes "
            "beside a path moves along with it",
        )
        below, share = np.floor(number).astype(int), (number % 1)[:, None]
        above = np.minimum(below + 1, len(flat) - 1)
        return Spline(u, (1 - share) * flat[below] + share * flat[above])

    @cached_property
    def spline(self) -> Spline:
        """The curve with its bounds."""
        return self.beside(self.points)

    @property
    def curve(self) -> BSpline:
        """The curve itself."""
        return self.spline.curve

    @property
    def derivatives(self) -> tuple[BSpline, BSpline, BSpline]:
        """p', p'' and p''' with respect to u."""
        return self.spline.derivatives

    def by_arc(self, u: Float[np.ndarray, "places"]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """First to third derivative of the curve with respect to its arc length (1, 1/m, 1/m²).

        With σ = |p'| the parameter follows from σ du/ds = 1 and its derivatives.
        """
        p1, p2, p3 = (derivative(u) for derivative in self.derivatives)
        speed = np.maximum(np.linalg.norm(p1, axis=-1, keepdims=True), 1e-9)
        along = _rows(p1, p2) / speed  # dσ/du
        bend = (_rows(p2, p2) + _rows(p1, p3) - along**2) / speed  # d²σ/du²
        u1 = 1 / speed
        u2 = -along * u1**2 / speed
        u3 = -(bend * u1**3 + 3 * along * u1 * u2) / speed
        return p1 * u1, p1 * u2 + p2 * u1**2, p1 * u3 + 3 * p2 * u1 * u2 + p3 * u1**3

    @property
    def span(self) -> tuple[float, float]:
        """First and last parameter."""
        u = self._knots[0]
        return float(u[0]), float(u[-1])

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Parameters, arc lengths up to them, and speeds |p'| there."""
        u = self._knots[0]
        parts = np.linspace(u[:-1], u[1:], _PIECES, endpoint=False, axis=1).ravel()
        nodes = np.append(parts, u[-1])
        middle, half = (nodes[1:] + nodes[:-1]) / 2, np.diff(nodes) / 2
        inside = middle[:, None] + half[:, None] * _NODES
        speed = np.linalg.norm(self.derivatives[0](inside), axis=-1)
        arc = np.append(0.0, np.cumsum(half * (speed @ _WEIGHTS)))
        return nodes, arc, np.linalg.norm(self.derivatives[0](nodes), axis=-1)

    @property
    def length(self) -> float:
        """Arc length of the whole curve (m)."""
        return float(self._table[1][-1])

    def arc(self, u: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch"]:
        """Arc length (m) from the start to parameter u."""
        return CubicHermiteSpline(*self._table)(u)

    @cached_property
    def _inverse(self) -> CubicHermiteSpline:
        nodes, arc, speed = self._table
        return CubicHermiteSpline(arc, nodes, 1 / np.maximum(speed, 1e-9))

    def parameter(self, arc: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch"]:
        """Parameter u at an arc length (m)."""
        u = np.clip(self._inverse(arc), *self.span)
        speed = np.maximum(np.linalg.norm(self.derivatives[0](u), axis=-1), 1e-9)
        return np.clip(u + (arc - self.arc(u)) / speed, *self.span)  # one Newton step


def _rows(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1, keepdims=True)


def _bernstein_bound(curve: BSpline, knots: np.ndarray, degree: int) -> np.ndarray:
    """Per span, the greatest norm among the Bernstein coefficients of a vector polynomial."""
    left, width = knots[:-1], np.diff(knots)[:, None]
    taylor = [
        curve(left, nu=j) * width**j / math.factorial(j) for j in range(degree + 1)
    ]  # coefficients of the powers of (u - left)/width
    control = [
        sum(math.comb(i, j) / math.comb(degree, j) * taylor[j] for j in range(i + 1))
        for i in range(degree + 1)
    ]
    return np.linalg.norm(control, axis=-1).max(axis=0)


def _running_maximum(values: np.ndarray) -> np.ndarray:
    """Matrix [i, j] of the maxima of values[i … j]; below the diagonal of no meaning."""
    return np.stack(
        [np.append(values[:i], np.maximum.accumulate(values[i:])) for i in range(len(values))]
    )
