"""Expected running times with intervals: what restarts until success cost, and how sure that is."""

import numpy as np
import pandas as pd
import xarray as xr
from jaxtyping import Bool, Float

from jaxsusp.report.comparison.gaps import NEAR, clear_fitness, evaluations_to
from jaxsusp.report.render import Column, evaluations


def running_time_table(
    ds: xr.Dataset, level: float = 0.95, resamples: int = 2000, seed: int = 0
) -> pd.DataFrame:
    """ERT of every algorithm to every target, with a bootstrap interval over the runs.

    Args:
        ds: a comparison.
        level: coverage of the intervals, in (0, 1).
        resamples: number of bootstrap samples.
        seed: of the resampling, the same for every cell.

    Returns:
        One row per scenario, algorithm and target ("clear", "+10 %", "+1 %") that is known: columns
        scenario, algorithm, target, reached (of `runs`), ert, low, high, in fitness evaluations.
        ∞ where no run, or not every resample, gets there; low and high are NaN for one run.
    """
    targets = {"clear": clear_fitness(ds)} | {
        f"+{100 * near:g} %": (1 + near) * ds["best_known"] for near in NEAR.values()
    }
    rows = []
    for target, fitness in targets.items():
        needed = evaluations_to(ds, fitness)
        for scenario in ds["scenario"].values.tolist():
            for algorithm in ds["algorithm"].values.tolist():
                cell = {"scenario": scenario, "algorithm": algorithm}
                spent = needed.sel(cell).values
                spent = spent[~np.isnan(spent)]
                if len(spent):
                    budget = float(ds["evaluations"].sel(cell).item())
                    interval = bootstrap(spent, budget, level, resamples, seed)
                    reached = int(np.isfinite(spent).sum())
                    rows.append((scenario, algorithm, target, reached, len(spent), *interval))
    columns = ["scenario", "algorithm", "target", "reached", "runs", "ert", "low", "high"]
    frame = pd.DataFrame(rows, columns=columns)
    order = {name: place for place, name in enumerate(ds["scenario"].values.tolist())}
    frame = frame.sort_values("scenario", key=lambda names: names.map(order), kind="stable")
    frame = frame.reset_index(drop=True)
    frame.attrs["title"] = "Expected running times"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["columns"] = {
        "reached": Column("reached", out_of="runs"),
        "ert": Column("ERT", evaluations),
        "low": Column("low", evaluations),
        "high": Column("high", evaluations),
    }
    frame.attrs["caption"] = (
        "ERT: evaluations of all runs until the iteration ends that gets there, or to their end, "
        "over the number of runs that get there. Targets: a first clear trajectory, and 10 % and "
        f"1 % above the best known fitness. Low and high: bootstrap {100 * level:g} % interval "
        f"(percentiles), {resamples} resamples of the runs, seed {seed}; ∞ where that many "
        "resamples have no run that gets there."
    )
    return frame


DRAWN = 2**22
"""Values that are drawn at a time."""


def bootstrap(
    spent: Float[np.ndarray, " runs"], budget: float, level: float, resamples: int, seed: int
) -> tuple[float, float, float]:
    """ERT of runs, and the interval of it.

    Args:
        spent: evaluations until the target, ∞ of runs that miss it.
        budget: evaluations of a run that misses it.
        level: coverage.
        resamples: bootstrap samples.
        seed: of them.
    """
    reached = np.isfinite(spent)
    cost = np.where(reached, spent, budget)
    ert = float(_expected(cost[None], reached[None])[0])
    if len(spent) < 2:
        return ert, np.nan, np.nan
    rng, at_once = np.random.default_rng(seed), max(1, DRAWN // len(spent))
    found = np.empty(0)
    for first in range(0, resamples, at_once):  # of 100,000 runs all at once fill no memory
        size = min(at_once, resamples - first), len(spent)
        picks = rng.integers(len(spent), size=size)
        found = np.append(found, _expected(cost[picks], reached[picks]))
    low, high = np.quantile(found, [(1 - level) / 2, (1 + level) / 2], method="inverted_cdf")
    return ert, float(low), float(high)


def _expected(
    cost: Float[np.ndarray, "samples runs"], reached: Bool[np.ndarray, "samples runs"]
) -> Float[np.ndarray, " samples"]:
    count = reached.sum(axis=1)
    total = cost.sum(axis=1).astype(np.float64)
    return np.divide(total, count, out=np.full(len(total), np.inf), where=count > 0)
