"""Where a comparison keeps what is finished, so that an interrupt loses nothing.

Every finished unit is one small NetCDF file in `compare.parts`; when all are there they become
`compare.nc` and the folder is removed. A store without a folder keeps nothing.
"""

import hashlib
import shutil
from pathlib import Path

import xarray as xr

from jaxsusp import results
from jaxsusp.errors import InputError

FILE, PARTS = "compare.nc", "compare.parts"


class Store:
    """Units of one comparison on disk.

    Args:
        folder: where results go, or None.
        attributes: attributes of the dataset; settings and versions must agree to resume.
    """

    def __init__(self, folder: Path | None, attributes: dict[str, str]):
        self.folder = folder
        self.attributes = attributes
        self._others_discarded = False

    def finished(self) -> list[xr.Dataset]:
        """Finished units of an interrupted comparison, and those of a complete one.

        Raises:
            InputError: they were made with other settings or versions.
        """
        if self.folder is None:
            return []
        files = sorted((self.folder / PARTS).glob("*.nc"))
        if (self.folder / FILE).exists():
            files.append(self.folder / FILE)
        self._others_discarded = True  # what is there belongs to this comparison
        units = []
        for file in files:
            ds = results.load(file)
            mine = xr.Dataset(attrs=self.attributes)
            if difference := results.different_settings(mine, ds):
                raise InputError(
                    f"{file}: cannot be resumed, it differs in {difference}; use the same "
                    "settings, another --output, or start anew without --resume"
                )
            units += [ds.sel(algorithm=[name]) for name in ds["algorithm"].values]
        return units

    def save(self, unit: xr.Dataset) -> None:
        """Keep a unit; the first one discards the parts of an earlier, abandoned comparison."""
        if self.folder is None:
            return
        parts = self.folder / PARTS
        if not self._others_discarded:
            shutil.rmtree(parts, ignore_errors=True)
            self._others_discarded = True
        labels = [unit[dim].values.tolist() for dim in ("scenario", "algorithm", "run")]
        name = f"{labels[1][0]}-{hashlib.sha256(repr(labels).encode()).hexdigest()[:12]}.nc"
        results.save(unit.assign_attrs(self.attributes), parts / name)

    def complete(self, units: list[xr.Dataset]) -> xr.Dataset:
        """Put all units together, save the whole and remove the parts."""
        ds = results.merge(units).assign_attrs(self.attributes)
        if self.folder is not None:
            results.save(ds, self.folder / FILE)
            shutil.rmtree(self.folder / PARTS, ignore_errors=True)
        return ds
