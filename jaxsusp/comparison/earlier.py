"""Comparisons saved by earlier versions: what they do not hold, as far as it can be told."""

import json

import numpy as np
import xarray as xr

from jaxsusp.comparison.bestknown import value_of


def brought_up_to_date(ds: xr.Dataset) -> xr.Dataset:
    """Add the variables of `ADDED` that were not there yet; anything else stays as it is."""
    return ds.assign({name: found(ds) for name, found in ADDED.items() if name not in ds})


def _best_known(ds: xr.Dataset) -> xr.DataArray:
    """What is known today of scenarios of the same content, NaN where nothing is."""
    settings = json.loads(ds.attrs["settings"])
    digests = settings.get("scenarios", {})
    size = settings.get("waypoints"), settings.get("samples")
    known = [value_of(digests.get(name), *size) for name in ds["scenario"].values.tolist()]
    return xr.DataArray(np.array(known, np.float64), dims="scenario")


def _evaluations_initial(ds: xr.Dataset) -> xr.DataArray:
    """What is left when every iteration evaluates equally much.

    It is exact where an initial population has fewer candidates than a run has iterations; of
    shorter runs it is too small, and every iteration takes its share of the difference.
    """
    ran = ds["history"].notnull().any("run").sum("iteration")
    return (ds["evaluations"] % ran.clip(min=1)).astype(np.int64)


ADDED = {"best_known": _best_known, "evaluations_initial": _evaluations_initial}
"""Variables that came later, and what stands for them."""
