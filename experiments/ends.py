"""What many comparisons have in common: how their runs ended, without the way there."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr

import jaxsusp as js
from jaxsusp._files import write_text
from jaxsusp.comparison import dataset
from jaxsusp.comparison.compare import Event

VARIABLES = (
    "fitness", "collisions", "violations", "evaluations", "iterations", "seconds_run", "best_known",
)  # fmt: skip
"""What is kept of a comparison; enough for ranks, gaps and clear runs."""


def ends(parts: Mapping[Any, xr.Dataset], dim: str, settings: Any) -> xr.Dataset:
    """Comparisons beside each other.

    Args:
        parts: comparisons of the same scenarios, algorithms and runs, by label.
        dim: what the labels are of.
        settings: a NamedTuple, what they were made with.
    """
    found = xr.concat(
        [part[[*VARIABLES]] for part in parts.values()], pd.Index([*parts], name=dim),
        data_vars="all", coords="minimal", join="exact", compat="equals", combine_attrs="drop",
    )  # fmt: skip
    return found.assign_attrs({"settings": json.dumps(settings._asdict()), **dataset.provenance()})


def telling(told: Callable[[str], None], what: str) -> Callable[[Event], None]:
    """A progress callback of `jaxsusp.compare`: a line per algorithm."""

    def tell(event: Event) -> None:
        if event.phase in ("compiling", "timing", "free space"):
            share = "" if event.phase != "compiling" else f", {event.done / event.total:.0%} done"
            told(f"  {what}: {event.algorithm}, {event.phase}{share}")

    return tell


def random_scenes(count: int, folder: Path, told: Callable[[str], None]) -> list[js.Scenario]:
    """The first random scenes; those that are drawn are kept in a folder, each at once."""
    folder.mkdir(parents=True, exist_ok=True)
    known = {path.stem: js.load_scenario(path) for path in folder.glob("[!.]*.toml")}
    for number in range(count):
        scene = js.random_scenarios(number + 1, known=known)[-1]
        if scene.name not in known:
            told(f"  drawn: {scene.name}")
            known[scene.name] = scene
            write_text(folder / f"{scene.name}.toml", scene.to_toml())
    return [*js.random_scenarios(count, known=known)]
