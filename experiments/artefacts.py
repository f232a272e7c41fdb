"""The data behind every table and figure: small files that are kept, with settings and versions."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

from jaxsusp._files import atomic_path, write_text
from jaxsusp.comparison import dataset
from jaxsusp.comparison.kept.together import load_together
from jaxsusp.errors import InputError

KEPT = Path(__file__).parent / "data"
_REMARK = "# "


class Artefacts:
    """A folder of them: datasets as NetCDF, frames as CSV below a line of JSON."""

    def __init__(self, folder: Path = KEPT):
        self.folder = folder

    def keep(self, name: str, data: xr.Dataset | pd.DataFrame, settings: Any = None) -> None:
        """Write one, compressed, with what it was made with.

        Args:
            name: without suffix.
            data: comparisons carry their settings themselves.
            settings: a NamedTuple, for those that do not.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        if isinstance(data, xr.Dataset):
            packed = {"zlib": True, "complevel": 9, "shuffle": True}
            with atomic_path(self.folder / f"{name}.nc") as scratch:
                data.to_netcdf(
                    scratch,
                    engine="h5netcdf",
                    encoding={each: packed for each in data.data_vars if data[each].ndim},
                )
            return
        told = {"settings": settings._asdict() if settings else {}, **dataset.provenance()}
        head = _REMARK + json.dumps(told)
        write_text(self.folder / f"{name}.csv", f"{head}\n{data.to_csv(index=False)}")

    def comparison(self, *names: str, **needs: Sequence[str]) -> xr.Dataset:
        """One comparison, or several of equal settings as one.

        Args:
            *names: without suffix.
            **needs: what a page cannot do without: names along "scenario" or "algorithm".

        Raises:
            InputError: one is missing, two differ in a setting or version, or what a page needs
                is not in it.
        """
        ds = load_together([self._there(f"{name}.nc") for name in names])
        for dim, needed in needs.items():
            if lacking := [each for each in needed if each not in ds[dim].values]:
                raise InputError(
                    f"{', '.join(names)}: holds no {dim} {', '.join(lacking)}, of which this page "
                    f"tells; {self._maker(names)} makes it"
                )
        return ds

    def dataset(self, name: str) -> xr.Dataset:
        """A dataset that is no comparison."""
        return xr.load_dataset(self._there(f"{name}.nc"), engine="h5netcdf")

    def frame(self, name: str) -> pd.DataFrame:
        """A table; `attrs` says what it was made with."""
        path = self._there(f"{name}.csv")
        with path.open(encoding="utf-8") as file:
            told = json.loads(file.readline().removeprefix(_REMARK))
            frame = pd.read_csv(file)
        frame.attrs |= {"settings": told["settings"]}
        return frame

    def missing(self, names: Sequence[str]) -> list[str]:
        """Those of the names under which nothing is kept."""
        return [name for name in names if not [*self.folder.glob(f"{name}.*")]]

    def differing(self, names: Sequence[str], settings: Any) -> list[str]:
        """In what the data of these names were made otherwise than with such settings.

        Args:
            names: of artefacts that are there.
            settings: a NamedTuple; only what both tell is looked at.

        Returns:
            "runs = 6 in ablation_six, 9 now" for every difference.
        """
        now, found = json.loads(json.dumps(settings._asdict())), []
        for name in names:
            kept = self._settings(name)
            found += [
                f"{key} = {kept[key]} in {name}, {now[key]} now"
                for key in kept.keys() & now.keys()
                if not isinstance(kept[key], dict) and kept[key] != now[key]
            ]
        return sorted(found)

    def _settings(self, name: str) -> dict[str, Any]:
        if (self.folder / f"{name}.csv").exists():
            return self.frame(name).attrs["settings"]
        return json.loads(self.dataset(name).attrs["settings"])

    def _there(self, file: str) -> Path:
        path = self.folder / file
        if not path.exists():
            raise InputError(f"{path}: is not there; {self._maker([path.stem])} makes it")
        return path

    @staticmethod
    def _maker(names: Sequence[str]) -> str:
        from experiments.contents import making  # which imports this module

        return making(names) or "`python -m experiments make` (all of it)"
