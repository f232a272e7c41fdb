"""Everything that is written about a comparison: tables and figures in one folder."""

import json
import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from jaxsusp._files import write_text
from jaxsusp.errors import ScenarioError
from jaxsusp.report.comparison import figures, statistics, tables
from jaxsusp.report.drawing import scene as scene3d
from jaxsusp.report.drawing.style import save
from jaxsusp.report.render import to_csv, to_markdown
from jaxsusp.scenario.scenario import Scenario

TABLES: dict[str, Callable[[xr.Dataset], pd.DataFrame]] = {
    "comparison": tables.comparison_table,
    "ratios": tables.ratio_table,
    "stability": tables.stability_table,
    "pairwise": statistics.pairwise,
    "medians": statistics.medians,
    "ranks": statistics.mean_ranks,
}

PRINTED = ("comparison", "ratios", "stability")
"""Tables that the command line prints; the others are only written."""


def build_tables(ds: xr.Dataset) -> dict[str, pd.DataFrame]:
    """All tables that this comparison has something to say in."""
    built = {name: build(ds) for name, build in TABLES.items()}
    if not tables.has_ratios(built["ratios"]):
        del built["ratios"]
    return {name: frame for name, frame in built.items() if not frame.empty}


def write_report(
    ds: xr.Dataset,
    folder: str | os.PathLike[str],
    told: Callable[[str], None] = lambda message: None,
) -> list[Path]:
    """Write all tables (CSV, Markdown) and figures (PNG) of a comparison.

    Args:
        ds: a whole comparison; its scenarios are drawn from the files embedded in it.
        folder: created where missing.
        told: called with a sentence for every picture that cannot be drawn.

    Returns:
        The files written.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, frame in build_tables(ds).items():
        to_csv(frame, folder / f"{name}.csv")
        write_text(folder / f"{name}.md", to_markdown(frame))
        files += [folder / f"{name}.csv", folder / f"{name}.md"]
    for name, draw in (("convergence", figures.convergence), ("fitness", figures.fitness_boxes)):
        save(draw(ds), folder / f"{name}.png")
        files.append(folder / f"{name}.png")
    texts = json.loads(ds.attrs.get("scenario_files", "{}"))
    for name, stem in zip(names := ds["scenario"].values.tolist(), _stems(names), strict=True):
        picture = folder / f"{stem}.png"
        try:
            scenario = Scenario.from_toml(texts[name], f"{name}.toml")
        except KeyError:
            told(f"{picture.name} is not drawn: the dataset does not hold scenario {name!r}")
        except ScenarioError as error:  # the mesh it names has gone
            told(f"{picture.name} is not drawn: {error}")
        else:
            save(scene3d.scene(scenario, ds.sel(scenario=name)), picture)
            files.append(picture)
    return files


def _stems(names: Sequence[str]) -> list[str]:
    """File names of pictures: the scenarios' own as far as they are plain and not taken."""
    taken, stems = {"convergence", "fitness"}, []
    for name in names:
        plain = re.sub(r"[^\w.-]+", "-", name).strip("-.")[:60] or "scenario"
        candidates = (plain, *(f"{plain}-{number}" for number in range(2, len(names) + 4)))
        stems.append(next(stem for stem in candidates if stem.casefold() not in taken))
        taken.add(stems[-1].casefold())  # some file systems do not tell upper from lower case
    return stems


def as_records(ds: xr.Dataset) -> dict[str, list[dict]]:
    """The tables as plain numbers for machines; NaN and infinity become None."""

    def plain(value):
        if isinstance(value, np.generic):
            value = value.item()
        return None if isinstance(value, float) and not np.isfinite(value) else value

    return {
        name: [
            {key: plain(value) for key, value in row.items()} for row in frame.to_dict("records")
        ]
        for name, frame in build_tables(ds).items()
    }
