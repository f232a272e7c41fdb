"""The paper's Table 1 as printed: its SDBO/DBO ratios, and what does not add up in it.

Absolute values are not comparable with ours, because the paper prints no obstacle coordinates;
ratios and rankings are.
"""

from collections.abc import Iterator
from importlib import resources
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.scenario.builtin import scenarios

RUNS = 20
"""Independent runs behind every row of Table 1."""

KAPPA = 1000.0
"""Penalty of one collision (Eq. 21, f6)."""

UNITS = {
    "min": "1",
    "max": "1",
    "average": "1",
    "std": "1",
    "length": "m",
    "height": "m",
    "curvature_radius": "m",
    "runtime": "s",
}
"""The metrics of Table 1 and their units."""

RATIOS = ("min", "max", "average", "std", "length", "height", "runtime")
"""The metrics whose SDBO/DBO ratio is compared; all of them are better when smaller."""


class Remark(NamedTuple):
    """Something a reader of the printed ratios must know."""

    text: str
    cells: tuple[tuple[str, str], ...] = ()
    """The (scenario, metric) pairs it bears on; empty when it bears on the table as a whole."""


def table1() -> xr.Dataset:
    """Table 1 by metric, with dims scenario ("scenario-1" …) and algorithm ("pso" …).

    Besides the metrics of `UNITS` it holds `obstacles` (scenario).
    """
    source = resources.files("jaxsusp.report.comparison") / "data" / "table1.csv"
    with source.open(encoding="utf-8") as file:
        rows = pd.read_csv(file)
    rows["scenario"] = "scenario-" + rows["scenario"].astype(str)
    rows["algorithm"] = rows["algorithm"].str.lower()
    rows = rows.rename(columns=lambda name: name.removesuffix("_m").removesuffix("_s"))
    rows = rows.set_index(["scenario", "algorithm"])
    in_order = {level: rows.index.unique(level) for level in rows.index.names}
    table = rows[list(UNITS)].to_xarray().reindex(in_order)
    for metric, unit in UNITS.items():
        table[metric].attrs["units"] = unit
    return table.assign(
        obstacles=("scenario", rows["obstacles"].groupby(level=0, sort=False).first())
    )


def tables_2_3() -> pd.DataFrame:
    """Tables 2 and 3 as printed, a row per algorithm and robot.

    Returns:
        Columns algorithm, robot (from 1), x, y, z of the end and greatest length of the cable (m).
    """
    source = resources.files("jaxsusp.report.comparison") / "data" / "tables2_3.csv"
    with source.open(encoding="utf-8") as file:
        rows = pd.read_csv(file)
    rows["algorithm"] = rows["algorithm"].str.lower()
    names = {f"end_{axis}_m": axis for axis in "xyz"} | {"max_cable_length_m": "length"}
    return rows.rename(columns=names)


def of_the_paper(ds: xr.Dataset) -> xr.Dataset:
    """The part of a comparison that the paper has, too: its algorithms, in its order."""
    there = ds["algorithm"].values.tolist()
    return ds.sel(algorithm=[name for name in PUBLISHED if name in there])


def lacking(ds: xr.Dataset) -> str:
    """A sentence on what of the paper's algorithms and scenarios a comparison has no run, or ""."""
    ran = ds["fitness"].notnull().any("run")
    empty = [
        name
        for name in (*PUBLISHED, *scenarios())
        if name not in ran["algorithm" if name in PUBLISHED else "scenario"]
        or not ran.sel({"algorithm" if name in PUBLISHED else "scenario": name}).any()
    ]
    return f"This comparison has no run of {', '.join(empty)}: left out here." if empty else ""


def ratios(table: xr.Dataset, of: str = "sdbo", to: str = "dbo") -> xr.Dataset:
    """Metrics of one algorithm over those of another, per scenario: 0.25 is "75 % less"."""
    metrics = table[list(RATIOS)]
    return metrics.sel(algorithm=of, drop=True) / metrics.sel(algorithm=to, drop=True)


