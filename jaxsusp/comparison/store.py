"""Where a comparison keeps what is finished, so that an interrupt loses nothing.

Every finished unit is one small NetCDF file in `compare.parts`; when all are there they become
`compare.nc` and the folder is removed. A store without a folder keeps nothing.
"""

import hashlib
import json
import re
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

import xarray as xr

from jaxsusp._files import require_folder
from jaxsusp.comparison import dataset
from jaxsusp.comparison.choices import FILE, PARTS
from jaxsusp.errors import InputError
from jaxsusp.scenario.scenario import Scenario


class Store:
    """Units of one comparison on disk.

    Args:
        folder: where results go, or None.
        attributes: attributes of the dataset; settings and decisive versions must agree to resume.
    """

    def __init__(self, folder: Path | None, attributes: dict[str, Any]):
        self.folder = folder
        self.attributes = attributes
        self._others_discarded = False

    def prepare(self) -> None:
        """See that the folder can be written before hours are spent on what goes there.

        It is made with the first unit: of a comparison that is interrupted before, nothing stays.

        Raises:
            InputError: it cannot.
        """
        if self.folder is not None:
            require_folder("output", self.folder)

    def finished(self) -> list[xr.Dataset]:
        """What is there of this comparison: the complete file and units finished since.

        An interrupted comparison leaves the complete file of an earlier one in place, whatever its
        settings. So where there are units they decide, and a file of other settings, or of another
        measurement of time, is left out.

        Raises:
            InputError: a file is damaged, or was made with other settings or versions.
        """
        if self.folder is None:
            return []
        self._others_discarded = True  # what is there belongs to this comparison
        parts = [self._own(path) for path in self._part_files()]
        whole = self.folder / FILE
        if not whole.exists():
            return parts
        if not parts:
            return [self._own(whole)]
        ds = dataset.load_results(whole)
        if self._difference(ds) or any(dataset.different_settings(ds, part) for part in parts):
            return parts
        return [ds, *(part for part in parts if not _holds(ds, part))]

    def save(self, unit: xr.Dataset) -> None:
        """Keep a unit; the first one discards the parts of an earlier, abandoned comparison.

        Args:
            unit: a finished unit that carries the store's attributes.
        """
        if self.folder is None:
            return
        parts = self.folder / PARTS
        if not self._others_discarded:
            shutil.rmtree(parts, ignore_errors=True)
            self._others_discarded = True
        labels = [unit[dim].values.tolist() for dim in ("scenario", "algorithm", "run")]
        algorithm = re.sub(r"[^\w-]", "_", labels[1][0])[:40]
        digest = hashlib.sha256(repr(labels).encode()).hexdigest()[:12]
        dataset.save_results(unit, parts / f"{algorithm}-{digest}.nc")

    def complete(self, ds: xr.Dataset) -> None:
        """Save the whole comparison and remove its parts."""
        if self.folder is not None:
            dataset.save_results(ds, self.folder / FILE)
            shutil.rmtree(self.folder / PARTS, ignore_errors=True)

    def _part_files(self) -> list[Path]:
        """Finished units; what a killed process left half-written begins with a dot."""
        assert self.folder is not None
        files = sorted((self.folder / PARTS).glob("*.nc"))
        return [path for path in files if not path.name.startswith(".")]

    def _own(self, path: Path) -> xr.Dataset:
        """Load a file that must belong to this comparison."""
        try:
            ds = dataset.load_results(path)
        except InputError as error:
            raise InputError(f"{error}; or delete it, and its runs are computed again") from error
        if difference := self._difference(ds):
            raise InputError(
                f"{path}: cannot be resumed, it differs in {difference}; use the same settings, "
                "another output folder, or start anew without resume"
            )
        return ds

    def _difference(self, ds: xr.Dataset) -> str:
        return dataset.different_settings(ds, xr.Dataset(attrs=self.attributes))


def stored_scenarios(folder: Path) -> dict[str, Scenario]:
    """The scenarios of what is kept in a folder, by name; none where nothing can be read."""
    found: dict[str, Scenario] = {}
    for path in [*sorted((folder / PARTS).glob("[!.]*.nc")), folder / FILE]:
        with suppress(InputError):
            files = json.loads(dataset.load_results(path).attrs.get("scenario_files", "{}"))
            found = {name: Scenario.from_toml(text) for name, text in files.items()} | found
    return found


def _holds(whole: xr.Dataset, part: xr.Dataset) -> bool:
    """Whether a comparison was completed with this unit, its removal alone being interrupted."""
    labels = {dim: part[dim] for dim in ("scenario", "algorithm", "run")}
    return bool(whole["fitness"].reindex(labels).notnull().all())
