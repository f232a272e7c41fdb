"""How sure something is: what it would be with other runs, and on other scenes."""

import warnings

import numpy as np
import xarray as xr
from scipy.stats import rankdata

from jaxsusp._types import Float


def crossed_interval(
    values: Float[np.ndarray, "*quantities scenes runs"],
    scenes_vary: bool,
    level: float = 0.95,
    resamples: int = 4000,
    seed: int = 0,
) -> Float[np.ndarray, "bounds=2 *quantities"]:
    """Bootstrap interval of `mean_of` over scenes and runs (percentile method).

    Run i begins with the same key in every scene, so scenes and runs are drawn anew independently
    of each other, whole rows and whole columns; that errs on the side of wide intervals (Owen,
    "The pigeonhole bootstrap", Ann. Appl. Stat. 1, 2007).

    Args:
        values: paired differences, or anything else by scene and run; NaN where there is none.
        scenes_vary: whether the scenes are a sample of others; else the interval is for these very
            scenes and other runs.
        level: coverage, in (0, 1).
        resamples: number of bootstrap samples.
        seed: of the resampling.
    """
    random, (scenes, runs) = np.random.default_rng(seed), values.shape[-2:]
    by_run = random.multinomial(runs, np.full(runs, 1 / runs), resamples) / runs
    by_scene = np.full((resamples, scenes), 1 / scenes)
    if scenes_vary:
        by_scene = random.multinomial(scenes, by_scene[0], resamples) / scenes

    def drawn(cells: np.ndarray) -> np.ndarray:
        return np.einsum("bs,...sr,br->b...", by_scene, cells, by_run, optimize=True)

    there = np.isfinite(values)
    if there.all():
        means = drawn(values)
    else:
        shares = drawn(there.astype(np.float64))
        sums = drawn(np.where(there, values, 0))
        means = np.divide(sums, shares, where=shares > 0, out=np.full_like(sums, np.nan))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # where nothing is finite: NaN
        return np.nanquantile(means, [(1 - level) / 2, (1 + level) / 2], axis=0)


def mean_of(values: Float[np.ndarray, "..."]) -> float:
    """The mean of those that are finite; NaN where none is."""
    there = values[np.isfinite(values)]
    return float(there.mean()) if there.size else np.nan


def logarithm(fitness: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """Natural logarithm of a fitness; NaN of a run that found nothing (infinite or NaN)."""
    return np.log(np.where(np.isfinite(fitness), fitness, np.nan))


def last(fitness: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """The fitness for ranks: a run that found nothing is behind all others."""
    return np.where(np.isfinite(fitness), fitness, np.inf)


def resampled_ranks(
    ds: xr.Dataset, resamples: int = 2000, seed: int = 0
) -> Float[np.ndarray, "resamples algorithms"]:
    """Mean ranks by median fitness over the scenarios, of runs drawn anew.

    Run i of an algorithm begins with the same key in every scenario: runs are drawn with
    replacement by their numbers, the same for all scenarios, for every algorithm by itself. The
    scenarios stay what they are.

    Args:
        ds: a comparison in which every algorithm has all of the runs; one that found nothing
            counts as worse than all others.
        resamples: number of bootstrap samples.
        seed: of the resampling.
    """
    fitness = last(ds["fitness"].transpose("scenario", "algorithm", "run").values)
    random = np.random.default_rng(seed)
    scenarios, algorithms, runs = fitness.shape
    picks = random.integers(runs, size=(resamples, 1, algorithms, runs))
    picks = np.broadcast_to(picks, (resamples, scenarios, algorithms, runs))
    drawn = np.take_along_axis(fitness[None], picks, axis=3)
    return rankdata(np.median(drawn, axis=3), axis=2).mean(axis=1)
