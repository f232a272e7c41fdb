"""A long study: a file for every chunk of runs, and a manifest that lists them.

The dataset has the layout of any other comparison. What a few numbers tell is in memory; histories
and decision vectors are read, chunk by chunk, when they are asked for.
"""

import hashlib
import json
from collections.abc import Iterable, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import dask.array as da
import h5py
import numpy as np
import xarray as xr
from dask.base import compute
from dask.delayed import delayed
from pydantic import BaseModel, ValidationError

from jaxsusp._files import write_text
from jaxsusp.comparison.choices import PARTS
from jaxsusp.comparison.dataset import CELL, NUMBERED, VARIABLES, assemble, merge
from jaxsusp.errors import InputError

LAYOUT = 1

LAZY = ("history", "x")
"""Variables that are read when they are asked for: of a run they hold three quarters."""


class Part(NamedTuple):
    """A file of the study, as the manifest has it."""

    file: str  # in the folder of parts
    algorithm: str
    scenarios: list[str]
    runs: list[tuple[int, int]]  # first and last of every stretch
    bytes: int
    digest: str = ""  # of its content; earlier studies have none


class Manifest(NamedTuple):
    """What there is of a study."""

    attributes: dict[str, Any]
    parts: list[Part]
    complete: bool


class _Listed(BaseModel):
    """A manifest as its file has it."""

    layout: int
    complete: bool
    attributes: dict[str, Any]
    parts: list[Part]


def part_of(ds: xr.Dataset, file: Path) -> Part:
    """The entry of a chunk that was saved."""
    (algorithm,) = ds["algorithm"].values.tolist()
    stretches = _stretches(ds["run"].values.tolist())
    return Part(
        file.name, algorithm, ds["scenario"].values.tolist(), stretches, file.stat().st_size,
        _digest(file),
    )  # fmt: skip


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "blake2b").hexdigest()[:32]


def _stretches(runs: Sequence[int]) -> list[tuple[int, int]]:
    found = []
    for _, group in groupby(enumerate(sorted(runs)), lambda pair: pair[1] - pair[0]):
        members = [run for _, run in group]
        found.append((members[0], members[-1]))
    return found


def write_manifest(path: Path, manifest: Manifest) -> None:
    """Write it atomically, a line for every file."""
    head = {"layout": LAYOUT, "complete": manifest.complete, "attributes": manifest.attributes}
    lines = ",\n".join(json.dumps(part._asdict()) for part in manifest.parts)
    write_text(path, f'{json.dumps(head)[:-1]}, "parts": [\n{lines}\n]}}\n')


def read_manifest(path: Path) -> Manifest:
    """Read it.

    Raises:
        InputError: it is missing, damaged or of another layout.
    """
    remedy = "give the compare.json that `jaxsusp compare` wrote, with its folder compare.parts"
    try:
        found = _Listed.model_validate_json(path.read_text(encoding="utf-8"))
        for name in ("settings", "scenario_files"):
            if not isinstance(json.loads(found.attributes[name]), dict):
                raise ValueError(f"its attribute {name} is none of a comparison")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; {remedy}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        told = f"{where}: {first['msg']}" if where else first["msg"]
        raise InputError(f"{path}: cannot be read as a manifest ({told}); {remedy}") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: cannot be read as a manifest ({error}); {remedy}") from error
    if found.layout != LAYOUT:
        raise InputError(f"{path}: is of layout {found.layout}, not {LAYOUT}; {remedy}")
    return Manifest(found.attributes, found.parts, found.complete)


def open_study(path: Path) -> xr.Dataset:
    """The dataset of a study, complete or not; `LAZY` variables are not read.

    Args:
        path: its manifest.

    Raises:
        InputError: the manifest or a part is missing or damaged, or nothing has finished yet.
    """
    manifest = read_manifest(path)
    if not manifest.parts:
        raise InputError(f"{path}: nothing of this study has finished yet; go on with --resume")
    files = [path.parent / PARTS / part.file for part in manifest.parts]
    for file, part in zip(files, manifest.parts, strict=True):
        if wrong := what_is_wrong(file, part):
            raise InputError(
                f"{file}: {wrong}; restore it, or go on with --resume, and its runs are computed "
                "again"
            )
    heads = [_head(*each) for each in zip(files, manifest.parts, strict=True)]
    small = merge(heads)
    runs = sorted({run for part in manifest.parts for run in _runs(part)})
    sizes = {str(dim): small[dim].values for dim in small.dims} | {"run": np.array(runs)}
    pieces = [_Piece(file, head, part) for file, head, part in zip(
        files, heads, manifest.parts, strict=True
    )]  # fmt: skip
    lazy = {name: _assembled(name, pieces, sizes) for name in VARIABLES if _of_runs(name)}
    small_ones = [name for name in lazy if name not in LAZY]
    lazy |= dict(zip(small_ones, compute(*[lazy[name] for name in small_ones]), strict=True))
    ds = small.drop_dims("run").assign_coords(run=runs)
    ds = ds.assign({
        name: (VARIABLES[name].dims, values, small[name].attrs) for name, values in lazy.items()
    })  # fmt: skip
    return ds[[*VARIABLES]].assign_attrs(small.attrs)


def _of_runs(name: str) -> bool:
    return "run" in VARIABLES[name].dims


