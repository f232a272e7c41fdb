"""Pictures of what makes a task hard, and the numbers by level that they show."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from jaxsusp.report.comparison.logistic import fitted, resampled
from jaxsusp.report.drawing.style import (
    INK,
    Style,
    line_sample,
    log_axis,
    picture,
    quiet,
    styles,
)

LEVEL = ["obstacles", "robots", "narrowest", "widest"]


def levels(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """A row per level: runs that end clear, what one takes, plans, times."""
    rows = []
    for level, part in frame.groupby(LEVEL, sort=True):
        row = dict(zip(LEVEL, level, strict=True))
        row |= {"scenes": len(part), "width": part["width"].median()}
        for name in names:
            clear = int(part[f"{name}_clear"].sum())
            row |= {
                f"{name}_clear": clear,
                f"{name}_runs": int(part[f"{name}_runs"].sum()),
                f"{name}_ert": part[f"{name}_spent"].sum() / clear if clear else np.inf,
            }
        tried = part[part["feasible"].notna()]
        row |= {
            "feasible": int((tried["feasible"] == True).sum()),  # noqa: E712
            "tried": len(tried),
            "below_taut": 100 * (1 - tried["fitness"] / tried["taut"]).median(),
            "seconds_space": tried["seconds_space"].median(),
            "seconds_plan": tried["seconds_plan"].median(),
        }
        rows.append(row)
    return pd.DataFrame(rows)


def sweeps(frame: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The scenes of every sweep, those of the base in all of them."""
    base = dict(zip(LEVEL, frame.attrs["settings"]["base"], strict=True))
    same = {name: frame[name] == base[name] for name in LEVEL}
    return {
        "obstacles": frame[same["robots"] & same["narrowest"]],
        "robots": frame[same["obstacles"] & same["narrowest"]],
        "width": frame[same["obstacles"] & same["robots"]],
    }


