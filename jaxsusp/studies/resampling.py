"""How sure something is: what it would be with other runs, and on other scenes."""

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
    """Bootstrap interval of the mean over scenes and runs (percentile method).

    Run i begins with the same key in every scene, so scenes and runs are drawn anew independently
    of each other, whole rows and whole columns; that errs on the side of wide intervals (Owen,
    "The pigeonhole bootstrap", Ann. Appl. Stat. 1, 2007).

    Args:
        values: paired differences, or anything else by scene and run.
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
    means = np.einsum("bs,...sr,br->b...", by_scene, values, by_run, optimize=True)
    return np.quantile(means, [(1 - level) / 2, (1 + level) / 2], axis=0)


def resampled_ranks(
    ds: xr.Dataset, resamples: int = 2000, seed: int = 0
) -> Float[np.ndarray, "resamples algorithms"]:
    """Mean ranks by median fitness over the scenarios, of runs drawn anew.

    Runs are drawn with replacement for every scenario and algorithm by itself; the scenarios stay
    what they are. Every algorithm has all of the runs.

    Args:
        ds: a comparison.
        resamples: number of bootstrap samples.
        seed: of the resampling.
    """
    fitness = ds["fitness"].transpose("scenario", "algorithm", "run").values
    random = np.random.default_rng(seed)
    picks = random.integers(fitness.shape[2], size=(resamples, *fitness.shape))
    drawn = np.take_along_axis(fitness[None], picks, axis=3)
    return rankdata(np.median(drawn, axis=3), axis=2).mean(axis=1)
