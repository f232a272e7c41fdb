"""Comparisons saved by earlier versions: what they do not hold, as far as it can be told."""

import json

import numpy as np
import xarray as xr

from jaxsusp.comparison.bestknown import value_of


def brought_up_to_date(ds: xr.Dataset) -> xr.Dataset:
    """Add what `ADDED` and `SETTINGS` hold and was not there; anything else stays as it is."""
    settings = json.loads(ds.attrs["settings"])
    if SETTINGS.keys() - settings.keys():
        ds = ds.assign_attrs(settings=json.dumps({**SETTINGS, **settings}))
    if "step" not in ds.coords:
        ds = ds.assign_coords(step=ds["iteration"].values)
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


def _evaluations_polish(ds: xr.Dataset) -> xr.DataArray:
    return xr.zeros_like(ds["evaluations"])


def _history_best(ds: xr.Dataset) -> xr.DataArray:
    """Of the run with the lowest fitness, the first of equals."""
    best = ds["fitness"].fillna(np.inf).argmin("run")
    return ds["history"].isel(run=best).rename(iteration="step").drop_vars("run")


def _unit(ds: xr.Dataset) -> xr.DataArray:
    """That of the world: the fitness was formed in SI units."""
    return xr.ones_like(ds["obstacles"], np.float64)


ADDED = {
    "history_best": _history_best,
    "unit_length": _unit,
    "unit_mass": _unit,
    "best_known": _best_known,
    "evaluations_initial": _evaluations_initial,
    "evaluations_polish": _evaluations_polish,
}
"""Variables that came later, and what stands for them."""

SETTINGS = {"polish": False}
"""Settings that came later, and what was always done before."""