def by_width(part: pd.DataFrame, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Doublings of the width, clear runs and all runs of every scene."""
    clear, runs = (part[f"{name}_{each}"].to_numpy(float) for each in ("clear", "runs"))
    return np.log2(part["width"].to_numpy())[:, None], clear, runs


_AXES = {"obstacles": "obstacles", "robots": "robots", "width": "narrowest passage (m)"}


_DASHES = ("-", "--", ":")


def clear_figure(frame: pd.DataFrame, names: list[str]) -> Figure:
    """Share of clear runs by obstacles, robots and width."""
    figure, look = picture(7.09, 2.7), styles(names)
    panels = figure.subplots(1, 3, sharey=True)
    for axes, (what, part) in zip(panels, sweeps(frame).items(), strict=True):
        quiet(axes)
        axes.tick_params(labelsize=7.5)
        axes.set_xlabel(_AXES[what], fontsize=8)
        if what != "robots":
            axes.set_xscale("log")
        for number, name in enumerate(names):
            shift = 1.03 ** (2 * number - len(names) + 1) if what != "robots" else 1
            move = 0.06 * (2 * number - len(names) + 1) if what == "robots" else 0
            share = 100 * part[f"{name}_clear"] / part[f"{name}_runs"]
            style, x = look[name], part[what] * shift + move
            axes.plot(x, share, style.marker, color=style.color, ms=2.6, alpha=0.55, mew=0)
            if what == "width":
                _curve(axes, part, name, style._replace(dash=_DASHES[number % len(_DASHES)]))
            else:
                _pooled(axes, part, what, name, style, shift, move)
        _plain_ticks(axes, part, what)
    panels[0].set_ylim(-4, 104)
    panels[0].set_ylabel("runs that end clear (%)", fontsize=8)
    _legend(figure, look)
    figure.set_label(
        "Runs that end clear by the number of obstacles, of robots, and the width of the narrowest "
        "passage; small marks are scenes, large ones levels with the range of their "
        "scenes; on the right logistic curves with 95 % bands from drawing scenes anew."
    )
    return figure


def _pooled(
    axes: Axes, part: pd.DataFrame, what: str, name: str, style: Style, shift, move
) -> None:
    """Levels with the range of their scenes: runs on one scene are no independent draws."""
    sums = part.groupby(what)[[f"{name}_clear", f"{name}_runs"]].sum()
    shares = 100 * (sums[f"{name}_clear"] / sums[f"{name}_runs"]).to_numpy()
    by_scene = (100 * part[f"{name}_clear"] / part[f"{name}_runs"]).groupby(part[what])
    errors = np.abs(by_scene.agg(["min", "max"]).to_numpy().T - shares)
    axes.errorbar(
        sums.index.to_numpy() * shift + move, shares, yerr=errors, fmt=style.marker, ls=style.dash,
        ms=5, lw=1, color=style.color, elinewidth=1,
    )  # fmt: skip


def _curve(axes: Axes, part: pd.DataFrame, name: str, style: Style) -> None:
    """The logistic curve by width alone, with its band."""
    data = by_width(part, name)
    grid = np.geomspace(part["width"].min(), part["width"].max(), 80)
    rows = np.log2(grid)[:, None]
    shares = [100 * curve.share(rows) for curve in resampled(*data, resamples=400)]
    low, high = np.quantile(shares, [0.025, 0.975], axis=0)
    axes.fill_between(grid, low, high, color=style.color, alpha=0.15, lw=0)
    axes.plot(grid, 100 * fitted(*data).share(rows), style.dash, color=style.color, lw=1.4)


def cost_figure(frame: pd.DataFrame, names: list[str]) -> Figure:
    """What a clear run and a plan cost."""
    figure, look = picture(7.09, 2.7), styles(names)
    table = levels(frame, names)
    panels, parts = figure.subplots(1, 3), sweeps(table.assign().pipe(_with_settings, frame))
    for axes, what in zip(panels, ("obstacles", "width", "obstacles"), strict=True):
        quiet(axes)
        axes.tick_params(labelsize=7.5)
        axes.set_xlabel(_AXES[what], fontsize=8)
        axes.set_xscale("log")
        axes.set_yscale("log")
        _plain_ticks(axes, parts[what], what)
    for axes, what in zip(panels[:2], ("obstacles", "width"), strict=True):
        part = parts[what].sort_values(what)
        for name in names:
            style, ert = look[name], part[f"{name}_ert"].to_numpy()
            axes.plot(
                part[what], np.where(np.isfinite(ert), ert, np.nan), style.marker + style.dash,
                color=style.color, ms=5, lw=1,
            )  # fmt: skip
            for x in part[what][~np.isfinite(ert)]:
                low, high = axes.get_xlim()  # of the finite ones: a sign beyond takes all the room
                axes.set_xlim(min(low, x / 1.1), max(high, 1.1 * x))
                axes.annotate(
                    "∞", (x, 1), xycoords=("data", "axes fraction"), color=style.color,
                    fontsize=9, ha="center", va="top",
                )  # fmt: skip
        axes.set_ylabel("evaluations to a clear run", fontsize=8)
        log_axis(axes.yaxis)
    part = parts["obstacles"].dropna(subset=["seconds_plan"]).sort_values("obstacles")
    for column, said, marker, dash in (
        ("seconds_space", "map the free space", "s", "--"),
        ("seconds_plan", "plan", "o", "-"),
    ):
        panels[2].plot(
            part["obstacles"], part[column], marker + dash, color=INK, ms=4, lw=1, label=said
        )
    panels[2].set_ylabel("time (s)", fontsize=8)
    panels[2].legend(
        frameon=False, fontsize=7.5, loc="lower right", bbox_to_anchor=(1.03, 1), ncols=2,
        borderpad=0, handlelength=1.6, columnspacing=1,
    )  # fmt: skip
    if len(part):
        log_axis(panels[2].yaxis)
    _legend(figure, look)
    costs = table[[f"{name}_ert" for name in names]].to_numpy()
    never = "" if np.isfinite(costs).all() else "; ∞: no run ends clear"
    figure.set_label(
        "Left and middle: expected fitness evaluations until a first clear trajectory, by "
        "obstacles and by the width of the narrowest passage (median of a level)"
        f"{never}. Right: seconds to map the free space and to plan in it, on a busy machine."
    )
    return figure


def _with_settings(table: pd.DataFrame, frame: pd.DataFrame) -> pd.DataFrame:
    table.attrs["settings"] = frame.attrs["settings"]
    return table


def _plain_ticks(axes: Axes, part: pd.DataFrame, what: str) -> None:
    """The levels themselves; of widths, round numbers."""
    at = [0.03, 0.1, 0.2, 0.4, 0.8] if what == "width" else sorted(part[what].unique())
    axes.set_xticks(at, [f"{value:g}" for value in at])
    axes.minorticks_off()


def _legend(figure: Figure, look: dict[str, Style]) -> None:
    figure.legend(
        handles=[line_sample(style) for style in look.values()], loc="outside upper center",
        ncols=len(look), frameon=False, fontsize=7.5,
    )  # fmt: skip
