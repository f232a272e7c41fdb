"""The tables of a comparison: ours in the paper's columns, our ratios beside the paper's.

Every function takes the dataset of a comparison and returns a frame of plain numbers; what people
read (title, caption, best values, footnotes) travels in `frame.attrs` to the renderers.
"""

import json

import numpy as np
import pandas as pd
import xarray as xr

from jaxsusp.comparison import dataset
from jaxsusp.report.comparison import gaps, paper
from jaxsusp.report.comparison.statistics import samples_of, vargha_delaney
from jaxsusp.report.render import Cell, Column, Footnote, duration

_SMALLEST_IS_BEST = ("min", "max", "average", "std", "length", "height", "runtime", "gap")
_LARGEST_IS_BEST = ("curvature_radius", "clear")


def summary(ds: xr.Dataset) -> xr.Dataset:
    """The metrics of Table 1 for a comparison, with dims scenario and algorithm.

    Length, height (terms f1, f2) and curvature radius are those of the best run. A batch holds all
    runs of all scenarios, so `runtime` is a run's share of it: `seconds_run` over the number of
    runs in the whole dataset; compilation is not in it.

    Args:
        ds: a whole comparison. A NaN fitness means "no such run", +inf a run that found nothing.

    Returns:
        The variables of `paper.UNITS`, and `obstacles`, `evaluations`, `gap` (mean over the runs,
        in %, NaN where no best fitness is known), `clear` (runs without any collision or violation)
        and `runs`. One run has no standard deviation: NaN.
    """
    fitness = ds["fitness"]
    ran = fitness.notnull()
    best = ds["terms"].isel(run=fitness.fillna(np.inf).argmin("run"))
    with np.errstate(invalid="ignore"):  # the deviation of +inf is NaN, which is what to report
        std = fitness.std("run", ddof=1)
    metrics = {
        "obstacles": ds["obstacles"],
        "min": fitness.min("run"),
        "max": fitness.max("run"),
        "average": fitness.mean("run"),
        "std": std,
        "length": best.sel(term="length", drop=True),
        "height": best.sel(term="height", drop=True),
        "curvature_radius": ds["curvature_radius"],
        "runtime": ds["seconds_run"] / ran.sum(("scenario", "run")),
        "evaluations": ds["evaluations"],
        "gap": gaps.mean_gap(ds),
        "clear": gaps.clear_runs(ds).sum("run"),
        "runs": ran.sum("run"),
    }
    return xr.Dataset(metrics).drop_vars("run", errors="ignore")


def comparison_table(ds: xr.Dataset) -> pd.DataFrame:
    """Our Table 1: one row per scenario and algorithm, the paper's columns and four more.

    Returns:
        Columns scenario, obstacles, algorithm, the paper's metrics (`paper.UNITS`), evaluations
        per run, the mean `gap` above the best known fitness in % (where one is known), and of how
        many runs (`runs`) how many are violation-free (`clear`).
    """
    metrics = summary(ds)
    known = bool(metrics["gap"].notnull().any())
    ours = ["evaluations", *["gap"] * known, "clear", "runs"]
    frame = _flat(metrics, ["scenario", "obstacles", "algorithm", *paper.UNITS, *ours])
    compiled = ", ".join(
        f"{name} {duration(seconds)}" for name, seconds in ds["seconds_compile"].to_series().items()
    )
    frame.attrs["title"] = "Comparison of the algorithms"
    frame.attrs["group"] = ["scenario", "obstacles"]
    frame.attrs["bold"] = _best(metrics)
    frame.attrs["caption"] = (
        "Fitness over all runs (std with n − 1); length, height and median curvature radius of "
        "the best run; evals: fitness evaluations per run; clear: runs without any collision or "
        "violation. One batch holds all runs of all scenarios, so a run time is one run's share of "
        f"its batch. Compilation, once per batch and not included: {compiled}. "
        f"{(gaps.GAP + ' Mean over the runs. ') * known}{_own_units(ds)}{_search(ds)}"
    ).strip()
    return frame


def _own_units(ds: xr.Dataset) -> str:
    """In what units the fitness of each scenario is formed, where they are not m and kg."""
    rows = zip(
        *(ds[name].values.tolist() for name in ("scenario", "unit_length", "unit_mass")),
        strict=True,
    )
    told = [
        f"{name} {length:.4g} m and {mass:.4g} kg" for name, length, mass in rows
        if (length, mass) != (1.0, 1.0)
    ]  # fmt: skip
    if not told:
        return ""
    return (
        "Lengths are in m; the fitness is formed of terms in a task's own units, here of "
        f"{', '.join(told)}. "
    )


