"""Branch and bound over time: what a quantity is at worst, and that it keeps its limit everywhere.

Every interval of time has a strip that holds the quantity. Intervals whose strip reaches beyond the
limit are halved, and so are those that may hold something worse than what is known by more than
`TOLERANCE`. All lines of a report share the intervals, and a level of halving is one array program.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxsusp.suspension.rigging import Rigging
from jaxsusp.verify.limits.passage import Course
from jaxsusp.verify.limits.quantities import Quantity, System

TOLERANCE = 0.01
"""How exact extremes are: a share of the limit, or of the distance from it where that is more."""

_FIRST = 48  # intervals to begin with
_DEEPEST = 2.0**-22  # of the duration; an interval that short is not halved any more
_MOST = 10_000  # intervals for one line, beyond which the rest of it is left unproved


class Line(NamedTuple):
    """One side of one limit."""

    quantity: Quantity
    sign: float  # 1 for a lower limit, -1 for an upper one
    limit: float
    slack: float  # how far beyond the limit rounding may be
    known: float  # the worst value seen so far

    @property
    def room(self) -> float:
        """How far the worst value known is inside the limit; negative beyond it."""
        return self.sign * (self.known - self.limit)

    def rooms(self, system: System) -> tuple[np.ndarray, np.ndarray]:
        """Lower bounds of that over intervals; upper bounds in their middles, column by column."""
        found = self.quantity(system)
        lower = (found if self.sign > 0 else -found).lower - self.sign * self.limit
        middle = self.sign * (found.middle - self.limit) + found.rest
        return lower.min(axis=1), np.nan_to_num(middle, nan=np.inf)


class Bound(NamedTuple):
    """What was found about one side of one limit."""

    sign: float  # of the line
    proved: bool
    value: float  # the quantity is proved never to be beyond this
    worst: float  # the worst value that was seen
    time: float | None  # s, when, where that is worse than what was known
    column: int  # of the quantity that was the worst then


def prove(rigging: Rigging, lines: Sequence[Line]) -> list[Bound]:
    """Prove that limits are kept at every instant, or find instants at which they are not.

    Args:
        rigging: the system along its path, in own units.
        lines: the limits.
    """
    if not lines:
        return []
    with np.errstate(all="ignore"):  # strips of which nothing is known are infinite or NaN
        search = _Search(rigging, lines)
        search.run()
        return search.bounds()


class _Search:
    """Halving, level by level over all lines at once."""

    def __init__(self, rigging: Rigging, lines: Sequence[Line]):
        self._course, self._lines = Course(rigging), lines
        self._best = np.array([line.room for line in lines])
        self._at = np.full(len(lines), np.nan)  # where that is, if it is worse than what was known
        self._column = np.zeros(len(lines), int)
        self._bound = np.full(len(lines), np.inf)
        self._slack = np.array([line.slack for line in lines])
        size = np.maximum(np.abs([line.limit for line in lines]), np.abs(self._best))
        self._tolerance = TOLERANCE * size

    def run(self) -> None:
        """Prove, or find violations."""
        breaks = self._course.schedule.breaks
        times = np.union1d(np.linspace(0, breaks[-1], _FIRST + 1), breaks)
        low, high = times[:-1], times[1:]
        shortest, spent = _DEEPEST * breaks[-1], np.zeros(len(self._lines), int)
        need = np.ones((len(low), len(self._lines)), bool)
        while len(low):
            spent += need.sum(axis=0)
            bounds = self._look(low, high, need)
            best = self._best - self._tolerance
            broken = self._best < -self._slack
            more = need & ~broken & ((bounds < -self._slack) | (bounds < best))
            more &= (high - low > shortest)[:, None] & (spent < _MOST)
            done = np.where(need & ~more, bounds, np.inf)
            self._bound = np.minimum(self._bound, done.min(axis=0))
            rows = more.any(axis=1)
            middle = (low + high)[rows] / 2
            low, high = np.append(low[rows], middle), np.append(middle, high[rows])
            need = np.tile(more[rows], (2, 1))

    def _look(self, low: np.ndarray, high: np.ndarray, need: np.ndarray) -> np.ndarray:
        """Bounds of all lines over all intervals; the middles may be worse than what is known."""
        system = System(self._course.over(low, high))
        found = np.full(need.shape, np.inf)
        for index, line in enumerate(self._lines):
            if not need[:, index].any():
                continue
            found[:, index], columns = line.rooms(system)
            middles = columns.min(axis=1)
            at = int(middles.argmin())
            if middles[at] < self._best[index]:
                self._best[index], self._at[index] = middles[at], (low[at] + high[at]) / 2
        return found

    def bounds(self) -> list[Bound]:
        """What was found, line by line."""
        self._measure()
        return [
            Bound(
                line.sign,
                bool(bound >= -line.slack),
                float(line.limit + line.sign * bound),
                float(line.limit + line.sign * best),
                None if np.isnan(at) else float(at),
                int(column),
            )
            for line, bound, best, at, column in zip(
                self._lines, self._bound, self._best, self._at, self._column, strict=True
            )
        ]

    def _measure(self) -> None:
        """Worst values at their very instants, where they are worse than what was known."""
        rows = np.flatnonzero(~np.isnan(self._at))
        if not len(rows):
            return
        times = self._at[rows]
        system = System(self._course.over(times, times))
        for row, index in enumerate(rows.tolist()):
            line = self._lines[index]
            columns = line.rooms(system)[1][row]
            if columns.min() < line.room:
                self._best[index], self._column[index] = columns.min(), columns.argmin()
            else:
                self._best[index], self._at[index] = line.room, np.nan
