"""The labelled dataset of a comparison: assemble, save, load, append.

One layout serves a whole comparison and the units it is computed in (one algorithm, some runs, the
scenarios of one static shape), so that resuming, appending runs and merging use the same code.
Missing cells are NaN (0 in integer variables) and marked by a NaN fitness.
"""

import datetime
import json
import os
import platform
from collections.abc import Iterable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np
import xarray as xr

from jaxsusp._files import atomic_path
from jaxsusp.errors import InputError

TERMS = ("length", "height", "cable", "tension_rate", "curvature", "penalty")
PACKAGES = ("jaxsusp", "jax", "jaxlib", "numpy", "scipy", "xarray", "h5netcdf")


class Variable(NamedTuple):
    """Dimensions, type and meaning of one variable of the dataset."""

    dims: tuple[str, ...]
    dtype: type
    meaning: str
    units: str = "1"


_CELL = ("scenario", "algorithm")
_RUN = (*_CELL, "run")

VARIABLES: dict[str, Variable] = {
    "fitness": Variable(_RUN, np.float64, "best fitness, re-evaluated in float64 (Eq. 21)"),
    "terms": Variable((*_RUN, "term"), np.float64, "terms f1 … f6 of the best candidate"),
    "collisions": Variable(_RUN, np.int64, "contacts n_p of the best candidate"),
    "violations": Variable(_RUN, np.int64, "violated limits n_g of the best candidate"),
    "x": Variable((*_RUN, "variable"), np.float64, "best decision vector (waypoints)", "m"),
    "history": Variable((*_RUN, "iteration"), np.float32, "best fitness so far"),
    "position": Variable(
        (*_CELL, "sample", "axis"), np.float64, "trajectory of the best run's load", "m"
    ),
    "curvature_radius": Variable(
        _CELL, np.float64, "median of 1/curvature over the best run's interior samples", "m"
    ),
    "evaluations": Variable(_CELL, np.int64, "fitness evaluations per run"),
    "stability_acted": Variable(_RUN, np.float64, "share of beetles that Eq. 19 acted on"),
    "stability_kept": Variable(_RUN, np.float64, "share of beetles that Eq. 19 improved"),
    "obstacles": Variable(("scenario",), np.int64, "number of obstacles"),
    "iterations": Variable(("algorithm",), np.int64, "iterations per run"),
    "seconds_run": Variable(("algorithm",), np.float64, "computation of all runs", "s"),
    "seconds_compile": Variable(("algorithm",), np.float64, "compilation, once", "s"),
}

SUMMED = ("seconds_run", "seconds_compile")
"""Variables that add up when a comparison is put together from units."""


def dataset(coords: dict[str, Sequence], values: dict[str, np.ndarray]) -> xr.Dataset:
    """A dataset of the one layout.

    Args:
        coords: labels of scenario, algorithm, run, iteration, variable, sample.
        values: arrays by the names of `VARIABLES`, shaped accordingly.
    """
    labels = {**coords, "term": list(TERMS), "axis": ["x", "y", "z"]}
    return xr.Dataset(
        {
            name: xr.Variable(
                variable.dims,
                np.asarray(values[name], variable.dtype),
                {"long_name": variable.meaning, "units": variable.units},
            )
            for name, variable in VARIABLES.items()
        },
        {name: (name, np.asarray(label)) for name, label in labels.items()},
    )


