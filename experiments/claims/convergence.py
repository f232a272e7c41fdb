"""Claims about Figs. 11 and 12: how soon the algorithms are where they end."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from experiments.claims.claim import Claim, Evidence, told
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
    away = ~(mean <= (1 + THERE) * last) | ~np.isfinite(last)  # what ends nowhere never settles
    return {str(name): int(away.sel(algorithm=name).sum()) + 1 for name in runs["algorithm"].values}


def _about_150(runs: xr.Dataset) -> Claim:
    when = settled(runs)
    return Claim(
        "Sect. 4.3, Fig. 11",
        f"SDBO has its shortest trajectory after about {EARLY} iterations.",
        "The figure is not printed as numbers.",
        None,
        "The average fitness is within 1 % of its last value from iteration "
        f"{told(when, 0)} on, of {runs.sizes['iteration']}.",
        when["sdbo"] <= 1.2 * EARLY,
    )


def _rapid(runs: xr.Dataset) -> Claim:
    mean = runs["history"].mean("run")
    early = {
        at: {str(name): float(mean.sel(iteration=at, algorithm=name)) for name in SLOWEST_LAST}
        for at in STAGES
    }
    said = "; ".join(f"after {at} iterations {told(each, 0)}" for at, each in early.items())
    return Claim(
        "Sect. 4.3, Fig. 11",
        "SDBO, PSO and GA converge rapidly in the early stages, DBO slowly.",
        "The figure is not printed as numbers.",
        None,
        f"Average fitness in scenario 1 {said}.",
        all(max(each[name] for name in SLOWEST_LAST[:-1]) < each["dbo"] for each in early.values()),
    )


STAGES = (25, 50)
"""Iterations that are early."""

SLOWEST_LAST = ("sdbo", "pso", "ga", "dbo")


def _superior(runs: xr.Dataset) -> Claim:
    spread = runs["history"].isel(iteration=-1).std("run", ddof=1).to_series()
    last = runs["history"].isel(iteration=-1).mean("run").to_series().sort_values()
    means = ", ".join(f"{name.upper()} {value:.1f}" for name, value in last.items())
    table = paper.table1().sel(scenario=SCENARIO)
    order = {
        metric: [str(name) for name in table["algorithm"].values[np.argsort(table[metric].values)]]
        for metric in ("average", "std")
    }
    return Claim(
        "Sect. 4.3, Fig. 11",
        "SDBO is superior in convergence speed and stability, closely followed by GA.",
        "Table 1, scenario 1, the least first: average "
        f"{', '.join(name.upper() for name in order['average'])}; standard deviation "
        f"{', '.join(name.upper() for name in order['std'])}. Speed is not in the table.",
        all(names[:2] == ["sdbo", "ga"] for names in order.values()),
        f"Average fitness at the end: {means}; least scatter: {str(spread.idxmin()).upper()}.",
        bool(last.index[0] == "sdbo" and last.index[1] == "ga" and spread.idxmin() == "sdbo"),
    )


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
