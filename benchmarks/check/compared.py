"""Two series of seconds in turns: medians, and the ratio with an interval that assumes nothing."""

import statistics
from collections.abc import Sequence
from typing import NamedTuple

import pandas as pd
from scipy.stats import binom

from jaxsusp.report.render import Column

LEVEL = 0.95

LEAST = 5
"""Turns at least; six are needed before an interval can have 95 %."""

SLOWER = 1.05
"""Ratio that has to be surpassed by all of the interval before a canary counts as slower."""


class Interval(NamedTuple):
    """Of a median, from an ordered sample: how sure it is that the median lies in it."""

    low: float
    high: float
    level: float


def median_interval(values: Sequence[float], level: float = LEVEL) -> Interval:
    """Interval of the median of whatever distribution, between two of the ordered values.

    As many values are below the median as heads fall, so how often the median lies outside of the
    k-th from below and from above is a sum of binomial chances. The narrowest that reaches the
    level counts; of too few values the widest there is.
    """
    ordered, count = sorted(values), len(values)
    chances = [1 - 2 * binom.cdf(k, count, 0.5) for k in range((count + 1) // 2)]
    k = max((k for k, chance in enumerate(chances) if chance >= level), default=0)
    return Interval(ordered[k], ordered[-1 - k], float(chances[k]))


class Compared(NamedTuple):
    """A canary of two trees."""

    name: str
    first: float  # median seconds of the tree that is compared against
    second: float  # … and of this one
    ratio: float  # median of the ratios of the turns: above 1 this one is slower
    low: float
    high: float
    level: float

    @property
    def slower(self) -> bool:
        """Whether it surely is, by more than is tolerated."""
        return self.low > SLOWER


def compared(name: str, first: Sequence[float], second: Sequence[float]) -> Compared:
    """What the turns of a canary come to."""
    ratios = [mine / theirs for theirs, mine in zip(first, second, strict=True)]
    medians = statistics.median(first), statistics.median(second)
    return Compared(name, *medians, statistics.median(ratios), *median_interval(ratios))


def table(found: Sequence[Compared], names: tuple[str, str]) -> pd.DataFrame:
    """A row per canary."""
    frame = pd.DataFrame([row._asdict() for row in found])
    frame["level"] = 100 * frame["level"]
    frame["verdict"] = ["slower" if row.slower else "" for row in found]
    frame.attrs["title"] = f"{names[1]} against {names[0]}"
    frame.attrs["columns"] = {
        "name": Column("canary"),
        "first": Column(f"{names[0]} (s)", "{:.4f}".format),
        "second": Column(f"{names[1]} (s)", "{:.4f}".format),
        "ratio": Column("ratio", "{:.3f}".format),
        "low": Column("from", "{:.3f}".format),
        "high": Column("to", "{:.3f}".format),
        "level": Column("level (%)", "{:.0f}".format),
        "verdict": Column(""),
    }
    return frame
