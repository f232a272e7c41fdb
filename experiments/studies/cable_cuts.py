"""How deep runs cut that a check calls clear: words, tables and picture."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

import jaxsusp as js
from experiments.words import between
from jaxsusp.report.drawing.style import INK, label, picture, quiet, styles
from jaxsusp.report.render import Column

INSTANTS = 50
"""Per segment of a trajectory, at which runs are judged: 1951 of 40 samples."""

TOUCH = 1e-4
"""m; deeper is a cut. Float64 and the step between two instants make less of what only touches."""


def share_of_clear(cutting: xr.DataArray, clear: xr.DataArray) -> tuple[float, float]:
    """95 % interval of the share of clear runs that cut: whole scenarios are drawn anew.

    Runs on one scenario meet the same obstacle, so they are no independent draws.

    Args:
        cutting: such runs by scenario.
        clear: clear runs by scenario.
    """
    random, count = np.random.default_rng(0), clear.sizes["scenario"]
    picks = random.integers(count, size=(2000, count))
    found = cutting.values[picks].sum(axis=1) / np.maximum(clear.values[picks].sum(axis=1), 1)
    low, high = np.quantile(found, [0.025, 0.975])
    return float(low), float(high)


def cut(ds: xr.Dataset) -> xr.DataArray:
    """How deep load or cables are in an obstacle (m); NaN of runs that are not clear."""
    return np.maximum(ds["load_depth"], ds["cable_depth"]).where(ds["clear"])


_ALL = ("scenario", "run")


def metres(value: float) -> str:
    """To the millimetre."""
    return f"{value:.3f}" if np.isfinite(value) else "–"


def checks_table(ds: xr.Dataset) -> pd.DataFrame:
    """Runs that the check of their search calls clear, and what is true of them."""
    depth = cut(ds)
    counts = xr.Dataset(
        {
            "clear": ds["clear"].sum(_ALL),
            "runs": xr.full_like(ds["clear"], 1, int).sum(_ALL),
            "refuted": (ds["clear"] & (ds["swept"] > 0)).sum(_ALL),
            "touching": (depth > TOUCH).sum(_ALL),
            "deepest": depth.where(depth > TOUCH).max(_ALL),
            "warned": ds["warning_depth"].where(ds["clear"]).clip(min=0).max(_ALL),
        }
    )
    frame = counts.to_dataframe(["search", "contacts", "algorithm"]).reset_index()
    frame = frame[["search", "contacts", "algorithm", *counts]]
    frame.attrs["title"] = "Clear by the check, and in truth"
    frame.attrs["columns"] = {
        "search": Column("waypoints in"),
        "contacts": Column("check", {"sampled": "at 40 samples", "swept": "sound"}.__getitem__),
        "refuted": Column("of these refuted by the sound check"),
        "touching": Column("of these cutting an obstacle"),
        "deepest": Column("deepest cut (m)", metres),
        "warned": Column("deepest in a warning area (m)", metres),
    }
    frame.loc[frame["touching"] == 0, "deepest"] = 0.0
    frame.attrs["caption"] = (
        f"Clear: no collision and no violated limit by the check that the search itself used. "
        f"Judged on the Makima curve itself, at {INSTANTS} instants per segment: a cut is how far "
        "load or cable would have to go to get out of an obstacle; the warning area is wider by ϑ "
        "and the sound check vouches for the polyline, from which the curve departs by millimetres."
    )
    return frame


def winners_table(ds: xr.Dataset) -> pd.DataFrame:
    """The best clear run of every algorithm, scenario by scenario, as a finished plan."""
    there, rows = ds["proved"].notnull(), []
    best = ds["fitness"].where(ds["clear"]).min("run")
    for search in ds["search"].values.tolist():
        for scenario in ds["scenario"].values.tolist():
            row = {"search": search, "scenario": scenario}
            for contacts in ("sampled", "swept"):
                at = {"search": search, "scenario": scenario, "contacts": contacts}
                row[f"{contacts}_proved"] = int((ds["proved"].sel(at) == 1).sum())
                row[f"{contacts}_there"] = int(there.sel(at).sum())
                row[f"{contacts}_slack"] = float(ds["slack"].sel(at).min())
                row[f"{contacts}_best"] = float(best.sel(at).min())
            rows.append(row)
    frame = pd.DataFrame(rows)
    frame.attrs["title"] = "Winners, certified in continuous time"
    frame.attrs["group"] = ["search"] if ds.sizes["search"] > 1 else []
    columns = {"search": Column("waypoints in")}
    for contacts, said in (("sampled", "at 40 samples"), ("swept", "sound")):
        columns |= {
            f"{contacts}_proved": Column(f"{said}: proved", out_of=f"{contacts}_there"),
            f"{contacts}_slack": Column(f"{said}: least slack (m)", metres),
            f"{contacts}_best": Column(f"{said}: best fitness"),
        }
    frame.attrs["columns"] = columns
    frame.attrs["caption"] = (
        "Winners: the best clear run of every algorithm that has one. Proved: load and cables of "
        "the smooth plan through its waypoints keep ϑ from every obstacle at every instant. Slack: "
        "how much more than ϑ the worst of them keeps; below −ϑ it is in an obstacle."
    )
    return frame


def depths(ds: xr.Dataset) -> Figure:
    """Per rule of search: shares of clear runs, and how deep those of the paper's check cut."""
    names, searches = ds["algorithm"].values.tolist(), ds["search"].values.tolist()
    figure = picture(7.09, 0.6 + 1.85 * len(searches))
    known = styles([*js.ALGORITHMS])  # strangers look as on other pages
    look = {name: known.get(name) or styles([name])[name] for name in names}
    grid = figure.subplots(len(searches), 2, squeeze=False, width_ratios=[1, 1.25])
    places = np.arange(len(names))[::-1]
    for (shares, strips), search in zip(grid, searches, strict=True):
        for axes in (shares, strips):
            quiet(axes)
            axes.tick_params(labelsize=7.5)
            axes.set_yticks(places, [look[name].label for name in names])
            axes.set_ylim(-0.6, len(names) - 0.4)
        strips.set_yticklabels([])
        _shares(shares, ds.sel(search=search), places)
        _strips(strips, cut(ds.sel(search=search, contacts="sampled")), places, look)
        shares.set_title(f"waypoints in {WHERE[search]}", fontsize=8, loc="left", color=INK)
    grid[-1, 0].set_xlabel("share of runs (%)", fontsize=8)
    grid[-1, 1].set_xlabel(
        "cut into an obstacle by runs that the check calls clear (m)", fontsize=8
    )
    handles = [Patch(fc=fc, ec=INK, lw=0.6, hatch=hatch, label=said) for said, fc, hatch in _KINDS]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=7.5)
    figure.set_label(
        "Left: runs that end clear by the paper's check at 40 samples, those of them that touch no "
        "obstacle, and runs that end clear by the sound check. Right: how deep load or cables of "
        "runs that the paper's check calls clear are in an obstacle, each run a mark, their "
        "number beside it; marks on the left edge touch nothing."
    )
    return figure


