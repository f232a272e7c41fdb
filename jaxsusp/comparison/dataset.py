"""The labelled dataset of a comparison: assemble, save, load, append.

One layout serves a whole comparison and the units it is computed in (one algorithm, some runs, the
scenarios of one static shape), so that resuming, appending runs and merging use the same code.
Missing cells are NaN (0 in integer variables) and marked by a NaN fitness.
"""

import datetime
import json
import os
import platform
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from typing import Any, NamedTuple, TypedDict

import jax
import numpy as np
import xarray as xr

from jaxsusp.cluster.worker import DECISIVE
from jaxsusp.comparison.overview import Overview as Overview  # registers `ds.jaxsusp`
from jaxsusp.errors import InputError
from jaxsusp.optim.devices import cores

TERMS = ("length", "height", "cable", "tension_rate", "curvature", "penalty")
PACKAGES = ("jaxsusp", "jax", "jaxlib", "numpy", "scipy", "xarray", "h5netcdf")
JSON_ATTRIBUTES = ("settings", "coefficients", "scenario_files", "versions", "machine")

TIME_BUDGET = "time_budget"
"""The attribute that holds an `Allotment`, in comparisons whose budget is time."""


PROCESSORS = "processors"
"""The attribute that lists the kinds of processors that runs were computed on."""


class Allotment(TypedDict):
    """What every algorithm got of a budget of time."""

    seconds: float  # per run
    iterations: dict[str, int]  # by algorithm


class Variable(NamedTuple):
    """Dimensions, type and meaning of one variable of the dataset."""

    dims: tuple[str, ...]
    dtype: type
    meaning: str
    units: str = "1"


CELL = ("scenario", "algorithm")
RUN = (*CELL, "run")
NUMBERED = ("run", "iteration", "step", "variable", "sample")
"""Dimensions of a cell and of a run, and those whose labels are numbers."""

VARIABLES: dict[str, Variable] = {
    "fitness": Variable(RUN, np.float64, "best fitness, re-evaluated in float64 (Eq. 21)"),
    "terms": Variable((*RUN, "term"), np.float64, "terms f1 … f6 of the best candidate"),
    "collisions": Variable(RUN, np.int64, "contacts n_p of the best candidate"),
    "violations": Variable(RUN, np.int64, "violated limits n_g of the best candidate"),
    "x": Variable((*RUN, "variable"), np.float64, "best decision vector (waypoints)", "m"),
    "history": Variable((*RUN, "iteration"), np.float32, "best fitness so far"),
    "history_best": Variable(
        (*CELL, "step"), np.float32, "best fitness so far of the best run, after every iteration"
    ),
    "position": Variable(
        (*CELL, "sample", "axis"), np.float64, "trajectory of the best run's load", "m"
    ),
    "curvature_radius": Variable(
        CELL, np.float64, "median of 1/curvature over the best run's interior samples", "m"
    ),
    "evaluations": Variable(CELL, np.int64, "fitness evaluations per run"),
    "evaluations_initial": Variable(CELL, np.int64, "of these, before the first iteration"),
    "evaluations_polish": Variable(CELL, np.int64, "of these, after the last iteration"),
    "stability_acted": Variable(RUN, np.float64, "share of beetles that Eq. 19 acted on"),
    "stability_kept": Variable(RUN, np.float64, "share of beetles that Eq. 19 improved"),
    "obstacles": Variable(("scenario",), np.int64, "number of obstacles"),
    "unit_length": Variable(("scenario",), np.float64, "unit of length of the fitness", "m"),
    "unit_mass": Variable(("scenario",), np.float64, "unit of mass of the fitness", "kg"),
    "best_known": Variable(
        ("scenario",), np.float64, "lowest fitness known when this was computed, NaN if none is"
    ),
    "iterations": Variable(("algorithm",), np.int64, "iterations per run"),
    "seconds_run": Variable(("algorithm",), np.float64, "computation of all runs", "s"),
    "seconds_compile": Variable(("algorithm",), np.float64, "compilation, once", "s"),
}

SUMMED = ("seconds_run", "seconds_compile")
"""Variables that add up when a comparison is put together from units."""

