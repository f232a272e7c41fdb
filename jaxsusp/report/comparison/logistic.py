"""Shares of runs that succeed, as logistic curves of what makes tasks hard.

Runs on one task are no independent tries at tasks of its kind: intervals come from drawing whole
tasks anew (the cluster bootstrap), never single runs.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.special import expit
from scipy.stats import binomtest

RIDGE = 1e-2
"""Of the slopes of standardised columns: keeps them finite where a column parts all failures from
all successes."""

_STEPS = 50


class Curve(NamedTuple):
    """log odds = intercept + slopes · columns."""

    intercept: float
    slopes: Float[np.ndarray, "columns"]

    def share(self, columns: Float[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows"]:
        """The share of successes that is expected."""
        return expit(self.intercept + columns @ self.slopes)


def fitted(
    columns: Float[np.ndarray, "tasks columns"],
    successes: Float[np.ndarray, "tasks"],
    runs: Float[np.ndarray, "tasks"],
) -> Curve:
    """The likeliest curve, by Newton's method on standardised columns with a slight ridge.

    Args:
        columns: a row per task; a column that is the same everywhere gets the slope 0.
        successes: runs that succeed.
        runs: runs that there are.
    """
    middle, spread = columns.mean(axis=0), columns.std(axis=0)
    flat = spread < 1e-12
    standard = np.where(flat, 0, (columns - middle) / np.where(flat, 1, spread))
    design = np.column_stack([np.ones(len(columns)), standard])
    ridge = RIDGE * np.eye(design.shape[1])
    ridge[0, 0] *= 0.1
    beta = np.zeros(design.shape[1])
    for _ in range(_STEPS):
        share = expit(design @ beta)
        gradient = design.T @ (successes - runs * share) - ridge @ beta
        curvature = (design * (runs * share * (1 - share))[:, None]).T @ design + ridge
        step = np.linalg.solve(curvature, gradient)
        step *= min(1.0, 2.0 / max(np.abs(step).max(), 1e-12))
        beta += step
        if np.abs(step).max() < 1e-10:
            break
    slopes = np.where(flat, 0, beta[1:] / np.where(flat, 1, spread))
    return Curve(float(beta[0] - slopes @ middle), slopes)


def resampled(
    columns: Float[np.ndarray, "tasks columns"],
    successes: Float[np.ndarray, "tasks"],
    runs: Float[np.ndarray, "tasks"],
    resamples: int = 1000,
    seed: int = 0,
) -> list[Curve]:
    """Curves of tasks drawn anew with replacement, for percentile intervals."""
    picks = np.random.default_rng(seed).integers(len(columns), size=(resamples, len(columns)))
    return [fitted(columns[pick], successes[pick], runs[pick]) for pick in picks]


def share_interval(successes: int, runs: int, level: float = 0.95) -> tuple[float, float]:
    """Wilson's interval of a share; (0, 1) of no runs."""
    if runs == 0:
        return 0.0, 1.0
    found = binomtest(successes, runs).proportion_ci(level, method="wilson")
    return float(found.low), float(found.high)
