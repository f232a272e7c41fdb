"""Results in two small tables: running times to a few targets, and distributions of all of them."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from jaxsusp.studies.bbob.results import LAST, TARGETS, Result
from jaxsusp.studies.bbob.suite import GROUPS

CHOSEN = (1e1, 1e-1, 1e-3, 1e-8)
"""Targets of the table of running times."""

STEPS = np.round(np.linspace(-1, 4, 51), 1)
"""log₁₀ of evaluations over D at which distributions are tabulated."""

ALL = "all 24 functions"
"""The name of the group of all functions, first of all."""

PARTS = {ALL: range(1, 25), **GROUPS}
"""Functions by the groups that have a distribution."""

SOLVED = "all 24 functions, 1e-8"
"""The name of the distribution of all functions with the last target alone."""


def running_times(results: Sequence[Result]) -> pd.DataFrame:
    """A row per algorithm, dimension, function and target of `CHOSEN`.

    `evaluations` are those of all runs until they reach the target or end, so that the expected
    running time of restarts until one run reaches it is `evaluations / reached`.
    """
    places = [int(np.abs(np.log(TARGETS / target)).argmin()) for target in CHOSEN]
    rows = []
    for each in results:
        for target, place in zip(CHOSEN, places, strict=True):
            spent = each.reached[:, place]
            there = np.isfinite(spent)
            rows.append({
                "algorithm": each.algorithm,
                "dimension": each.course.dim,
                "function": each.function,
                "target": target,
                "runs": len(spent),
                "reached": int(there.sum()),
                "evaluations": int(np.where(there, spent, each.evaluations).sum()),
            })  # fmt: skip
    return pd.DataFrame(rows)


def distributions(results: Sequence[Result]) -> pd.DataFrame:
    """Shares of (function, run, target) reached within 10^step D evaluations, a column per step.

    A row per algorithm, dimension and group of functions, where all functions of the group were
    run. All 51 `TARGETS` count alike; a last row, `SOLVED`, counts the last of them alone.
    """
    rows = []
    for algorithm, dim in dict.fromkeys((each.algorithm, each.course.dim) for each in results):
        here = {
            each.function: each
            for each in results
            if (each.algorithm, each.course.dim) == (algorithm, dim)
        }
        for group, functions in PARTS.items():
            if not here.keys() >= set(functions):
                continue
            spent = np.stack([here[function].reached for function in functions]) / dim
            parts = {group: spent} | ({SOLVED: spent[..., LAST]} if group == ALL else {})
            for name, each in parts.items():
                shares = zip(STEPS, distribution(each), strict=True)
                steps = {f"{step:g}": round(float(share), 4) for step, share in shares}
                rows.append({"algorithm": algorithm, "dimension": dim, "group": name, **steps})
    return pd.DataFrame(rows)


def distribution(spent: np.ndarray) -> np.ndarray:
    """Shares of running times, NaN where there is none, that are at most 10^step."""
    return np.array([(spent <= 10**step * (1 + 1e-12)).mean() for step in STEPS])