LOWEST = ("best_known",)
"""Variables of which the lowest value that is there holds."""

OF_THE_BEST_RUN = ("position", "curvature_radius", "history_best")
"""Variables that tell of the best run of a cell."""


def assemble(coords: Mapping[str, Any], values: Mapping[str, np.ndarray]) -> xr.Dataset:
    """A dataset of the one layout.

    Args:
        coords: labels of scenario, algorithm, run, iteration, step, variable, sample.
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


def thinned(iterations: int, most: int | None) -> list[int]:
    """Iterations 1 … T, or at most so many of them, evenly spaced; first and last always."""
    if most is None or iterations <= most:
        return list(range(1, iterations + 1))
    return np.unique(np.linspace(1, iterations, most).round().astype(int)).tolist()


def merge(units: Sequence[xr.Dataset]) -> xr.Dataset:
    """Put datasets of one comparison together.

    Scenarios and algorithms keep the order in which they first appear; numbered labels are sorted.

    Raises:
        InputError: two of them hold the same run of the same algorithm on the same scenario.
    """
    coords = {dim: _union(unit[dim].values for unit in units) for dim in CELL}
    coords |= {dim: sorted(_union(unit[dim].values for unit in units)) for dim in NUMBERED}
    sizes = {**{dim: len(labels) for dim, labels in coords.items()}, "term": len(TERMS), "axis": 3}
    values = {
        name: np.full(
            [sizes[dim] for dim in variable.dims],
            np.nan if issubclass(variable.dtype, np.floating) and name not in SUMMED else 0,
            variable.dtype,
        )
        for name, variable in VARIABLES.items()
    }
    best = np.full((sizes["scenario"], sizes["algorithm"]), np.nan)
    for unit in sorted(units, key=lambda unit: unit["run"].values.min()):  # a tie goes to the first
        place = {
            dim: [coords[dim].index(label) for label in unit[dim].values.tolist()] for dim in coords
        }
        there = unit["fitness"].transpose(*RUN).notnull()
        _refuse_overlap(values["fitness"], there, place)
        leads = _leads(best, unit, place)
        for name, variable in VARIABLES.items():
            where = np.ix_(*(place.get(dim, range(sizes[dim])) for dim in variable.dims))
            given = unit[name].transpose(*variable.dims).values
            if name in SUMMED:
                values[name][where] += given
                continue
            if name in LOWEST:
                values[name][where] = np.fmin(values[name][where], given)
                continue
            if name in OF_THE_BEST_RUN:
                told = leads
            else:
                told = there.any([dim for dim in RUN if dim not in variable.dims]).values
            told = told.reshape(told.shape + (1,) * (given.ndim - told.ndim))
            values[name][where] = np.where(told, given, values[name][where])
    return assemble(coords, values).assign_attrs(_united_attributes(units))


def _refuse_overlap(fitness: np.ndarray, there: xr.DataArray, place: dict[str, list[int]]) -> None:
    twice = there & ~np.isnan(fitness[np.ix_(*(place[dim] for dim in RUN))])
    if twice.any():
        runs = twice["run"].values[twice.any(CELL).values].tolist()
        names = twice["algorithm"].values[twice.any(("scenario", "run")).values].tolist()
        raise InputError(
            f"run = {runs} of {', '.join(names)} is there twice; append runs with other numbers"
        )


def _leads(best: np.ndarray, unit: xr.Dataset, place: dict[str, list[int]]) -> np.ndarray:
    """Where a unit has the best run so far, (scenario, algorithm); updates `best`."""
    cells = np.ix_(*(place[dim] for dim in CELL))
    found = unit["fitness"].transpose(*RUN).min("run").values  # NaN only where there is no run
    leads = (found < best[cells]) | (np.isnan(best[cells]) & ~np.isnan(found))
    best[cells] = np.fmin(found, best[cells])
    return leads


def _united_attributes(units: Sequence[xr.Dataset]) -> dict[str, Any]:
    """Those of the first unit, with coefficients and allotted time of the algorithms of all."""
    attributes = dict(units[0].attrs)
    if TIME_BUDGET in attributes:
        allotted = time_allotted(units[0])
        for unit in units[1:]:
            allotted["iterations"] |= time_allotted(unit)["iterations"]
        attributes[TIME_BUDGET] = json.dumps(allotted)
    if "coefficients" in attributes:
        united = {}
        for unit in units:
            united |= json.loads(unit.attrs.get("coefficients", "{}"))
        attributes["coefficients"] = json.dumps(united)
    if kinds := {kind for unit in units for kind in processors(unit)}:
        attributes[PROCESSORS] = json.dumps(sorted(kinds))
    return attributes


def processors(ds: xr.Dataset) -> list[str]:
    """Kinds of processors that runs were computed on: between two of them rounding differs."""
    return json.loads(ds.attrs.get(PROCESSORS, "[]"))


def _union(labels: Iterable[np.ndarray]) -> list:
    return list(dict.fromkeys(label for group in labels for label in group.tolist()))


def append_results(ds: xr.Dataset, more: xr.Dataset) -> xr.Dataset:
    """Two comparisons of the same settings as one, for example further runs of a long study.

    Raises:
        InputError: the settings differ, or a run is in both.
    """
    if difference := different_settings(ds, more):
        raise InputError(f"the two comparisons differ in {difference}; append only equal settings")
    return merge([ds, more])


def different_settings(ds: xr.Dataset, more: xr.Dataset) -> str:
    """The first setting, decisive version or coefficient in which two datasets differ, or ""."""
    (one, one_versions, one_algorithms), (two, two_versions, two_algorithms) = (
        [
            json.loads(each.attrs.get(name, "{}"))
            for name in ("settings", "versions", "coefficients")
        ]
        for each in (ds, more)
    )
    for key in one | two:
        if one.get(key) != two.get(key):
            if key == "scenarios":
                return _different_scenarios(one.get(key, {}), two.get(key, {}))
            return f"{key} ({one.get(key)!r} and {two.get(key)!r})"
    for package in DECISIVE:
        if one_versions.get(package) != two_versions.get(package):
            return (
                f"the version of {package} "
                f"({one_versions.get(package)} and {two_versions.get(package)})"
            )
    for name in one_algorithms.keys() & two_algorithms.keys():
        if one_algorithms[name] != two_algorithms[name]:
            return _different_coefficients(name, one_algorithms[name], two_algorithms[name])
    return _different_time(time_allotted(ds), time_allotted(more))


def _different_scenarios(one: dict[str, str], two: dict[str, str]) -> str:
    if one.keys() != two.keys():
        return f"scenarios ({', '.join(one)} and {', '.join(two)})"
    changed = ", ".join(name for name in one if one[name] != two[name])
    return f"the content of scenarios ({changed})"


def _different_coefficients(name: str, one: list, two: list) -> str:
    """Of an algorithm of another library, what it is from stands behind the coefficients."""
    origins = [each[-1] for each in (one, two) if each and isinstance(each[-1], str)]
    if len({*origins}) == 2:
        return f"what {name} is from ({origins[0]} and {origins[1]})"
    return f"the coefficients of {name}"


def _different_time(one: Allotment, two: Allotment) -> str:
    if not one["iterations"] or not two["iterations"]:  # not allotted yet
        return ""
    if one["seconds"] != two["seconds"]:
        return f"the time measured for a run ({one['seconds']:.4g} s and {two['seconds']:.4g} s)"
    for name in one["iterations"].keys() & two["iterations"].keys():
        if one["iterations"][name] != two["iterations"][name]:
            return f"the iterations of {name}"
    return ""


def time_allotted(ds: xr.Dataset) -> Allotment:
    """What the algorithms of a comparison got, nothing where time was not its budget."""
    return json.loads(ds.attrs.get(TIME_BUDGET, '{"seconds": 0.0, "iterations": {}}'))


def provenance() -> dict[str, str]:
    """Attributes that tell where numbers come from: versions, machine, time."""
    machine = {
        "platform": platform.platform(),
        "processor": platform.machine(),
        "cores": cores(),
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
