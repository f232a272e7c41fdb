"""Where a comparison keeps what is finished, so that an interrupt loses nothing.

Every finished chunk is one small NetCDF file in `compare.parts`. When all are there they become
`compare.nc` and the folder is removed; those of a long study stay, and `compare.json` lists them.
A store without a folder keeps nothing.
"""

import hashlib
import json
import re
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import xarray as xr

from jaxsusp._files import require_folder, sole_writer
from jaxsusp.comparison import dataset
from jaxsusp.comparison.choices import CURVE, FILE, MANIFEST, PARTS
from jaxsusp.comparison.kept.files import load_results, save_results
from jaxsusp.comparison.kept.study import (
    Manifest,
    Part,
    open_study,
    part_of,
    read_manifest,
    what_is_wrong,
    write_manifest,
)
from jaxsusp.errors import InputError, require
from jaxsusp.scenario.scenario import Scenario

RESUME = "its runs are computed again"


class Store:
    """Chunks of one comparison on disk.

    Args:
        folder: where results go, or None.
        attributes: attributes of the dataset; settings and decisive versions must agree to resume.
        is_long: whether chunks stay in files of their own.
    """

    def __init__(self, folder: Path | None, attributes: dict[str, Any], is_long: bool = False):
        self.folder = folder
        self.attributes = attributes
        self.is_long = is_long and folder is not None
        self._others_discarded = False
        self._parts: list[Part] = []

    @contextmanager
    def claimed(self, resume: bool) -> Iterator[None]:
        """See that the folder can be written, and that nobody else writes there, before hours go.

        It is made with the first chunk: of a comparison that is interrupted before, nothing stays.

        Raises:
            InputError: it cannot, another process does, or a long study is there that this one
                would destroy.
        """
        if self.folder is None:
            yield
            return
        require_folder("output", self.folder)
        require(
            resume or not (self.folder / MANIFEST).exists(),
            f"output = {self.folder}: holds a long study ({MANIFEST}); give resume to go on with "
            "it, choose another folder, or delete it",
        )
        with sole_writer("output", self.folder):
            yield

    def finished(self, groups: Sequence[Sequence[str]] = ()) -> list[xr.Dataset]:
        """What is there of this comparison: the complete file and chunks finished since.

        An interrupted comparison leaves the complete file of an earlier one in place, whatever its
        settings. So where there are chunks they decide, and a file of other settings, or of another
        measurement of time, is left out.

        Args:
            groups: names of the scenarios that are computed together, for a long study: runs of a
                shorter one become chunks of it.

        Raises:
            InputError: a file is damaged, or was made with other settings or versions.
        """
        if self.folder is None:
            return []
        self._others_discarded = True  # what is there belongs to this comparison
        if (self.folder / MANIFEST).exists():
            return self._listed()
        parts = [self._own(path) for path in self._part_files()]
        whole = self.folder / FILE
        found = parts
        if whole.exists() and not parts:
            found = [self._own(whole)]
        elif whole.exists():
            ds = load_results(whole)
            others = any(dataset.different_settings(ds, part) for part in parts)
            if not (self._difference(ds) or others):
                found = [ds, *(part for part in parts if not _holds(ds, part))]
        if self.is_long and found:
            return self._taken_over(dataset.merge(found), groups)
        return found

    def _listed(self) -> list[xr.Dataset]:
        """A long study that was begun; parts of it that are gone or damaged are left out."""
        assert self.folder is not None
        self.is_long = True
        path = self.folder / MANIFEST
        manifest = read_manifest(path)
        self._require_own(path, xr.Dataset(attrs=manifest.attributes))
        known = (
            attributes.get("coefficients", "{}")
            for attributes in (manifest.attributes, self.attributes)
        )
        united = {name: row for text in known for name, row in json.loads(text).items()}
        self.attributes["coefficients"] = json.dumps(united)
        self._parts = [part for part in manifest.parts if self._is_there(part)]
        if len(self._parts) < len(manifest.parts):
            self._list(complete=False)
        return [open_study(path)] if self._parts else []

    def _is_there(self, part: Part) -> bool:
        assert self.folder is not None
        return not what_is_wrong(self.folder / PARTS / part.file, part)

    def _taken_over(self, ds: xr.Dataset, groups: Sequence[Sequence[str]]) -> list[xr.Dataset]:
        """Runs of a comparison as chunks of a long study, their histories thinned."""
        kept = dataset.thinned(ds.sizes["iteration"], CURVE)
        ds = ds.sel(iteration=kept)
        before = self._part_files()
        for names in groups:
            for algorithm in ds["algorithm"].values.tolist():
                cell = ds.sel(scenario=list(names), algorithm=[algorithm])
                whole = cell["fitness"].notnull().all(("scenario", "algorithm"))
                if whole.any():
                    self.save(cell.sel(run=whole).assign_attrs(ds.attrs))
        assert self.folder is not None
        listed = {part.file for part in self._parts}
        for path in [*before, self.folder / FILE]:
            if path.name not in listed:
                path.unlink(missing_ok=True)
        return self._listed()

    def save(self, chunk: xr.Dataset) -> None:
        """Keep a chunk; the first one discards those of an earlier, abandoned comparison.

        Args:
            chunk: a finished chunk that carries the store's attributes.

        Raises:
            InputError: the place cannot be written any more.
        """
        if self.folder is None:
            return
        parts = self.folder / PARTS
        if not self._others_discarded:
            shutil.rmtree(parts, ignore_errors=True)
            self._others_discarded = True
        labels = [chunk[dim].values.tolist() for dim in dataset.RUN]
        algorithm = re.sub(r"[^\w-]", "_", labels[1][0])[:40]
        digest = hashlib.sha256(repr(labels).encode()).hexdigest()[:12]
        file = parts / f"{algorithm}-{digest}.nc"
        save_results(chunk, file)
        if self.is_long:
            self._parts.append(part_of(chunk, file))
            self._list(complete=False)

    def _list(self, complete: bool) -> None:
        assert self.folder is not None
        manifest = Manifest(self.attributes, self._parts, complete)
        write_manifest(self.folder / MANIFEST, manifest)

    def whole(self, found: Iterable[xr.Dataset]) -> xr.Dataset:
        """All of it as one dataset, that of a long study read when it is asked for.

        Args:
            found: all chunks, those that were there before included.
        """
        if self.folder is not None and self.is_long:
            return open_study(self.folder / MANIFEST)
        return dataset.merge(list(found))

    def complete(self, ds: xr.Dataset) -> None:
        """Save the whole comparison and remove its parts; those of a long study stay."""
        if self.folder is None:
            return
        if self.is_long:
            self._list(complete=True)
            (self.folder / FILE).unlink(missing_ok=True)
            return
        save_results(ds, self.folder / FILE)
        shutil.rmtree(self.folder / PARTS, ignore_errors=True)

    def _part_files(self) -> list[Path]:
        """Finished chunks; what a killed process left half-written begins with a dot."""
        assert self.folder is not None
        files = sorted((self.folder / PARTS).glob("*.nc"))
        return [path for path in files if not path.name.startswith(".")]

    def _own(self, path: Path) -> xr.Dataset:
        """Load a file that must belong to this comparison."""
        try:
            ds = load_results(path)
        except InputError as error:
            raise InputError(f"{error}; or delete it, and {RESUME}") from error
        self._require_own(path, ds)
        return ds

    def _require_own(self, path: Path, ds: xr.Dataset) -> None:
        if difference := self._difference(ds):
            raise InputError(
                f"{path}: cannot be resumed, it differs in {difference}; use the same settings, "
                "another output folder, or start anew without resume"
            )

    def _difference(self, ds: xr.Dataset) -> str:
        return dataset.different_settings(ds, xr.Dataset(attrs=self.attributes))


def stored_scenarios(folder: Path) -> dict[str, Scenario]:
    """The scenarios of what is kept in a folder, by name; none where nothing can be read."""
    found: dict[str, Scenario] = {}
    for text in _stored_files(folder):
        files = json.loads(text)
        found = {name: Scenario.from_toml(toml) for name, toml in files.items()} | found
    return found


def _stored_files(folder: Path) -> Iterator[str]:
    if (folder / MANIFEST).exists():
        with suppress(InputError):
            yield read_manifest(folder / MANIFEST).attributes.get("scenario_files", "{}")
        return
    for path in [*sorted((folder / PARTS).glob("[!.]*.nc")), folder / FILE]:
        with suppress(InputError):
            yield load_results(path).attrs.get("scenario_files", "{}")


def _holds(whole: xr.Dataset, part: xr.Dataset) -> bool:
    """Whether a comparison was completed with this chunk, its removal alone being interrupted."""
    labels = {dim: part[dim] for dim in dataset.RUN}
    return bool(whole["fitness"].reindex(labels).notnull().all())