_KINDS = (
    ("clear at 40 samples", "white", ""),
    ("… and touching nothing", "#6B6B6B", ""),
    ("clear by the sound check", "#C9C9C9", "////"),
)


def _shares(axes: Axes, ds: xr.Dataset, places: np.ndarray) -> None:
    """Bars of the three kinds, by algorithm."""
    sampled, swept = (ds.sel(contacts=each) for each in ("sampled", "swept"))
    runs = ds.sizes["scenario"] * ds.sizes["run"]
    counts = (
        sampled["clear"].sum(_ALL),
        (cut(sampled) <= TOUCH).sum(_ALL),
        swept["clear"].sum(_ALL),
    )
    for (_, color, hatch), count, up in zip(_KINDS, counts, (0.17, 0.17, -0.2), strict=True):
        axes.barh(
            places + up, 100 * count.values / runs, 0.34, fc=color, ec=INK, lw=0.6, hatch=hatch
        )
    axes.set_xlim(0, 100)


def _strips(axes: Axes, depth: xr.DataArray, places: np.ndarray, look) -> None:
    """A mark per run, a little apart from one another."""
    for name, place in zip(depth["algorithm"].values.tolist(), places, strict=True):
        values = depth.sel(algorithm=name).values.ravel()
        values = np.sort(values[np.isfinite(values)]).clip(min=0)
        apart = place + 0.6 * ((np.arange(len(values)) * 0.618) % 1 - 0.5)
        style = look[name]
        axes.plot(
            values,
            apart,
            style.marker,
            color=style.color,
            ms=5 if style.marker in "*hX" else 3.5,  # of about one area
            mec="white",
            mew=0.3,
            clip_on=False,
        )
        cutting = int((values > TOUCH).sum())
        axes.annotate(
            f"{cutting} of {len(values)}", (1, place), xycoords=("axes fraction", "data"),
            fontsize=7.5, ha="right", va="center", color=INK,
        )  # fmt: skip
    axes.set_xlim(0, max(0.05, 1.25 * float(np.nanmax(depth.values, initial=0))))


