"""From what a person names to the scenes and tracks of a page."""

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from jaxsusp.comparison.kept.files import load_results
from jaxsusp.errors import InputError, ScenarioError, require
from jaxsusp.freespace.build import free_space, known_free_space
from jaxsusp.freespace.space import FreeSpace, load_free_space
from jaxsusp.planning.loading import load_plan
from jaxsusp.planning.plan import Plan
from jaxsusp.report.browser.packing import as_json
from jaxsusp.report.browser.scenes import same_task, scene_of, scene_of_space
from jaxsusp.report.browser.tracks import plan_track, standing_tracks, way_track
from jaxsusp.report.drawing.style import CYCLE, PALETTE, styles
from jaxsusp.scenario.scenario import Scenario, load_scenario

Shown = str | os.PathLike[str] | Scenario | Plan | FreeSpace | xr.Dataset
"""What a page can show: a name, a file, or what was loaded or computed already."""

COLORS = (PALETTE["sdbo"], PALETTE["pso"], PALETTE["dbo"], PALETTE["ga"], *CYCLE)
"""Of plans beside each other."""

ROOM = 4e6
"""Bytes of tracks up to which further scenarios of a comparison are shown: a page has 6 MB."""


NOT_KNOWN = "nobody has computed them yet; `--regions` does, or `regions=True`"

_OF_RUNS = ("fitness", "collisions", "violations", "position")
"""Variables of a comparison that its ways are shown with."""


