"""Comparisons in files: one NetCDF-4 file, or the many of a long study."""

import json
import os
from pathlib import Path

import h5py
import xarray as xr

from jaxsusp._files import write_netcdf
from jaxsusp.comparison.choices import MANIFEST
from jaxsusp.comparison.dataset import CELL, JSON_ATTRIBUTES, NUMBERED, VARIABLES, assemble
from jaxsusp.comparison.kept.earlier import ADDED, brought_up_to_date
from jaxsusp.comparison.kept.study import open_study
from jaxsusp.errors import InputError


def save_results(ds: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset as NetCDF-4, atomically; its folder is created where missing.

    Raises:
        InputError: the place cannot be written.
    """
    write_netcdf(ds, path)


def load_results(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a saved dataset into memory, exactly as it was saved.

    What files of earlier versions do not hold is added, see `kept.earlier`. Of a long study
    (`compare.json`) histories and decision vectors are read when they are asked for, see
    `kept.study`.

    Raises:
        InputError: the file is missing, no NetCDF-4, damaged, or not a comparison of this layout.
    """
    path, remedy = Path(path), "give a file that `jaxsusp compare` wrote"
    if path.name == MANIFEST:
        return open_study(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file; {remedy}, such as results/compare.nc")
    try:
        with h5py.File(path, "r") as file:
            dict(file.attrs)  # where this fails, h5netcdf would also print a traceback
        with xr.open_dataset(path, engine="h5netcdf", phony_dims="access") as stored:
            ds = stored.load()
    except Exception as error:  # a damaged file can raise anything
        raise InputError(f"{path}: cannot be read as NetCDF-4 ({error}); {remedy}") from error
    if wrong := _not_this_layout(ds):
        raise InputError(f"{path}: is not a comparison ({wrong}); {remedy}")
    ds = brought_up_to_date(ds)
    values = {name: ds[name].values for name in VARIABLES}
    return assemble({dim: ds[dim].values for dim in (*CELL, *NUMBERED)}, values).assign_attrs(
        ds.attrs
    )


def _not_this_layout(ds: xr.Dataset) -> str:
    """What is missing or wrong, "" if nothing is."""
    for name, variable in VARIABLES.items():
        if name in ADDED and name not in ds:
            continue
        if name not in ds or ds[name].dims != variable.dims:
            return f"it has no {name} with dimensions {', '.join(variable.dims)}"
    for dim in (*CELL, *NUMBERED):
        if dim == "step" and "history_best" not in ds:
            continue
        if dim not in ds.coords:
            return f"{dim} has no labels"
    for name in JSON_ATTRIBUTES:
        try:
            json.loads(ds.attrs[name])
        except (KeyError, TypeError, ValueError):
            return f"attribute {name} is missing or broken"
    return ""