def merge(units: Sequence[xr.Dataset]) -> xr.Dataset:
    """Put units together; labels keep the order in which they first appear, runs are sorted.

    Raises:
        InputError: two units hold the same scenario, algorithm and run.
    """
    coords = {
        dim: _union(unit[dim].values for unit in units)
        for dim in ("scenario", "algorithm", "iteration", "variable", "sample")
    }
    coords["run"] = sorted(_union(unit["run"].values for unit in units))
    sizes = {**{dim: len(labels) for dim, labels in coords.items()}, "term": len(TERMS), "axis": 3}
    values = {
        name: np.full(
            [sizes[dim] for dim in variable.dims],
            np.nan if issubclass(variable.dtype, np.floating) and name not in SUMMED else 0,
            variable.dtype,
        )
        for name, variable in VARIABLES.items()
    }
    best = np.full((sizes["scenario"], sizes["algorithm"]), np.inf)
    for unit in units:
        place = {
            dim: [coords[dim].index(label) for label in unit[dim].values.tolist()]
            for dim in coords
        }
        _refuse_overlap(values["fitness"], unit, place)
        leads = _leads(best, unit, place)
        for name, variable in VARIABLES.items():
            where = np.ix_(*(place.get(dim, range(sizes[dim])) for dim in variable.dims))
            given = unit[name].transpose(*variable.dims).values
            if name in SUMMED:
                values[name][where] += given
            elif name in ("position", "curvature_radius"):  # they tell of the best run so far
                mask = leads.reshape(leads.shape + (1,) * (given.ndim - 2))
                values[name][where] = np.where(mask, given, values[name][where])
            else:
                values[name][where] = given
    merged = dataset(coords, values)
    merged.attrs = dict(units[0].attrs)
    return merged


def _refuse_overlap(fitness: np.ndarray, unit: xr.Dataset, place: dict[str, list[int]]) -> None:
    cells = np.ix_(place["scenario"], place["algorithm"], place["run"])
    if not np.isnan(fitness[cells]).all():
        raise InputError(
            f"runs {unit['run'].values.tolist()} of {unit['algorithm'].values.tolist()} are there "
            "twice; append runs with other indices"
        )


def _leads(best: np.ndarray, unit: xr.Dataset, place: dict[str, list[int]]) -> np.ndarray:
    """Where a unit's best run is the best so far, (scenario, algorithm); updates `best`."""
    cells = np.ix_(place["scenario"], place["algorithm"])
    found = unit["fitness"].transpose(*_RUN).min("run").values
    leads = (found < best[cells]) | np.isinf(best[cells])
    best[cells] = np.minimum(found, best[cells])
    return leads


def _union(labels: Iterable[np.ndarray]) -> list:
    return list(dict.fromkeys(label for group in labels for label in group.tolist()))


def append(ds: xr.Dataset, more: xr.Dataset) -> xr.Dataset:
    """Two comparisons of the same settings as one, for example further runs of a long study.

    Raises:
        InputError: the settings differ, or a run is in both.
    """
    if difference := different_settings(ds, more):
        raise InputError(f"the two comparisons differ in {difference}; append only equal settings")
    return merge([ds, more])


def different_settings(ds: xr.Dataset, more: xr.Dataset) -> str:
    """Name of the first setting or version in which two datasets differ, "" if none does."""
    for attribute in ("settings", "versions"):
        one, two = (json.loads(each.attrs.get(attribute, "{}")) for each in (ds, more))
        for key in sorted(one.keys() | two.keys()):
            if one.get(key) != two.get(key):
                return f"{key} ({one.get(key)!r} and {two.get(key)!r})"
    return ""


def provenance() -> dict[str, str]:
    """Attributes that tell where numbers come from: versions, machine, time."""
    machine = {
        "platform": platform.platform(),
        "processor": platform.machine(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "devices": [str(device) for device in jax.devices()],
        "xla_flags": os.environ.get("XLA_FLAGS", ""),
    }
    return {
        "versions": json.dumps(
            {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}
        ),
        "machine": json.dumps(machine),
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
    }


def save(ds: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset as NetCDF-4, atomically; its folder is created where missing."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_path(path) as scratch:
        ds.to_netcdf(scratch, engine="h5netcdf")


def load(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a saved dataset into memory.

    Raises:
        InputError: the file is missing, no NetCDF, or not a comparison of this layout.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; `jaxsusp compare` writes results/compare.nc")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as ds:
            ds = ds.load()
    except (OSError, ValueError) as error:
        raise InputError(
            f"{path}: cannot be read as NetCDF ({error}); give a file that `jaxsusp compare` wrote"
        ) from error
    missing = [name for name in VARIABLES if name not in ds]
    if missing:
        raise InputError(
            f"{path}: lacks {', '.join(missing)}; give a file that `jaxsusp compare` wrote"
        )
    return ds