def largest_std(low, high, mean, runs: int = RUNS):
    """Upper bound of the sample standard deviation (n - 1) of values with these extremes and mean.

    From Σ (v - low)(high - v) ≥ 0 follows variance ≤ (high - mean)(mean - low) (Bhatia and Davis,
    Am. Math. Mon. 107, 2000), times n / (n - 1) for a sample. Equality needs every value at an
    extreme.

    Args:
        low: smallest value; like `high` and `mean` a number, an array or a DataArray.
        high: largest value.
        mean: their mean, between the two.
        runs: number of values n, at least 2.

    Returns:
        The bound, in the unit of the values.
    """
    return ((high - mean) * (mean - low) * runs / (runs - 1)) ** 0.5


def impossible_std(table: xr.Dataset, runs: int = RUNS) -> xr.DataArray:
    """Where a printed standard deviation exceeds what its own row allows (scenario, algorithm)."""
    bound = largest_std(table["min"], table["max"], table["average"], runs)
    return table["std"] > bound


def colliding_best(table: xr.Dataset, kappa: float = KAPPA) -> xr.DataArray:
    """Where even the best run pays for a collision: its fitness exceeds one penalty κ."""
    return table["min"] > kappa


def beaten(table: xr.Dataset, algorithm: str = "sdbo") -> xr.Dataset:
    """Where at least one other algorithm is better, per metric (scenario).

    Smaller is better, except for the curvature radius: the paper reads it as smoothness.
    """
    signs = {metric: -1 if metric == "curvature_radius" else 1 for metric in UNITS}
    costs = table[list(UNITS)].map(lambda values: values * signs[values.name])
    return (costs < costs.sel(algorithm=algorithm)).any("algorithm")


def remarks(table: xr.Dataset, to: str = "dbo") -> tuple[Remark, ...]:
    """What is to be known about the ratios SDBO/`to` of `table1`, each found by a check above."""
    checks = (_impossible, _collides, _not_superior, _fastest)
    return tuple(remark for check in checks for remark in check(table, to))


def _impossible(table: xr.Dataset, to: str) -> Iterator[Remark]:
    bound = largest_std(table["min"], table["max"], table["average"])
    for scenario, algorithm in where(impossible_std(table.sel(algorithm=["sdbo", to]))):
        printed, most = (v.loc[scenario, algorithm].item() for v in (table["std"], bound))
        yield Remark(
            f"No {RUNS} values with the printed minimum, maximum and mean have the printed "
            f"{algorithm.upper()} std {printed:.1f}: it can be at most {most:.1f}.",
            ((scenario, "std"),),
        )


def _collides(table: xr.Dataset, to: str) -> Iterator[Remark]:
    flags = colliding_best(table).sel(algorithm=to)
    cells = tuple((s, metric) for (s,) in where(flags) for metric in ("min", "average"))
    if cells:
        yield Remark(
            f"{to.upper()}'s minimum exceeds κ = {KAPPA:.0f}: its best run collides, although the "
            "text says that all algorithms find a safe trajectory. The ratio is mostly penalty.",
            cells,
        )


def _not_superior(table: xr.Dataset, to: str) -> Iterator[Remark]:
    lost = {str(metric): [s for (s,) in where(flags)] for metric, flags in beaten(table).items()}
    places = [
        f"{metric.replace('_', ' ')} ({', '.join(name.rpartition('-')[2] for name in scenarios)})"
        for metric, scenarios in lost.items()
        if scenarios
    ]
    if places:
        yield Remark(
            "“Superior performance in all metrics” does not hold: another algorithm is better "
            f"than SDBO in {'; '.join(places)} (scenarios in brackets).",
            tuple((s, metric) for metric in RATIOS for s in lost[metric]),
        )


def _fastest(table: xr.Dataset, to: str) -> Iterator[Remark]:
    if not beaten(table)["runtime"].any():
        yield Remark(
            "SDBO has the least run time in every scenario although it evaluates the fitness "
            "about three times as often per iteration; the paper reports no evaluations, and does "
            "not say whether a run time is one run's or all twenty's."
        )


def where(flags: xr.DataArray) -> Iterator[tuple[str, ...]]:
    """Coordinates of the true entries, in order."""
    for index in np.argwhere(flags.values):
        yield tuple(flags[name][i].item() for name, i in zip(flags.dims, index, strict=True))
