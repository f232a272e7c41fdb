"""How far algorithms stay above the best known fitness, and what it costs them to come near.

The running time to a target is counted in fitness evaluations, at the end of the iteration that
reached it. Of runs that do not all reach it, the expected running time (ERT) of restarts until one
does is the evaluations of all runs up to the target, the whole budget where it is missed, over the
number of runs that reached it (Auger & Hansen, "Performance evaluation of an advanced local search
evolutionary algorithm", CEC 2005; Hansen et al., "COCO", Optim. Methods Softw. 36, 2021).
"""

import json
import tomllib
from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from jaxsusp.report.comparison.statistics import median
from jaxsusp.report.render import Column, above, evaluations

NEAR = {"ert_10": 0.10, "ert_1": 0.01}
"""Targets of the table: gaps, by the names of their columns."""

_ROUNDING = 1e-9  # relative; two re-evaluations of one trajectory differ by less


def gaps(ds: xr.Dataset) -> xr.DataArray:
    """Fitness over the best known, minus 1, of every run; NaN where none (above 0) is known."""
    return ds["fitness"] / _known(ds) - 1


def mean_gap(ds: xr.Dataset) -> xr.DataArray:
    """Mean gap over the runs in % (scenario, algorithm)."""
    return 100 * gaps(ds).mean("run")


def evaluations_to(ds: xr.Dataset, target: xr.DataArray | float) -> xr.DataArray:
    """Fitness evaluations of every run until its best fitness is at or below a target.

    Args:
        ds: a comparison; its `history` is the float32 fitness of the search.
        target: a fitness, by scenario; NaN where it is not known. It may have other dimensions.

    Returns:
        (scenario, algorithm, run), and those of the target: +inf of a run that never got there;
        NaN where there is no such run or no target. A run that got there when it was polished did
        with its last evaluation, and one of a long study at the next iteration of which there is
        history.
    """
    history, label = ds["history"], ds["iteration"]  # of a long study not every iteration is kept
    made = xr.where(history.notnull().any("run"), label, 0).max("iteration")
    reached = xr.where(history <= target, label, np.inf).min("iteration")
    above_it = (reached - 1).where(reached < np.inf, made)
    before, after = ds["evaluations_initial"], ds["evaluations_polish"]
    per_step = (ds["evaluations"] - before - after) / made.where(made > 0)
    polished = (after > 0) & (ds["fitness"] <= target)
    last = ds["evaluations"].where(polished, np.inf)
    spent = (before + (above_it + 1) * per_step).where(above_it < made, last)
    there = ds["fitness"].notnull() & np.isfinite(target)
    return spent.where(there).transpose("scenario", "algorithm", "run", ...).compute()


def expected_running_time(ds: xr.Dataset, target: xr.DataArray | float) -> xr.DataArray:
    """ERT to a target in fitness evaluations (scenario, algorithm).

    +inf where no run reaches it, NaN where there is no run or no target.
    """
    needed = evaluations_to(ds, target)
    there, reached = needed.notnull(), needed < np.inf
    total = needed.where(reached, ds["evaluations"]).where(there).sum("run")
    successes = reached.sum("run")
    return (total / successes.where(successes > 0)).fillna(np.inf).where(there.any("run"))


def clear_fitness(ds: xr.Dataset) -> xr.DataArray:
    """A fitness (scenario) at or below which nothing is hit or violated.

    Every collision and violation costs w₆κ and no term is negative, so what is below that price is
    clear. NaN where it is not known: a weight is negative, the price is 0, or the dataset does not
    hold the scenario.
    """
    texts = json.loads(ds.attrs.get("scenario_files", "{}"))
    names = ds["scenario"].values.tolist()
    prices = [_price(texts[name]) if name in texts else np.nan for name in names]
    return xr.DataArray(np.nextafter(np.array(prices), 0), dims="scenario")


def gap_table(ds: xr.Dataset) -> pd.DataFrame:
    """How near the algorithms come to the best known fitness, and how soon.

    Returns:
        One row per scenario and algorithm: columns scenario, algorithm, gap and gap_median (over
        the runs, %), how many (clear) of the runs are clear, and the expected running times in
        fitness evaluations to a clear trajectory (ert_clear) and to 10 % and 1 % above the best
        known (ert_10, ert_1). Columns of which nothing is known are left out.
    """
    known, gap = _known(ds), gaps(ds)
    middle = xr.apply_ufunc(_median, gap, input_core_dims=[["run"]], vectorize=True)
    columns = {
        "gap": mean_gap(ds),
        "gap_median": 100 * middle,
        "clear": clear_runs(ds).sum("run"),
        "runs": ds["fitness"].notnull().sum("run"),
        "ert_clear": expected_running_time(ds, clear_fitness(ds)),
        **{name: expected_running_time(ds, (1 + near) * known) for name, near in NEAR.items()},
    }
    frame = xr.Dataset(columns).to_dataframe(["scenario", "algorithm"]).reset_index()
    frame = frame.reindex(columns=["scenario", "algorithm", *columns])
    frame = frame.loc[frame["runs"] > 0].dropna(axis=1, how="all").reset_index(drop=True)
    frame.attrs["title"] = "By scenario: clear runs and distance from the best known fitness"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["columns"] = {
        "gap": Column("mean gap (%)", above),
        "gap_median": Column("median gap (%)", above),
        "ert_clear": Column("ERT clear", evaluations),
        "ert_10": Column("ERT +10%", evaluations),
        "ert_1": Column("ERT +1%", evaluations),
    }
    frame.attrs["caption"] = (
        f"{(GAP + ' ') * known.notnull().any().item()}ERT: expected running time in fitness "
        "evaluations to a first clear trajectory and to 10 % and 1 % above the best known, that "
        "is, evaluations of all runs until the iteration ends that gets there, or to their end, "
        "over the number of runs that get there; ∞: none does. Clear in an ERT: the best fitness "
        "so far is below w₆κ, the price of one collision or violation (no term is negative)."
    )
    return frame


