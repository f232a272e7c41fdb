"""Claims about Figs. 11 and 12: how soon the algorithms are where they end."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from experiments.claims.claim import Claim, Evidence
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.gaps import gaps
from jaxsusp.report.render import above

SCENARIO = "scenario-1"
"""That of Figs. 11 and 12."""

EARLY = 150
"""Iterations after which SDBO is said to have its shortest way."""

THERE = 0.01
"""Distance from the final average fitness, relative, up to which it is reached."""


def claims(evidence: Evidence) -> Iterator[Claim]:
    """All of them, in the paper's order."""
    runs = evidence.runs.sel(scenario=SCENARIO)
    yield _about_150(runs)
    yield _rapid(runs)
    yield _superior(runs)
    yield _best_of_runs(runs)


def settled(runs: xr.Dataset) -> dict[str, int]:
    """The iteration from which on the average fitness stays within 1 % of its last value."""
    mean = runs["history"].mean("run")
    last = mean.isel(iteration=-1)
    away = mean > (1 + THERE) * last
    return {str(name): int(away.sel(algorithm=name).sum()) + 1 for name in runs["algorithm"].values}


def told(values: dict[str, int]) -> str:
    """As text: PSO 301, GA 498."""
    return ", ".join(f"{name.upper()} {value}" for name, value in values.items())


def _about_150(runs: xr.Dataset) -> Claim:
    when = settled(runs)
    return Claim(
        "Sect. 4.3, Fig. 11",
        f"SDBO has its shortest trajectory after about {EARLY} iterations.",
        "The figure is not printed as numbers.",
        None,
        "The average fitness is within 1 % of its last value from iteration "
        f"{told(when)} on, of {runs.sizes['iteration']}.",
        when["sdbo"] <= 1.2 * EARLY,
    )


def _rapid(runs: xr.Dataset) -> Claim:
    at = runs["history"].mean("run").sel(iteration=EARLY)
    left = (at / runs["history"].mean("run").isel(iteration=-1) - 1).to_series()
    share = ", ".join(f"{name.upper()} {above(100 * value)} %" for name, value in left.items())
    return Claim(
        "Sect. 4.3, Fig. 11",
        "SDBO, PSO and GA converge rapidly in the early stages, DBO slowly.",
        "The figure is not printed as numbers.",
        None,
        f"After {EARLY} iterations the average fitness is above its last value by {share}.",
        bool(left.drop("dbo").max() < left["dbo"]),
    )


def _superior(runs: xr.Dataset) -> Claim:
    spread = runs["history"].isel(iteration=-1).std("run", ddof=1).to_series()
    last = runs["history"].isel(iteration=-1).mean("run").to_series().sort_values()
    means = ", ".join(f"{name.upper()} {value:.1f}" for name, value in last.items())
    return Claim(
        "Sect. 4.3, Fig. 11",
        "SDBO is superior in convergence speed and stability, closely followed by GA.",
        "Table 1 agrees for scenario 1: its average and standard deviation are the least.",
        _least(SCENARIO),
        f"Average fitness at the end: {means}; least scatter: {str(spread.idxmin()).upper()}.",
        bool(last.index[0] == "sdbo" and last.index[1] == "ga" and spread.idxmin() == "sdbo"),
    )


def _least(scenario: str) -> bool:
    table = paper.table1().sel(scenario=scenario)
    return all(
        table[metric].idxmin("algorithm").item() == "sdbo" for metric in ("average", "std")
    )  # fmt: skip


def _best_of_runs(runs: xr.Dataset) -> Claim:
    best = (100 * gaps(runs).min("run")).to_series()
    order = ", ".join(f"{name.upper()} {above(value)} %" for name, value in best.items())
    found = [name for name, value in best.items() if value <= 10]
    return Claim(
        "Sect. 4.3, Fig. 12",
        "SDBO achieves the best results, while DBO and PSO cannot find the optimal value.",
        "Table 1 agrees for scenario 1; Sect. 4.2.1 says that all four obtain the optimal value.",
        bool(np.isclose(_minimum("sdbo"), min(map(_minimum, ("pso", "ga", "dbo", "sdbo"))))),
        f"The best run is above the best known value by {order}.",
        bool(best.idxmin() == "sdbo" and not {"dbo", "pso"} & set(found)),
    )


def _minimum(algorithm: str) -> float:
    return float(paper.table1()["min"].sel(scenario=SCENARIO, algorithm=algorithm))
