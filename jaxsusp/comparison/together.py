"""Several files of one comparison as one dataset."""

import os
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from jaxsusp.comparison.dataset import append_results, load_results
from jaxsusp.errors import InputError, require


def load_together(paths: Sequence[str | os.PathLike[str]]) -> xr.Dataset:
    """Files of equal settings and versions: other algorithms, or further runs, of the same.

    Args:
        paths: one or more files that `jaxsusp compare` wrote.

    Raises:
        InputError: one cannot be read, two differ, or an algorithm is missing where another one is;
            names the files and the difference.
    """
    first, *others = map(Path, paths)
    whole = load_results(first)
    for path in others:
        try:
            whole = append_results(whole, load_results(path))
        except InputError as error:
            if str(path) in str(error):
                raise
            raise InputError(f"{first} and {path}: {error}") from error
    _require_complete(whole, paths)
    return whole


def _require_complete(whole: xr.Dataset, paths: Sequence[str | os.PathLike[str]]) -> None:
    """An algorithm that no file has together with a scenario cannot be ranked there."""
    there: dict[str, set[str]] = {}
    for path in paths:
        ds = load_results(path)
        for name in ds["algorithm"].values.tolist():
            there.setdefault(name, set()).update(ds["scenario"].values.tolist())
    scenarios = whole["scenario"].values.tolist()
    for name, known in there.items():
        lacking = [each for each in scenarios if each not in known]
        require(
            not lacking,
            f"{' and '.join(map(str, paths))}: none of them has {name} on {', '.join(lacking)}; "
            "give files with the same scenarios for every algorithm, or report each by itself",
        )
