"""One claim with the evidence for and against it, and what follows."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.statistics import mann_whitney, vargha_delaney
from jaxsusp.report.comparison.tables import summary
from jaxsusp.report.render import probability, two_decimals

RUNS = "python -m experiments make published.comparison"
CHECKS = "python -m experiments make studies.cable_check"
ABLATION = "python -m experiments make studies.ablation"
PRINT = "python -m experiments draw claims.ledger"
"""Where the printed tables are enough."""


class Claim(NamedTuple):
    """A claim; `None` is a source that says nothing about it."""

    where: str  # in the paper
    claimed: str
    printed_says: str
    printed: bool | None  # whether the paper's own tables bear it out
    ours_say: str
    ours: bool | None  # whether our runs do
    command: str = RUNS  # that makes what it is held against

    @property
    def verdict(self) -> str:
        """What follows from both sources."""
        return _VERDICTS[self.printed, self.ours]


_VERDICTS = {
    (True, True): "holds",
    (True, False): "holds in print only",
    (True, None): "holds in print",
    (False, True): "contradicted by the print, holds in our runs",
    (False, False): "does not hold",
    (False, None): "contradicted by the print",
    (None, True): "holds in our runs",
    (None, False): "does not hold in our runs",
    (None, None): "cannot be checked",
}

VERDICTS = tuple(dict.fromkeys(_VERDICTS.values()))


class Evidence(NamedTuple):
    """What claims are held against."""

    table1: xr.Dataset  # printed
    ends: pd.DataFrame  # printed, Tables 2 and 3
    runs: xr.Dataset  # our comparison of the published algorithms
    ours: xr.Dataset  # its metrics by scenario and algorithm, as in Table 1
    checks: xr.Dataset  # runs with the paper's check of cables, and with the sound one
    ablation: xr.Dataset  # SDBO with each of its improvements left out, on random scenes

    @classmethod
    def of(cls, artefacts: Artefacts) -> "Evidence":
        """The evidence that is kept; of the comparison, the four published algorithms."""
        runs = artefacts.comparison("comparison", scenario=js.scenarios(), algorithm=[*PUBLISHED])
        runs = runs.sel(algorithm=[*PUBLISHED])
        ours = summary(runs)
        # One time is measured for all scenarios; every one of them has its share.
        ours["runtime"] = ours["runtime"].broadcast_like(ours["min"])
        checks = artefacts.dataset("cable-check").sel(algorithm=[*PUBLISHED])
        ablation = artefacts.dataset("ablation_random")
        return cls(paper.table1(), paper.tables_2_3(), runs, ours, checks, ablation)


def leads(table: xr.Dataset, algorithm: str = "sdbo") -> xr.Dataset:
    """Where an algorithm is better than every other, per metric (scenario); no tie, no NaN, no inf.

    Smaller is better, except for the curvature radius.
    """

    def ahead(values: xr.DataArray) -> xr.DataArray:
        cost = -values if values.name == "curvature_radius" else values
        own = cost.sel(algorithm=algorithm, drop=True)
        others = cost.drop_sel(algorithm=algorithm).min("algorithm", skipna=True)
        return np.isfinite(own) & (own < others)

    return table[list(paper.UNITS)].map(ahead)


def numbers(names: Iterable[str]) -> str:
    """Their numbers: "1, 3" of scenario-1 and scenario-3."""
    return ", ".join(str(name).rpartition("-")[2] for name in names)


def within(names: Sequence[str]) -> str:
    """Where something holds: "in scenarios 1, 3", "in scenario 2", "in no scenario"."""
    if not names:
        return "in no scenario"
    return f"in scenario{'s' * (len(names) > 1)} {numbers(names)}"


def told(numbers: Mapping[str, float], decimals: int = 1) -> str:
    """Numbers by algorithm: "PSO 1.5, GA 2.0"."""
    return ", ".join(f"{name.upper()} {value:.{decimals}f}" for name, value in numbers.items())


def compared(one: np.ndarray, other: np.ndarray) -> tuple[str, bool]:
    """How runs of one algorithm compare with those of another: in words, and whether p < 0.05."""
    p = mann_whitney(one, other)
    said = probability(p)
    size = two_decimals(vargha_delaney(one, other))
    return f"A₁₂ = {size}, p {said if '<' in said else '= ' + said}", p < 0.05


def change(ratio: float, decimals: int = 1) -> str:
    """A ratio as a change in %, with its sign."""
    return f"{100 * (ratio - 1):+.{decimals}f} %".replace("-", "−")


def holding(flags: xr.DataArray) -> list[str]:
    """The scenarios in which something holds."""
    return flags["scenario"].values[flags.values].tolist()