class Gathered:
    """Scenes, each once, with the tracks in them, in the order in which they were named.

    Args:
        grow: whether free spaces that nobody has computed yet are computed.
        told: called with a sentence while something takes long.
    """

    def __init__(self, grow: bool = False, told: Callable[[str], None] = lambda _: None):
        self.grow, self.told = grow, told
        self.tracks: list[dict[str, Any]] = []
        self.notes: list[str] = []
        self._scenarios: dict[str, tuple[int, Scenario]] = {}  # by digest
        self._spaces: dict[int, FreeSpace] = {}
        self._size = 0  # of tracks of comparisons, bytes
        self._alone: list[tuple[str, FreeSpace]] = []

    def add(self, what: Shown) -> None:
        """Take one thing in.

        Raises:
            InputError: it is not there, damaged, or nothing that can be shown.
        """
        if not isinstance(what, str | os.PathLike):
            self._take(what)
            return
        try:
            self._take(_loaded(what), _stem(what))
        except InputError:
            raise
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
            raise InputError(
                f"{what}: holds what cannot be shown ({error}); give a file as jaxsusp wrote it"
            ) from error

    def _take(self, what: Any, name: str = "") -> None:
        match what:
            case Plan():
                self._plan(what, name)
            case Scenario():
                self._scene(what)
            case FreeSpace():
                self._space(what, name)
            case xr.Dataset():
                self._comparison(what)
            case _:
                raise InputError(
                    f"{what!r} cannot be shown; give scenarios, plans, comparisons or free spaces"
                )

    def finished(self) -> dict[str, Any]:
        """All of it as the page reads it."""
        scenes = []
        for number, scenario in self._scenarios.values():
            if not any(track["scene"] == number for track in self.tracks):
                new = standing_tracks(scenario)
                self.tracks += [{**track, "scene": number} for track in new]
            scenes.append(scene_of(scenario, self._free_space(number, scenario)))
        scenes += [scene_of_space(name, space) for name, space in self._alone]
        why = " ".join(self.notes) or "name a scenario, a plan or a dataset"
        require(bool(scenes), f"nothing to show: {why}")
        return {"scenes": scenes, "tracks": self.tracks, "notes": self.notes}

    def _scene(self, scenario: Scenario) -> int:
        known = self._scenarios.setdefault(scenario.digest, (len(self._scenarios), scenario))
        return known[0]

    def _plan(self, plan: Plan, name: str) -> None:
        number = self._scene(plan.scenario)
        color = COLORS[len(self.tracks) % len(COLORS)]
        name = name or f"plan {len(self.tracks) + 1}"
        if any(track["name"] == name for track in self.tracks):
            name = f"{name} ({len(self.tracks) + 1})"
        self.tracks.append({**plan_track(plan, name, color), "scene": number})

    def _space(self, space: FreeSpace, name: str) -> None:
        for number, scenario in self._scenarios.values():
            if same_task(space, scenario):
                self._spaces[number] = space
                return
        self._alone.append((name or "free space", space))

    def _free_space(self, number: int, scenario: Scenario) -> FreeSpace | None:
        if number in self._spaces:
            return self._spaces[number]
        if not self.grow:
            known = known_free_space(scenario)
            if known is None:
                self.notes.append(f"No free regions of {scenario.name}: {NOT_KNOWN}.")
            return known
        self.told(f"Free space of {scenario.name} …")
        try:
            return free_space(scenario)
        except InputError as error:
            self.notes.append(f"No free regions of {scenario.name}: {error}")
            return None

    def _comparison(self, ds: xr.Dataset) -> None:
        """The best run of every algorithm on every scenario."""
        runs = int(ds.sizes["run"])
        require(runs > 0, "the comparison has no run; give one that has")
        self.notes.append(f"Of every algorithm the best of {runs} runs, with the ends as given.")
        names = ds["scenario"].values.tolist()
        texts = json.loads(ds.attrs.get("scenario_files", "{}"))
        for i, name in enumerate(names):
            if self._size > ROOM:
                left = len(names) - i
                self.notes.append(f"The last {left} of {len(names)} scenarios are not shown.")
                break
            try:
                scenario = Scenario.from_toml(texts[name], f"{name}.toml")
            except KeyError:
                self.notes.append(f"{name} is not shown: the dataset does not hold this scenario.")
                continue
            except ScenarioError as error:  # the mesh it names has gone
                self.notes.append(f"{name} is not shown: {error}")
                continue
            self.told(f"Motion of {name} …")
            self._runs(ds.sel(scenario=name), scenario)

    def _runs(self, ds: xr.Dataset, scenario: Scenario) -> None:
        number = self._scene(scenario)
        if missing := [name for name in _OF_RUNS if name not in ds]:
            self.notes.append(f"No runs on {scenario.name}: the dataset has no {missing[0]}.")
            return
        run = ds["fitness"].fillna(np.inf).argmin("run")
        best = ds[["fitness", "collisions", "violations"]].isel(run=run)
        for name, style in styles(ds["algorithm"].values.tolist()).items():
            way = ds["position"].sel(algorithm=name).transpose("sample", "axis").values
            if not np.isfinite(way).all():
                self.notes.append(f"{scenario.name}: no run of {style.label} is there to show.")
                continue
            values = (best[key].sel(algorithm=name).item() for key in best)
            fitness, collisions, violations = values
            reasons = _broken(int(collisions), int(violations))
            verdict = "violates limits" if reasons else "clear"
            title = f"{style.label}, fitness {fitness:.1f}"
            track = way_track(scenario, way, title, style.color, verdict, reasons)
            self._size += len(as_json(track))
            self.tracks.append({**track, "scene": number})


def _broken(collisions: int, violations: int) -> list[str]:
    """What the fitness counted against a run."""
    counted = ((collisions, "contact"), (violations, "violated limit"))
    return [
        f"The fitness counts {count} {what}{'s' * (count > 1)} at its samples."
        for count, what in counted
        if count
    ]


def _loaded(what: str | os.PathLike[str]) -> Plan | Scenario | FreeSpace | xr.Dataset:
    path = Path(what)
    match path.suffix.lower():
        case ".json":
            return load_plan(path)
        case ".nc":
            return _dataset(path)
    return load_scenario(what, task_checked=False)


def _dataset(path: Path) -> FreeSpace | xr.Dataset:
    """A comparison or a free space, which have no variable in common."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            is_space = "adjacency" in file
    except OSError:
        is_space = False  # what is wrong is told in the words of a comparison
    return load_free_space(path) if is_space else load_results(path)


def _stem(what: str | os.PathLike[str]) -> str:
    return Path(what).name.removesuffix(".json").removesuffix(".nc").removesuffix(".plan")


def gathered(
    what: Sequence[Shown], grow: bool = False, told: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """Everything that is named, as the page reads it; scenarios before free spaces of theirs.

    Raises:
        InputError: something is not there, damaged, or nothing that can be shown.
    """
    found = Gathered(grow, told)
    for each in what:
        found.add(each)
    return found.finished()