def ratio_table(ds: xr.Dataset, to: str = "dbo") -> pd.DataFrame:
    """The paper's ratios of SDBO to another algorithm and ours, one row each per scenario.

    Args:
        ds: a comparison.
        to: the other algorithm, one of the paper's.

    Returns:
        Columns scenario, source ("paper", "ours"), the metrics of `paper.RATIOS`, and a12 (the
        probability that a run of SDBO is better; the paper prints no runs). NaN where the paper has
        no such scenario, or the comparison lacks one of the two.
    """
    printed = paper.table1()
    ours = summary(ds).reindex(algorithm=[to, "sdbo"])
    pair = xr.concat(
        [
            paper.ratios(printed, to=to).reindex(scenario=ds["scenario"].values),
            paper.ratios(ours, to=to).assign(a12=_better(ds, "sdbo", to)),
        ],
        dim=pd.Index(["paper", "ours"], name="source"),
    )
    frame = _flat(pair, ["scenario", "source", *paper.RATIOS, "a12"])
    rows = {s: row for row, s in frame["scenario"].items() if frame.at[row, "source"] == "paper"}
    frame.attrs["title"] = f"SDBO / {to.upper()}, the paper and ours"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["columns"] = {metric: Column(metric) for metric in paper.RATIOS}
    frame.attrs["caption"] = (
        "Below 1, SDBO is better. The paper prints no obstacle coordinates and our scenarios are "
        "our own, so ratios compare and absolute values do not. A₁₂: probability that a run of "
        f"SDBO is better than a run of {to.upper()}, ties counting half; the paper prints no runs."
    )
    frame.attrs["footnotes"] = [
        Footnote(r.text, frozenset((rows[s], metric) for s, metric in r.cells if s in rows))
        for r in paper.remarks(printed, to)
    ]
    return frame


def _better(ds: xr.Dataset, of: str, to: str) -> xr.DataArray:
    """Probability that a run of one algorithm is better than one of another (scenario)."""
    names, there = ds["scenario"].values.tolist(), ds["algorithm"].values.tolist()
    both = of in there and to in there
    runs = [samples_of(ds, name) if both else {} for name in names]
    found = [vargha_delaney(each[of], each[to]) if both else np.nan for each in runs]
    return xr.DataArray(found, {"scenario": names}, "scenario")


def printed_table(scenarios: list[str]) -> pd.DataFrame:
    """The paper's Table 1 as it is printed, with what does not add up in it.

    Args:
        scenarios: those of a comparison; others than the paper's have no rows.

    Returns:
        Columns scenario, obstacles, algorithm and the metrics of `paper.UNITS`.
    """
    printed = paper.table1()
    names = [name for name in printed["scenario"].values.tolist() if name in scenarios]
    printed = printed.sel(scenario=names)
    frame = _flat(printed, ["scenario", "obstacles", "algorithm", *paper.UNITS])
    pairs = zip(frame["scenario"], frame["algorithm"], strict=True)
    rows: dict[tuple[str, ...], int] = {pair: place for place, pair in enumerate(pairs)}
    worst = frozenset((rows[cell], "std") for cell in paper.where(paper.impossible_std(printed)))
    hit = frozenset((rows[cell], "min") for cell in paper.where(paper.colliding_best(printed)))
    frame.attrs["title"] = "Table 1 as it is printed"
    frame.attrs["group"] = ["scenario", "obstacles"]
    frame.attrs["columns"] = {"runtime": Column("run time (s)")}
    frame.attrs["caption"] = "Of the paper's own scenarios, whose obstacles it does not print."
    frame.attrs["footnotes"] = [
        Footnote("No 20 values with this minimum, maximum and mean have this std.", worst),
        Footnote("More than κ = 1000, so that even the best run collides.", hit),
    ]
    frame.attrs["footnotes"] = [note for note in frame.attrs["footnotes"] if note.cells]
    return frame


def has_ratios(frame: pd.DataFrame) -> bool:
    """Whether a `ratio_table` holds a ratio of ours; the paper's alone say nothing about us."""
    ours = frame.loc[frame["source"] == "ours", list(paper.RATIOS)]
    return bool(ours.notna().any(axis=None))


