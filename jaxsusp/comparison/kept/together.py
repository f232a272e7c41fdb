"""Several files of one comparison as one dataset."""

import os
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from jaxsusp.comparison.dataset import append_results
from jaxsusp.comparison.kept.files import load_results
from jaxsusp.errors import InputError, require


def load_together(paths: Sequence[str | os.PathLike[str]]) -> xr.Dataset:
    """Files of equal settings and versions: other algorithms, or further runs, of the same.

    Args:
        paths: one or more files that `jaxsusp compare` wrote.

    Raises:
        InputError: one cannot be read, two differ, or an algorithm is missing where another one is;
            names the files and the difference.
    """
    parts = [(Path(path), load_results(path)) for path in paths]
    (first, whole), *others = parts
    for path, part in others:
        try:
            whole = append_results(whole, part)
        except InputError as error:
            raise InputError(f"{first} and {path}: {error}") from error
    _require_complete(whole, parts)
    return whole


def _require_complete(whole: xr.Dataset, parts: Sequence[tuple[Path, xr.Dataset]]) -> None:
    """An algorithm that no file has together with a scenario cannot be ranked there."""
    there: dict[str, set[str]] = {}
    for _, ds in parts:
        for name in ds["algorithm"].values.tolist():
            there.setdefault(name, set()).update(ds["scenario"].values.tolist())
    scenarios, named = (
        whole["scenario"].values.tolist(),
        " and ".join(str(path) for path, _ in parts),
    )
    for name, known in there.items():
        lacking = [each for each in scenarios if each not in known]
        require(
            not lacking,
            f"{named}: none of them has {name} on {', '.join(lacking)}; "
            "give files with the same scenarios for every algorithm, or report each by itself",
        )
