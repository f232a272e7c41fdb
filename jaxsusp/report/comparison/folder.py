"""Everything that is written about a comparison: tables and figures in one folder."""

import json
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from jaxsusp._files import write_text
from jaxsusp.errors import ScenarioError
from jaxsusp.report.comparison import (
    across,
    figures,
    gaps,
    runningtime,
    statistics,
    tables,
    targets,
)
from jaxsusp.report.drawing import scene as scene3d
from jaxsusp.report.drawing.style import save
from jaxsusp.report.render import to_csv, to_markdown
from jaxsusp.scenario.scenario import Scenario

TABLES: dict[str, Callable[[xr.Dataset], pd.DataFrame]] = {
    "comparison": tables.comparison_table,
    "ratios": tables.ratio_table,
    "stability": tables.stability_table,
    "gap-summary": gaps.gap_summary,
    "gap": gaps.gap_table,
    "running-times": runningtime.running_time_table,
    "pairwise": statistics.pairwise,
    "medians": statistics.medians,
    "ranks": statistics.mean_ranks,
    "across": across.across_table,
}

MOST_DRAWN = 12
"""Scenarios up to which there is a picture, and a panel of convergence and fitness, of each."""


def printed(ds: xr.Dataset, gap: bool) -> tuple[str, ...]:
    """Tables that the command line prints; the others are only written.

    Args:
        ds: a comparison. Of many scenarios (more than `MOST_DRAWN`) the summary stands for the
            rest.
        gap: whether the distances from the best known fitness were asked for.
    """
    asked = ("gap-summary", "gap") if gap else ()
    if ds.sizes["scenario"] > MOST_DRAWN:
        return asked or ("gap-summary",)
    return ("comparison", "ratios", "stability", *asked)


def build_tables(ds: xr.Dataset) -> dict[str, pd.DataFrame]:
    """All tables that this comparison has something to say in; each names what runs got."""
    built = {name: build(ds) for name, build in TABLES.items()}
    if not tables.has_ratios(built["ratios"]):
        del built["ratios"]
    for frame in built.values():
        said = tables.budget(ds), tables.polished(ds), tables.processors(ds)
        frame.attrs["caption"] = " ".join(filter(None, [frame.attrs["caption"], *said]))
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
        told: called with a sentence for every picture that cannot be drawn, and where there are
            too many scenarios for pictures of each.

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
    for name, figure in figures_of(ds):
        save(figure, folder / f"{name}.png")
        files.append(folder / f"{name}.png")
    taken = {*_FIGURES}
    for name, figure in scenes_of(ds, told):
        files.append(folder / f"{_stem(name, taken)}.png")
        save(figure, files[-1])
    return files


def figures_of(ds: xr.Dataset) -> Iterator[tuple[str, Figure]]:
    """The figures of a whole comparison by their names; of many scenarios those without panels."""
    few = ds.sizes["scenario"] <= MOST_DRAWN
    for name in _FIGURES if few else _OF_MANY:
        figure = _FIGURES[name](ds)
        if figure is not None:
            yield name, figure


def scenes_of(ds: xr.Dataset, told: Callable[[str], None]) -> Iterator[tuple[str, Figure]]:
    """A picture of every scenario with the best trajectories in it, by the scenario's name.

    Args:
        ds: a whole comparison; its scenarios are drawn from the files embedded in it.
        told: called with a sentence for every picture that cannot be drawn, and where there are
            too many scenarios for pictures of each.
    """
    names = ds["scenario"].values.tolist()
    if len(names) > MOST_DRAWN:
        most = f"pictures of each are drawn where there are at most {MOST_DRAWN}"
        told(f"{len(names)} scenarios: {most}")
        return
    texts = json.loads(ds.attrs.get("scenario_files", "{}"))
    for name in names:
        try:
            scenario = Scenario.from_toml(texts[name], f"{name}.toml")
        except KeyError:
            told(f"no picture of {name}: the dataset does not hold this scenario")
        except ScenarioError as error:  # the mesh it names has gone
            told(f"no picture of {name}: {error}")
        else:
            yield name, scene3d.scene(scenario, ds.sel(scenario=name))


_FIGURES: dict[str, Callable[[xr.Dataset], Figure | None]] = {
    "convergence": figures.convergence,
    "fitness": figures.fitness_boxes,
    "ecdf": targets.running_times,
    "critical-difference": across.diagram,
}

_OF_MANY = ("ecdf", "critical-difference")
"""Figures that hold any number of scenarios."""


def _stem(name: str, taken: set[str]) -> str:
    """A picture's file name: the scenario's own as far as it is plain and not taken; takes it."""
    plain = re.sub(r"[^\w.-]+", "-", name).strip("-.")[:60] or "scenario"
    candidates = (plain, *(f"{plain}-{number}" for number in range(2, len(taken) + 3)))
    # Some file systems do not tell upper from lower case.
    stem = next(stem for stem in candidates if stem.casefold() not in taken)
    taken.add(stem.casefold())
    return stem


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