def stability_table(ds: xr.Dataset) -> pd.DataFrame:
    """How often SDBO's stability move (Eq. 19) acted, for the algorithms that have it.

    Returns:
        Columns scenario, algorithm, acted and kept: shares in [0, 1].
    """
    shares = xr.Dataset({name: ds[f"stability_{name}"] for name in ("acted", "kept")})
    if "run" in shares.dims:
        shares = shares.mean("run")
    frame = _flat(shares, ["scenario", "algorithm", "acted", "kept"])
    frame = frame.loc[frame["acted"].notna()].reset_index(drop=True)
    frame.attrs["title"] = "The stability move of SDBO (Eq. 19)"
    frame.attrs["group"] = ["scenario"]
    frame.attrs["caption"] = (
        "Shares of all beetles over all iterations and runs. Acted: at least one waypoint had its "
        "stability factor in the window and was scaled. Kept: the beetle became better by it."
    )
    return frame


def budget(ds: xr.Dataset) -> str:
    """A sentence on what all algorithms got equally much of, "" where the dataset does not tell."""
    settings = json.loads(ds.attrs.get("settings", "{}"))
    rule = settings.get("budget")
    if rule == "iterations":
        return f'Budget: {settings["iterations"]:,} iterations (budget = "iterations").'
    made = ds["iterations"].to_series()
    iterations = ", ".join(f"{name} {count:,}" for name, count in made.items())
    if rule == "evaluations":
        allowed = settings["population"] * (settings["iterations"] + 1)
        return (
            f'Budget: {allowed:,} fitness evaluations (budget = "evaluations"), whole iterations: '
            f"{iterations}."
        )
    if rule == "time":
        return (
            f"Budget: the time that the slowest takes for {settings['iterations']:,} iterations "
            '(budget = "time"), measured on one machine, on which all numbers depend; iterations '
            f"made in it: {iterations}."
        )
    return ""


def processors(ds: xr.Dataset) -> str:
    """A sentence where runs were computed on processors of different kinds, else ""."""
    kinds = dataset.processors(ds)
    if len(kinds) < 2:
        return ""
    return (
        f"Runs were computed on processors of {len(kinds)} kinds ({', '.join(kinds)}), whose "
        "arithmetic rounds differently: other processors give these results in distribution."
    )


def polished(ds: xr.Dataset) -> str:
    """A sentence where every run was polished at the end, else ""."""
    if not json.loads(ds.attrs.get("settings", "{}")).get("polish"):
        return ""
    each = int(ds["evaluations_polish"].max())
    return (
        f"The best of every run was polished at the end, with {each:,} evaluations on top of the "
        "budget (polish = True)."
    )


def _search(ds: xr.Dataset) -> str:
    """A sentence on what waypoints were kept in."""
    search = json.loads(ds.attrs.get("settings", "{}")).get("search")
    kept = {
        "free-space": "in the polytopes of the free space",
        "ellipsoid": "in the ellipsoids of the free space",
        "box": "in the box of the workspace",
    }
    return f'Waypoints were kept {kept[search]} (search = "{search}").' if search in kept else ""


def _flat(ds: xr.Dataset, columns: list[str]) -> pd.DataFrame:
    """One row per cell of the dataset, in its order, scenario by scenario."""
    others = [dim for dim in ds.dims if dim != "scenario"]
    return ds.to_dataframe(["scenario", *others]).reset_index().reindex(columns=columns)


def _best(metrics: xr.Dataset) -> frozenset[Cell]:
    """The cells with the best value of every scenario, ties included.

    An algorithm without one violation-free run competes only where no algorithm has any: a short
    way through an obstacle is not a best length.
    """
    if metrics.sizes["algorithm"] == 1:
        return frozenset()
    clear = metrics["clear"] > 0
    rivals = metrics.where(clear | ~clear.any("algorithm"))
    best = {name: rivals[name] == rivals[name].min("algorithm") for name in _SMALLEST_IS_BEST}
    best |= {name: rivals[name] == rivals[name].max("algorithm") for name in _LARGEST_IS_BEST}
    return frozenset(
        (int(row), name)
        for name, flags in best.items()
        for row in np.flatnonzero(flags.transpose("scenario", "algorithm"))
    )
