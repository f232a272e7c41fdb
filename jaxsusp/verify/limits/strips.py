"""Strips: straight lines with a width that hold functions over whole intervals.

A function f over an interval with middle t_m and half length h lies in the strip

    f(t_m + s h) ∈ middle + s slope ± rest    for all s in [-1, 1].

Sums, products, quotients and roots of strips are strips again that hold sums, products, quotients
and roots of what they hold (Taylor models of first order). `rest` falls with h², so that halving an
interval makes the bounds of a smooth function four times as exact. Rounding is part of it: every
operation adds to `rest` what its own arithmetic can be wrong by.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from jaxsusp._types import Float

EPS = 2e-15
"""More than what the few operations of one step round off, of the size of what they work with."""

TINY = 1e-300
"""More than what a product loses where it underflows."""


class Strip:
    """Many strips as three arrays of one shape: the intervals first, then any further axes.

    Where nothing is known `rest` is infinite or NaN; `lower` and `upper` are then infinite.
    """

    __slots__ = ("_size", "middle", "rest", "slope")
    __array_ufunc__ = None  # an array on the left leaves sums and products to the methods here

    def __init__(self, middle: np.ndarray, slope: np.ndarray, rest: np.ndarray):
        self.middle, self.slope, self.rest = middle, slope, rest
        self._size: np.ndarray | None = None

    @classmethod
    def still(cls, values: np.ndarray) -> "Strip":
        """What does not change."""
        nothing = np.zeros_like(values)
        return cls(values, nothing, nothing)

    @classmethod
    def between(cls, low: np.ndarray, high: np.ndarray) -> "Strip":
        """What is only known to lie between two numbers."""
        middle = (low + high) / 2
        return cls(middle, np.zeros_like(middle), (high - low) / 2 + EPS * np.abs(middle))

    @property
    def size(self) -> np.ndarray:
        """How large the line gets in size."""
        if self._size is None:
            self._size = np.abs(self.middle) + np.abs(self.slope)
        return self._size

    @property
    def reach(self) -> np.ndarray:
        """How far values can be from the middle."""
        return np.abs(self.slope) + self.rest

    @property
    def lower(self) -> Float[np.ndarray, "..."]:
        """A number that no value over the interval is below."""
        found = self.middle - self.reach
        return np.where(np.isnan(found), -np.inf, found)

    @property
    def upper(self) -> Float[np.ndarray, "..."]:
        """A number that no value over the interval is above."""
        found = self.middle + self.reach
        return np.where(np.isnan(found), np.inf, found)

    def __getitem__(self, part: Any) -> "Strip":
        return Strip(self.middle[part], self.slope[part], self.rest[part])

    def __neg__(self) -> "Strip":
        return Strip(-self.middle, -self.slope, self.rest)

    def __add__(self, other: "Strip | np.ndarray | float") -> "Strip":
        if isinstance(other, Strip):
            return _sum(self.middle + other.middle, self.slope + other.slope, self.rest, other.rest)
        middle = self.middle + other
        rest = self.rest + EPS * np.abs(middle)
        return Strip(middle, *(np.broadcast_to(each, middle.shape) for each in (self.slope, rest)))

    __radd__ = __add__

    def __sub__(self, other: "Strip | np.ndarray | float") -> "Strip":
        if isinstance(other, Strip):
            return _sum(self.middle - other.middle, self.slope - other.slope, self.rest, other.rest)
        return self + (-other)

    def __rsub__(self, other: np.ndarray | float) -> "Strip":
        return (-self) + other

    def __mul__(self, other: "Strip | np.ndarray | float") -> "Strip":
        if isinstance(other, Strip):
            return self._times(other)
        size = np.abs(other)
        rest = self.rest * size + EPS * (self.size * size) + TINY
        return Strip(self.middle * other, self.slope * other, rest)

    __rmul__ = __mul__

    def _times(self, other: "Strip") -> "Strip":
        # s² lies in [0, 1]: half of it belongs to the middle.
        bent = self.slope * other.slope / 2
        mine, its = self.size, other.size
        rest = self.rest * (its + other.rest) + mine * (other.rest + EPS * its) + np.abs(bent)
        rest = rest + TINY
        slope = self.middle * other.slope + self.slope * other.middle
        return Strip(self.middle * other.middle + bent, slope, rest)

    def sum(self, axis: int) -> "Strip":
        """The sum along an axis behind that of the intervals."""
        rest = self.rest.sum(axis) + EPS * self.size.sum(axis)
        return Strip(self.middle.sum(axis), self.slope.sum(axis), rest)

    def lifted(
        self, value: np.ndarray, rate: np.ndarray, low: np.ndarray, high: np.ndarray
    ) -> "Strip":
        """A function of what this holds.

        Args:
            value: of the function, at the middle.
            rate: its derivative there.
            low: a lower bound of its second derivative wherever the argument can be.
            high: an upper bound.
        """
        square = self.reach**2 / 2
        low, high = np.minimum(low, 0) * square, np.maximum(high, 0) * square
        slope = rate * self.slope
        rest = np.abs(rate) * self.rest + (high - low) / 2
        rest = rest + EPS * (np.abs(value) + np.abs(rate) * self.size)
        return Strip(value + (low + high) / 2, slope, rest)

    def monotone(self, function: Callable, low: float, high: float) -> "Strip":
        """A monotone function of an argument within [low, high], by its two ends alone."""
        ends = function(np.clip(self.lower, low, high)), function(np.clip(self.upper, low, high))
        return Strip.between(np.minimum(*ends), np.maximum(*ends))

    def or_where(self, narrow: np.ndarray, other: "Strip") -> "Strip":
        """This where the condition holds, and another where it does not."""
        return Strip(
            np.where(narrow, self.middle, other.middle),
            np.where(narrow, self.slope, other.slope),
            np.where(narrow, self.rest, other.rest),
        )

    def inverse(self) -> "Strip":
        """1/x; nothing is known where x can be zero."""
        low, high = self.lower, self.upper
        fine = (low > 0) | (high < 0)
        middle = np.where(fine, self.middle, 1.0)
        value = 1 / middle
        ends = 2 / np.where(fine, low, 1.0) ** 3, 2 / np.where(fine, high, 1.0) ** 3
        found = self.lifted(value, -(value**2), np.minimum(*ends), np.maximum(*ends))
        return Strip(found.middle, found.slope, np.where(fine, found.rest, np.inf))

    def root(self) -> "Strip":
        """√x of an x that is never negative, whatever its bounds say."""
        low, high = self.lower, self.upper
        fine = low > 0
        middle = np.where(fine, self.middle, 1.0)
        value = np.sqrt(middle)
        steep, flat = (
            -0.25 / np.where(fine, end, 1.0) ** 1.5 for end in (low, high)
        )  # the second derivative at both ends
        found = self.lifted(value, 0.5 / value, steep, flat)
        return found.or_where(fine, self.monotone(np.sqrt, 0.0, np.inf))

    def cube_root(self) -> "Strip":
        """∛ of what is left of x when it is clipped to [0, 1]."""
        low, high = self.lower, self.upper
        fine = (low > 0) & (high < 1)
        middle = np.where(fine, self.middle, 1.0)
        value = np.cbrt(middle)
        steep, flat = (-2 / 9 * np.where(fine, end, 1.0) ** (-5 / 3) for end in (low, high))
        found = self.lifted(value, value / (3 * middle), steep, flat)
        clipped = self.monotone(np.cbrt, 0.0, 1.0)
        return found.or_where(fine & (found.reach < clipped.rest), clipped)

    def arc_tangent(self) -> "Strip":
        """Arctan x, whose second derivative is no larger than 0.65."""
        one = 1 + self.middle**2
        most = np.full_like(one, 0.65)
        return self.lifted(np.arctan(self.middle), 1 / one, -most, most)

    def arc_cosine(self) -> "Strip":
        """Arccos x of an x that is never beyond ±1, whatever its bounds say."""
        low, high = self.lower, self.upper
        fine = (low > -1) & (high < 1)
        middle = np.where(fine, self.middle, 0.0)
        ends = [
            -end / (1 - end**2) ** 1.5 for end in (np.where(fine, each, 0) for each in (low, high))
        ]  # the second derivative falls with x
        found = self.lifted(np.arccos(middle), -1 / np.sqrt(1 - middle**2), ends[1], ends[0])
        return found.or_where(fine, self.monotone(np.arccos, -1.0, 1.0))


def _sum(middle: np.ndarray, slope: np.ndarray, one: np.ndarray, other: np.ndarray) -> Strip:
    found = Strip(middle, slope, middle)
    found.rest = one + other + EPS * found.size
    return found


def dot(a: Strip, b: Strip | np.ndarray) -> Strip:
    """Products of vectors in the last axis."""
    return (a * b).sum(-1)


def cross(a: Strip, b: Strip) -> Strip:
    """Cross products of vectors in the last axis."""
    one, two = [1, 2, 0], [2, 0, 1]
    return a[..., one] * b[..., two] - a[..., two] * b[..., one]


def norm(v: Strip) -> Strip:
    """Lengths of vectors in the last axis."""
    square = dot(v, v).root()
    # About zero the square tells less than the components themselves.
    most = np.sqrt((np.maximum(np.abs(v.lower), np.abs(v.upper)) ** 2).sum(-1))
    plain = Strip.between(np.zeros_like(most), most)
    return square.or_where(square.reach <= plain.rest, plain)


def heading(x: Strip, y: Strip) -> Strip:
    """The angle atan2(y, x) (rad), continuous over every interval, of vectors that are not zero."""
    length = np.hypot(x.middle, y.middle)
    length = np.where(length > 0, length, 1.0)
    c, s = x.middle / length, y.middle / length
    ahead, aside = x * c + y * s, y * c - x * s
    return (aside * ahead.inverse()).arc_tangent() + np.arctan2(s, c)


def least(strips: Strip) -> Strip:
    """The least of the strips in the last axis, as one strip.

    It is the one that is least in the middle, but for what others can be below it elsewhere.
    """
    at = np.argmin(np.where(np.isnan(strips.middle), -np.inf, strips.middle), axis=-1)[..., None]
    first = Strip(*(np.take_along_axis(each, at, -1) for each in (
        strips.middle, strips.slope, strips.rest)))  # fmt: skip
    below = first.middle - strips.middle + np.abs(first.slope - strips.slope)
    below = np.maximum(below + first.rest + strips.rest, 0)
    np.put_along_axis(below, at, 0.0, -1)
    gap = below.max(axis=-1) / 2
    first = first[..., 0]
    return Strip(first.middle - gap, first.slope, first.rest + gap)


def stacked(strips: list[Strip]) -> Strip:
    """Strips of one shape beside each other in a new last axis."""
    return Strip(
        *(
            np.stack([getattr(each, name) for each in strips], axis=-1)
            for name in ("middle", "slope", "rest")
        )
    )