def what_is_wrong(file: Path, part: Part) -> str:
    """Why a file is not the part that was listed, in words; "" if it is."""
    if not file.is_file():
        return "no such file, but the study lists it"
    if file.stat().st_size != part.bytes:
        return f"has {file.stat().st_size} bytes instead of {part.bytes}"
    if part.digest and _digest(file) != part.digest:
        return "holds something else than was written"
    return ""


def _head(file: Path, part: Part) -> xr.Dataset:
    """A part as if its best run were its only one: enough to tell what belongs to cells.

    Raises:
        InputError: it is no part of a comparison, or not that of the runs that are listed.
    """
    remedy = "delete the study, or restore its manifest and its parts"
    try:
        found, runs = _best_of(file)
    except (OSError, KeyError, ValueError) as error:
        raise InputError(f"{file}: cannot be read ({error}); {remedy}") from error
    if runs != (listed := _runs(part)):
        raise InputError(
            f"{file}: holds {len(runs)} runs from {runs[0]} to {runs[-1]}, and {len(listed)} from "
            f"{listed[0]} to {listed[-1]} are listed; {remedy}"
        )
    return found


def _runs(part: Part) -> list[int]:
    return [run for first, last in part.runs for run in range(first, last + 1)]


def _best_of(file: Path) -> tuple[xr.Dataset, list[int]]:
    content: Any
    with h5py.File(file, "r") as content:  # of hundreds of files: ten times as fast as xarray
        coords = {dim: _label(content[dim]) for dim in (*CELL, *NUMBERED)}
        values = {}
        for name, variable in VARIABLES.items():
            kept = [slice(1) if dim == "run" else slice(None) for dim in variable.dims]
            values[name] = np.asarray(content[name][tuple(kept)])
        values["fitness"] = np.nanmin(content["fitness"][...], axis=2, keepdims=True)
        attributes = {key: _one(content.attrs[key]) for key in content.attrs if key[0] != "_"}
    head = assemble({**coords, "run": coords["run"][:1]}, values).assign_attrs(attributes)
    return head, coords["run"].tolist()


def _one(attribute: Any) -> Any:
    """An attribute; NetCDF keeps a number as an array of one."""
    single = isinstance(attribute, np.ndarray) and attribute.size == 1
    return attribute[0] if single else attribute


def _label(labels: h5py.Dataset) -> np.ndarray:
    """Labels of a dimension."""
    return np.array(labels.asstr()[...] if h5py.check_string_dtype(labels.dtype) else labels[...])


class _Piece(NamedTuple):
    """A part with the labels of its dimensions."""

    file: Path
    head: xr.Dataset
    part: Part

    def labels(self, dim: str) -> np.ndarray:
        """Labels along a dimension."""
        if dim != "run":
            return self.head[dim].values
        return np.array(_runs(self.part))

    def array(self, name: str) -> da.Array:
        """A variable that is read when it is needed."""
        variable = VARIABLES[name]
        shape = tuple(len(self.labels(dim)) for dim in variable.dims)
        reading = delayed(_read, pure=True)(str(self.file), name, variable.dtype)
        return da.from_delayed(reading, shape, variable.dtype)


def _read(file: str, name: str, dtype: type) -> np.ndarray:
    content: Any
    with h5py.File(file, "r") as content:
        return np.asarray(content[name][...], dtype)


def _assembled(name: str, pieces: Iterable[_Piece], labels: dict[str, np.ndarray]) -> da.Array:
    """A variable of all parts: runs after each other, then scenarios, then algorithms."""
    dims = VARIABLES[name].dims
    fill = np.nan if issubclass(VARIABLES[name].dtype, np.floating) else 0
    rows = []
    for algorithm in labels["algorithm"].tolist():
        of_it = [piece for piece in pieces if piece.part.algorithm == algorithm]
        groups = list(dict.fromkeys(tuple(piece.part.scenarios) for piece in of_it))
        columns = []
        for group in groups:
            members = [piece for piece in of_it if tuple(piece.part.scenarios) == group]
            arrays = []
            for piece in members:
                array = piece.array(name)
                for axis, dim in enumerate(dims[3:], start=3):
                    array = _placed(array, axis, piece.labels(dim), labels[dim], fill)
                arrays.append(array)
            runs = np.concatenate([piece.labels("run") for piece in members])
            whole = da.concatenate(arrays, axis=2)
            columns.append(_placed(whole, 2, runs, labels["run"], fill))
        known = np.array([scenario for group in groups for scenario in group])
        rows.append(_placed(da.concatenate(columns, axis=0), 0, known, labels["scenario"], fill))
    return da.concatenate(rows, axis=1)


def _placed(
    array: da.Array, axis: int, labels: np.ndarray, wanted: np.ndarray, fill: float | int
) -> da.Array:
    """An array whose entries along an axis go where their labels are wanted; nothing elsewhere."""
    if np.array_equal(labels, wanted):
        return array
    place = {label: i for i, label in enumerate(labels.tolist())}
    index = np.array([place.get(label, len(labels)) for label in wanted.tolist()])
    if (index == len(labels)).any():
        shape = (*array.shape[:axis], 1, *array.shape[axis + 1 :])
        array = da.concatenate([array, da.full(shape, fill, dtype=array.dtype)], axis=axis)
    return da.take(array, index, axis=axis)
