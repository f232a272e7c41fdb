"""Several files of one comparison as one dataset."""

import os
from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from jaxsusp.comparison.dataset import append_results, load_results
from jaxsusp.errors import InputError


def load_together(paths: Sequence[str | os.PathLike[str]]) -> xr.Dataset:
    """Files of equal settings and versions: other algorithms, or further runs, of the same.

    Args:
        paths: one or more files that `jaxsusp compare` wrote.

    Raises:
        InputError: one cannot be read, or two differ; names the files and the first difference.
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
    return whole