def findings(ds: xr.Dataset) -> str:
    """What the check at samples misses, what it costs, and what remains of the sound one."""
    depth = cut(ds)
    said = []
    for search in ds["search"].values.tolist():
        at = {"search": search, "contacts": "sampled"}
        clear, deep = int(ds["clear"].sel(at).sum()), depth.sel(at)
        cutting = int((deep > TOUCH).sum())
        rest = [each for each in deep.dims if each != "scenario"]
        low, high = share_of_clear((deep > TOUCH).sum(rest), ds["clear"].sel(at).sum(rest))
        text = (
            f"With waypoints kept in {WHERE[search]}, the check at 40 samples calls {clear} of "
            f"{deep.size} runs clear; {cutting} of these ({100 * cutting / max(clear, 1):.0f} %, "
            f"95 % interval {100 * low:.0f} to {100 * high:.0f} % over scenarios) pass load or "
            "cable through an obstacle between two samples"
        )
        if cutting:
            cables = int(((ds["cable_depth"].sel(at) > TOUCH) & ds["clear"].sel(at)).sum())
            middle = float(deep.where(deep > TOUCH).median())
            worst = deep.where(deep > TOUCH).max(_ALL)
            text += (
                f", {cables} of them a cable, {middle:.3f} m deep in the median and "
                f"{float(worst.max()):.3f} m at most, by {label(worst.idxmax('algorithm').item())}"
            )
            share = 100 * (deep > TOUCH).sum(_ALL) / ds["clear"].sel(at).sum(_ALL)
            few, many = share.idxmin("algorithm").item(), share.idxmax("algorithm").item()
            text += (
                f"; from {float(share.min()):.0f} % of the clear runs of {label(few)} to "
                f"{float(share.max()):.0f} % of those of {label(many)}"
            )
        said.append(text + ".")
        there, proved = ds["proved"].sel(at).notnull(), ds["proved"].sel(at) == 1
        refuted = int((ds["clear"] & (ds["swept"] > 0)).sel(at).sum())
        said.append(
            f"The sound check refutes {refuted} of them, for it keeps the warning distance at "
            f"every instant. Of {int(there.sum())} winners, the best clear run of every algorithm "
            f"in every scenario, {int(proved.sum())} are proved to keep it in continuous time."
        )
    sound = ds.sel(contacts="swept")
    touching, clear = int((cut(sound) > TOUCH).sum()), int(sound["clear"].sum())
    entered = 1e3 * float(sound["warning_depth"].where(sound["clear"], 0).clip(min=0).max())
    proved, there = int((sound["proved"] == 1).sum()), int(sound["proved"].notnull().sum())
    said.append(
        f"Of the {clear} runs that the sound check calls clear "
        f"{f'{touching} touch' if touching else 'none touches'} an obstacle; their curves enter a "
        f"warning area by at most {entered:.1f} mm, as they depart from the polyline that the "
        f"check vouches for, and {proved} of {there} winners are proved."
    )
    best = ds["fitness"].where(ds["clear"]).min(("algorithm", "run"))
    cheaper = 100 * (1 - best.sel(contacts="sampled") / best.sel(contacts="swept"))
    if cheaper.notnull().any():
        said.append(
            "The best clear fitness by the check at samples is below that by the sound one by "
            f"{float(cheaper.median()):.1f} % in the median over scenarios, in a range of "
            f"{between(float(cheaper.min()), float(cheaper.max()))} %."
        )
    return " ".join(said)


WHERE = {
    "box": "the workspace alone",
    "free-space": "the free space of load and cables",
    "ellipsoid": "its ellipsoids",
}
