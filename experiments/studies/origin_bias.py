"""What moving tasks and functions changes, as tables, picture and words."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from experiments.changes import Change, fitness_change, found_nothing
from experiments.words import between, bulleted, listed, signed
from jaxsusp.report.comparison.gaps import clear_runs
from jaxsusp.report.drawing.style import (
    INK,
    QUIET,
    label,
    legend,
    line_sample,
    panels,
    picture,
    styles,
)
from jaxsusp.report.render import Column, significant
from jaxsusp.studies.classical import CASES
from jaxsusp.studies.resampling import crossed_interval, mean_of

FLOOR = 1e-16
"""Errors below count as this."""

ALIKE = 1e-6
"""Relative difference of two fitness values of one and the same run."""

LEAST = 0.05
"""Changes below, in per cent or decades, are none."""

WORLD = ("dbo", "sdbo")

Changes = dict[tuple[str, float], Change]
"""Of the fitness of an algorithm against tasks where they are, by distance (m)."""


def changes_of(tasks: xr.Dataset) -> Changes:
    """What every distance changes for every algorithm."""
    there, *away = tasks["distance"].values.tolist()
    return {
        (name, distance): fitness_change(
            tasks.sel(algorithm=name, distance=there), tasks.sel(algorithm=name, distance=distance)
        )
        for name in tasks["algorithm"].values.tolist()
        for distance in away
    }


def alike(tasks: xr.Dataset) -> dict[str, float]:
    """Share of runs that end with the same fitness wherever their task is moved to.

    Tasks that are moved have numbers rounded to 1e-7 of a unit, the same for every distance; tasks
    where they are have not, so they are not counted here.
    """
    fitness = tasks["fitness"].isel(distance=slice(1, None))
    spread = fitness.max("distance") / fitness.min("distance") - 1
    return (spread < ALIKE).mean(("scenario", "run")).to_series().to_dict()


def decades(functions: xr.Dataset) -> xr.DataArray:
    """Decimal logarithm of the error of every run."""
    there = functions["fitness"].where(np.isfinite(functions["fitness"]))
    return np.log10(np.maximum(there, FLOOR))


def lost(functions: xr.Dataset, name: str, one: str, other: str) -> Change:
    """Decades of the error that an algorithm loses from one case to another."""
    error = decades(functions).sel(algorithm=name).transpose("case", "function", "run")
    by_run = (error.sel(case=other) - error.sel(case=one)).values
    return Change(mean_of(by_run), *crossed_interval(by_run, scenes_vary=False).tolist())


def figure(changes: Changes, functions: xr.Dataset) -> Figure:
    """Tasks on the left, functions on the right, a line per algorithm."""
    names = functions["algorithm"].values.tolist()
    distances = sorted({distance for _, distance in changes})
    look = styles(names)
    drawing = picture(7.09, 3.6)
    left, right = panels(drawing, 2)
    left.axhline(0, color=QUIET, lw=1)
    error = decades(functions).mean(("function", "run"))
    for place, name in enumerate(names):
        style = look[name]
        aside = 0.05 * (place - (len(names) - 1) / 2)
        line = {"color": style.color, "ls": style.dash, "marker": style.marker}
        x = np.arange(len(distances) + 1) + aside
        found = np.array([Change(0, 0, 0), *(changes[name, each] for each in distances)])
        left.plot(x, found[:, 0], lw=1.2, markersize=4.5, **line)
        left.vlines(x, found[:, 1], found[:, 2], color=style.color, lw=1)
        middle = error.sel(algorithm=name, case=[*CASES]).values
        right.plot(range(len(CASES)), middle, lw=1.2, markersize=4.5, **line)
    left.set_xticks(range(len(distances) + 1), ["0", *(f"{each:g}" for each in distances)])
    left.set_xlabel("distance from where the task is (m)", fontsize=8.0)
    left.set_ylabel("change of fitness (%)", fontsize=8.0)
    right.set_xticks(range(len(CASES)), [*CASES])
    right.set_ylabel("error, mean decade", fontsize=8.0)
    right.yaxis.set_major_formatter(lambda value, _: f"$10^{{{value:.0f}}}$")
    right.set_xlabel("classical functions", fontsize=8.0)
    for panel, title in ((left, "tasks"), (right, "functions")):
        panel.tick_params(labelsize=8.0)
        panel.set_title(title, loc="left", fontsize=9, color=INK)
    legend(drawing, [line_sample(style) for style in look.values()], size=8.0, columns=5)
    drawing.set_label(
        "Left: change of the geometric mean of the fitness where the tasks lie elsewhere, with "
        "95 % intervals. Right: geometric mean of the errors in the classical functions as they "
        "are printed, moved together with their bounds, with the optimum shifted within the "
        "bounds, and turned as well; errors below 10⁻¹⁶ count as that."
    )
    return drawing


def task_table(tasks: xr.Dataset, changes: Changes) -> pd.DataFrame:
    """A row per algorithm and distance."""
    same, clear = alike(tasks), clear_runs(tasks)
    rows = []
    for (name, distance), change in changes.items():
        there = clear.sel(algorithm=name)
        rows.append(
            {
                "algorithm": name,
                "distance": distance,
                "fitness": change.middle,
                "low": change.low,
                "high": change.high,
                "clear": int(there.sel(distance=distance).sum()),
                "clear_here": int(there.isel(distance=0).sum()),
                "runs": int(there.isel(distance=0).size),
                "alike": same[name],
            }
        )
    frame = pd.DataFrame(rows)

    def shown(change: float) -> str:
        return signed(change) if abs(change) >= LEAST else "0"

    frame.attrs["title"] = "Tasks that are moved"
    frame.attrs["columns"] = {
        "distance": Column("distance (m)", "{:g}".format),
        "fitness": Column("fitness (%)", shown),
        "low": Column("from", shown),
        "high": Column("to", shown),
        "clear_here": Column("clear at 0 m", out_of="runs"),
        "alike": Column("alike (%)", lambda share: f"{100 * share:.0f}"),
    }
    frame.attrs["caption"] = (
        f"Waypoints anywhere in the box, {int(tasks['iterations'][0, 0])} iterations. Change of "
        "the geometric mean of the fitness against the same tasks where they are, with the 95 % "
        f"interval of a bootstrap over the {tasks.sizes['run']} runs of every scenario; clear "
        "runs; and the share of runs that end with the same fitness (to a millionth) at all "
        "distances above 0. In the task's frame the middle of all moves is computed from the "
        "origin in float32: runs that differ do so by rounding, which grows."
    )
    return frame


def function_table(functions: xr.Dataset) -> pd.DataFrame:
    """Median errors, a row per function and case."""
    middle = functions["fitness"].median("run")
    names = functions["algorithm"].values.tolist()
    rows, bold = [], set()
    for function in functions["function"].values.tolist():
        for case in CASES:
            cell = middle.sel(function=function, case=case).to_series()
            least = cell[names].min()
            bold |= {(len(rows), name) for name in names if cell[name] <= max(least, FLOOR)}
            rows.append({"function": function, "case": case, **cell[names]})
    frame = pd.DataFrame(rows)
    frame.attrs["title"] = "Classical functions"
    frame.attrs["bold"] = bold
    frame.attrs["columns"] = {
        name: Column(label(name), lambda error: significant(error, 2)) for name in names
    }
    frame.attrs["caption"] = (
        f"Median error of {functions.sizes['run']} runs, in {functions.attrs['dim']} variables; "
        "the least of a row, and what is below 10⁻¹⁶, is bold."
    )
    return frame


def findings(tasks: xr.Dataset, changes: Changes, functions: xr.Dataset) -> str:
    """Who depends on where the origin is, who on the middle of the bounds."""
    names, same = tasks["algorithm"].values.tolist(), alike(tasks)
    farthest = float(tasks["distance"].max())
    said = [_moved(name, changes, same[name], farthest) for name in WORLD if name in names]
    others = [name for name in names if name not in WORLD]
    kept = [name for name in others if same[name] > 0.9]
    told = listed([*map(label, kept)])
    said.append(
        f"Of the {len(others)} others {len(kept)} end at least nine runs in ten alike, to a "
        f"millionth of the fitness, wherever their tasks are moved to: {told}"
        + _exceptions([name for name in others if name not in kept], same)
    )
    ways = {
        ("printed", "moved"): "functions are moved together with their bounds, against printed",
        ("printed", "shifted"): "their optimum is shifted off the middle of the bounds, against "
        "printed",
        ("shifted", "turned"): "they are turned as well, against shifted alone",
    }
    owing = {}
    for (one, other), told in ways.items():
        losses = {name: lost(functions, name, one, other) for name in names}
        owing[other] = [label(name) for name in names if losses[name].low > 1]
        said.append(f"Where {told}, {_losers(losses)}.")
    error = decades(functions).mean(("function", "run"))
    best = {case: str(error.sel(case=case).idxmin("algorithm").item()) for case in CASES}
    first = "; ".join(f"{case}, {label(name)}" for case, name in best.items())
    said.append(f"Who has the least mean error of functions: {first}.")
    answer = (
        f"In the classical functions {_losing(owing['moved'])} where the optimum leaves the "
        f"origin, and {_losing(owing['shifted'])} where it leaves the middle of the bounds as "
        "well; no task is solved surely worse where it lies elsewhere"
        + _worse([name for name in names if changes[name, farthest].sure > 0])
    )
    return bulleted(answer, *said, found_nothing(tasks, functions))


def _moved(name: str, changes: Changes, same: float, farthest: float) -> str:
    change = changes[name, farthest]
    verdict = {1: "does worse", -1: "does better", 0: "may do better or worse"}[change.sure]
    return (
        f"{label(name)} {verdict} where tasks lie {farthest:g} m away: fitness "
        f"{signed(change.middle)} % ({between(change.low, change.high)}); {100 * same:.0f} % of "
        "its runs end alike at all distances."
    )


def _losing(names: list[str]) -> str:
    verb = "lose" if len(names) > 1 else "loses"
    return f"{listed(names, 'no algorithm')} {verb} more than a decade"


def _worse(names: list[str]) -> str:
    return f", but for {listed([*map(label, names)])}." if names else "."


def _exceptions(names: list[str], same: dict[str, float]) -> str:
    told = [f"{label(name)} ({100 * same[name]:.0f} %)" for name in names]
    if not told:
        return "."
    why = ", by rounding that grows" if all(name.endswith("-task") for name in names) else ""
    return f"; fewer runs of {listed(told)} do{why}."


def _losers(losses: dict[str, Change]) -> str:
    """Who loses how many decades, who gains, who keeps its error."""
    groups: dict[int, list[str]] = {1: [], -1: [], 0: []}
    for name, change in losses.items():
        sign = change.sure if abs(change.middle) >= LEAST else 0
        amount = f"{label(name)} {abs(change.middle):.1f} decades"
        groups[sign].append(amount if sign else label(name))
    words = {1: "errors grow:", -1: "errors fall:", 0: "no sure change:"}
    parts = [f"{words[key]} {listed(found)}" for key, found in groups.items() if found]
    return "; ".join(parts)
