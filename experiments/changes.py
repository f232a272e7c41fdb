"""What runs end with in one place against another: fitness and clear runs, with intervals."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from jaxsusp.report.comparison.gaps import clear_runs
from jaxsusp.studies.resampling import crossed_interval, logarithm, mean_of


class Change(NamedTuple):
    """An estimate and its 95 % interval."""

    middle: float
    low: float
    high: float

    @property
    def sure(self) -> int:
        """−1 where the interval is below 0, 1 where it is above, 0 where it holds 0."""
        return int(self.low > 0) - int(self.high < 0)


def fitness_change(one: xr.Dataset, other: xr.Dataset) -> Change:
    """Change of the geometric mean of the fitness from one to the other in %.

    Both are of one algorithm, (scenario, run). A run is paired with that of the same number, which
    has the same key; the interval is for these scenarios and other runs. Pairs of which one found
    nothing are left out.
    """
    pair = [logarithm(ds["fitness"].transpose("scenario", "run").values) for ds in (one, other)]
    return Change(*(100 * np.expm1(_change(*pair))).tolist())


def found_nothing(*sets: xr.Dataset) -> str:
    """A sentence on runs without a finite fitness; "" where there are none."""
    finite = np.concatenate([np.isfinite(ds["fitness"].values).ravel() for ds in sets])
    if finite.all():
        return ""
    return (
        f"{(~finite).sum()} of {finite.size} runs found nothing: they rank last, and are left out "
        "where fitness is averaged."
    )


def clear_change(one: xr.Dataset, other: xr.Dataset) -> Change:
    """Change of the share of clear runs in percentage points."""
    pair = [100.0 * clear_runs(ds).transpose("scenario", "run").values for ds in (one, other)]
    return Change(*_change(*pair).tolist())


def _change(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Mean and interval of what changes."""
    by_run = other - one
    return np.array([mean_of(by_run), *crossed_interval(by_run, scenes_vary=False)])