def gap_summary(ds: xr.Dataset) -> pd.DataFrame:
    """The same over all scenarios, one row per algorithm.

    Returns:
        Columns algorithm, gap (mean over the scenarios whose best fitness is known of the mean over
        the runs, %), worst (the largest of these means, %), all_clear (scenarios of which every run
        is clear, of `scenarios`) and clear (runs, of `runs`).
    """
    mean, ran, clear = mean_gap(ds), ds["fitness"].notnull(), clear_runs(ds)
    there = ran.any("run")
    columns = {
        "gap": mean.mean("scenario"),
        "worst": mean.max("scenario"),
        "all_clear": (there & ~(ran & ~clear).any("run")).sum("scenario"),
        "scenarios": there.sum("scenario"),
        "clear": clear.sum(("scenario", "run")),
        "runs": ran.sum(("scenario", "run")),
    }
    frame = xr.Dataset(columns).to_dataframe().reset_index()
    frame = frame.reindex(columns=["algorithm", *columns]).dropna(axis=1, how="all")
    known, count = int(_known(ds).notnull().sum()), ds.sizes["scenario"]
    frame.attrs["title"] = "Over all scenarios: clear runs and distance from the best known fitness"
    frame.attrs["columns"] = {
        "gap": Column("mean gap (%)", above),
        "worst": Column("worst mean gap (%)", above),
        "all_clear": Column("all clear", out_of="scenarios"),
        "clear": Column("clear runs", out_of="runs"),
    }
    frame.attrs["caption"] = (
        f"{GAP} Mean and largest over the scenarios of the mean over the runs; a best fitness is "
        f"known of {known} of {count} scenarios. "
        if known
        else "No best fitness is known of these scenarios. "
    ) + "All clear: scenarios of which every run is without any collision or violation."
    return frame


GAP = "Gap: fitness over the best known, minus 1, in %; best known is not proved to be best."


def runs_made(ds: xr.Dataset) -> str:
    """How many runs the algorithms have on the scenarios: "5 runs", "3 to 5 runs"."""
    made = ds["fitness"].notnull().sum("run").values
    least, most = int(made[made > 0].min(initial=ds.sizes["run"])), int(made.max(initial=0))
    count = f"{most}" if least == most else f"{least} to {most}"
    return f"{count} run{'s' * (most != 1)}"


def clear_runs(ds: xr.Dataset) -> xr.DataArray:
    """Which runs end without any collision or violation (scenario, algorithm, run)."""
    return ds["fitness"].notnull() & (ds["collisions"] == 0) & (ds["violations"] == 0)


def better_than_known(ds: xr.Dataset) -> Iterator[str]:
    """A sentence for every scenario of which a clear run is better than the best known."""
    found = gaps(ds).where(clear_runs(ds))
    for scenario in ds["scenario"].values.tolist():
        gap = found.sel(scenario=scenario)
        if gap.min() < -_ROUNDING:
            place = gap.fillna(np.inf).argmin(["algorithm", "run"])
            best = ds["fitness"].sel(scenario=scenario).isel(place)
            algorithm, run, fitness = (
                each.item() for each in (best["algorithm"], best["run"], best)
            )
            known = ds["best_known"].sel(scenario=scenario).item()
            yield (
                f"{scenario}: run {run} of {algorithm} is clear and better than the best known, "
                f"{fitness:.6f} < {known:.6f}"
            )


def _known(ds: xr.Dataset) -> xr.DataArray:
    return ds["best_known"].where(ds["best_known"] > 0)


def _median(values: np.ndarray) -> float:
    return median(values[~np.isnan(values)])


def _price(text: str) -> float:
    """w₆κ of a scenario file; NaN where what is below it need not be clear."""
    fitness = tomllib.loads(text).get("fitness", {})
    weights, kappa = fitness.get("weights", [np.nan]), fitness.get("kappa", np.nan)
    price = weights[-1] * kappa
    return price if min(weights) >= 0 and price > 0 else np.nan
