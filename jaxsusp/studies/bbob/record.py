"""What is kept of a run, of all that it evaluated: what COCO's observer would log, and no more.

The observer logs an evaluation by two rules: one that brings the best value into a new class of
distances to f_opt (file .dat), and one whose number is in a fixed series (file .tdat).
"""

import math
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float

FINAL = 1e-8
"""Distance to f_opt at which a function counts as solved, and a run ends."""

CLASSES, WIDTH = 20, 1e5
"""Classes of distances per decade, and width of the even classes that count as well."""


class Logged(NamedTuple):
    """Evaluations that are logged, host arrays with a row each."""

    evaluation: np.ndarray  # (L,), counted from 1
    value: Float[np.ndarray, "lines"]  # f of this one
    best: Float[np.ndarray, "lines"]  # least f so far, at least f_opt
    x: Float[np.ndarray, "lines dim"]


class Record:
    """One run, told in portions of evaluations in their order.

    Args:
        dim: number D of variables.
        least: f_opt.
        budget: evaluations after which the run ends, if it has not solved the function before.
    """

    def __init__(self, dim: int, least: float, budget: int):
        self.least, self.budget = least, budget
        self.evaluations = 0
        self.best, self.best_x = math.inf, np.full(dim, np.nan)
        self._series = series(dim, budget)
        self._class = (math.inf, math.inf)
        self._by_target: list[Logged] = []
        self._by_number: list[Logged] = []
        self._steps: list[np.ndarray] = []  # (evaluation, distance) of every improvement

    @property
    def ended(self) -> bool:
        """Whether the function is solved or the budget spent."""
        return self.best - self.least <= FINAL or self.evaluations >= self.budget

    def add(self, x: Float[np.ndarray, "asked dim"], value: Float[np.ndarray, "asked"]) -> None:
        """Take note of the next evaluations, as far as the run lasts; a NaN is none that counts."""
        if self.ended or len(value) == 0:
            return
        value = np.where(np.isnan(value), np.inf, value)
        least = np.maximum(value, self.least)
        best = np.minimum.accumulate(np.append(self.best, least))[1:]
        solved = np.flatnonzero(best - self.least <= FINAL)
        last = min(self.budget - self.evaluations, *(solved[:1] + 1), len(value))
        x, value, best = x[:last], value[:last], best[:last]

        improved = np.flatnonzero(best < np.append(self.best, best[:-1]))
        number = self.evaluations + 1 + np.arange(last)
        first, stop = np.searchsorted(self._series, [number[0], number[-1] + 1])
        due = self._series[first:stop] - number[0]
        chosen = improved[self._new_classes(number[improved], best[improved] - self.least)]
        self._by_target.append(Logged(number[chosen], value[chosen], best[chosen], x[chosen]))
        self._by_number.append(Logged(number[due], value[due], best[due], x[due]))
        self._steps.append(np.stack([number[improved], best[improved] - self.least]))
        self.evaluations += last
        if len(improved):
            self.best, self.best_x = float(best[-1]), x[improved[-1]].copy()

    def by_target(self) -> Logged:
        """What is logged for its distance to f_opt, and the best one again at the end."""
        return self._finished(self._by_target)

    def by_number(self) -> Logged:
        """What is logged for its number, and the best one at the end."""
        return self._finished(self._by_number)

    def reached(self, targets: Float[np.ndarray, "targets"]) -> Float[np.ndarray, "targets"]:
        """Evaluations until each distance to f_opt is reached; NaN where it is not."""
        number, distance = np.concatenate([np.empty((2, 0)), *self._steps], axis=1)
        place = np.searchsorted(-distance, -np.asarray(targets))
        return np.append(number, np.nan)[place]

    def _new_classes(self, number: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Which improvements are logged: the run's first evaluation, and any in a new class."""
        fresh = np.zeros(len(number), bool)
        for k, (count, each) in enumerate(zip(number, distance, strict=True)):
            classes = (class_of(each), math.ceil(each / WIDTH))
            fresh[k] = count == 1 or classes[0] < self._class[0] or classes[1] < self._class[1]
            if count > 1:  # the observer does not look at the class of the first one
                self._class = classes
        return fresh

    def _finished(self, parts: list[Logged]) -> Logged:
        logged = Logged(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
        if logged.evaluation[-1] == self.evaluations:
            return logged
        best = np.array([self.best])
        end = Logged(np.array([self.evaluations]), best, best, self.best_x[None])
        return Logged(*(np.concatenate(columns) for columns in zip(logged, end, strict=True)))


def series(dim: int, budget: int) -> np.ndarray:
    """Numbers of evaluations that are logged: 20 per decade, and D times 1, 2 or 5 times 10^k."""
    decades = math.ceil(math.log10(budget)) + 1
    even = {math.floor(10 ** (k / 20)) for k in range(20 * decades)}
    whole = {base * dim * 10**k for base in (1, 2, 5) for k in range(decades)}
    return np.array(sorted(number for number in even | whole if number <= budget))


def class_of(distance: float) -> int:
    """The number of the twentieth of a decade that a distance is in; 0 is in one of its own."""
    counted = FINAL / 10 if distance == 0 else max(distance, FINAL)
    return math.ceil(math.log10(counted) * CLASSES)
