"""Does the ranking change with what all algorithms get equally much of?"""

import hashlib
import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure
from scipy.stats import kendalltau

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.changes import found_nothing
from experiments.contents import Page, Work
from experiments.ends import ends
from experiments.words import bulleted, counted, listed
from jaxsusp._files import write_netcdf, write_text
from jaxsusp.comparison import dataset, timebudget
from jaxsusp.comparison.choices import BUDGETS
from jaxsusp.comparison.workunit import Unit, stack_scenarios
from jaxsusp.optim.registry import algorithm
from jaxsusp.report.comparison.gaps import clear_runs, gaps
from jaxsusp.report.comparison.statistics import mean_ranks
from jaxsusp.report.drawing.style import INK, label, picture, quiet, styles
from jaxsusp.report.render import Column, above, two_decimals
from jaxsusp.studies.resampling import resampled_ranks

TITLE = "Equal iterations, equal evaluations, equal time"
PRINTED = ""
DIFFERS = (
    "The paper gives every algorithm equally many iterations, of which one of SDBO costs three "
    "times as much as one of the others. Does the ranking change where all get equally many "
    "fitness evaluations, or equally much time?"
)
MADE = READ = ("budgets",)
MINUTES = 6.0


ROOM = 4
"""Times the iterations asked for, more than equal time allows the quickest."""


class Settings(NamedTuple):
    """Of `jaxsusp.compare`."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = tuple(js.ALGORITHMS)
    runs: int = 20
    iterations: int = 500
    population: int = 30
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), ("pso", "sdbo", "sdbo-task"), 2, 20)


def make(settings: Settings, work: Work) -> None:
    """All algorithms in all budgets: one compiled program per algorithm."""
    folder = work.folder / hashlib.sha256(repr(settings).encode()).hexdigest()[:8]
    parts = {
        budget: dataset.merge([done(unit, budget, settings, folder, work) for unit in units])
        for budget, units in planned(settings, folder, work).items()
    }
    work.artefacts.keep("budgets", ends(parts, "budget", settings))


def planned(settings: Settings, folder: Path, work: Work) -> dict[str, list[Unit]]:
    """A unit per algorithm in every budget, all with room for as many iterations."""
    scenes = [*map(js.load_scenario, settings.scenarios)]
    (group,) = stack_scenarios(scenes, 5, 40, "free-space")
    sizes, room = (settings.iterations, settings.population), ROOM * settings.iterations
    units = {
        budget: [
            Unit.plan(group, algorithm(name), *sizes, budget)._replace(asked=room)
            for name in settings.algorithms
        ]
        for budget in BUDGETS
    }
    file = (
        folder / "iterations.json"
    )  # what was measured once holds when an interrupted one goes on
    if not file.exists():

        def timed(unit: Unit) -> float:
            work.told(f"  timing {unit.optimizer.name}")
            return unit.time_iteration(settings.seed, settings.runs) / settings.runs

        _, allotted = timebudget.allot(units["time"], [], timed)
        folder.mkdir(parents=True, exist_ok=True)
        write_text(file, json.dumps(allotted))
    iterations = json.loads(file.read_text(encoding="utf-8"))["iterations"]
    units["time"] = [
        unit._replace(iterations=iterations[unit.optimizer.name]) for unit in units["time"]
    ]
    return units


def done(unit: Unit, budget: str, settings: Settings, folder: Path, work: Work) -> xr.Dataset:
    """How the runs of one algorithm ended in one budget, kept when they are finished."""
    file = folder / f"{budget}-{unit.optimizer.name}.nc"
    if not file.exists():
        work.told(f"  equal {budget}: {unit.optimizer.name}, {unit.iterations} iterations")
        write_netcdf(unit.compute(settings.seed, range(settings.runs)), file)
    return xr.load_dataset(file, engine="h5netcdf")


def draw(artefacts: Artefacts) -> Page:
    """Ranks in the three budgets."""
    ds = artefacts.dataset("budgets")
    ranks = {budget: resampled_ranks(ds.sel(budget=budget)) for budget in BUDGETS}
    frame = table(ds, ranks)
    return Page({"budgets": figure(frame)}, {"budgets": frame}, findings(ds, frame, ranks))


def table(ds: xr.Dataset, ranks: dict[str, np.ndarray]) -> pd.DataFrame:
    """A row per budget and algorithm, the best first."""
    rows = []
    for budget in BUDGETS:
        part = ds.sel(budget=budget)
        place = mean_ranks(part).set_index("algorithm")["mean_rank"]
        low, high = np.quantile(ranks[budget], [0.025, 0.975], axis=0)
        gap, clear = 100 * gaps(part), clear_runs(part)
        for i, name in enumerate(ds["algorithm"].values.tolist()):
            rows.append(
                {
                    "budget": f"equal {budget}",
                    "algorithm": name,
                    "mean_rank": place[name],
                    "low": low[i],
                    "high": high[i],
                    "gap": float(gap.sel(algorithm=name).median()),
                    "clear": int(clear.sel(algorithm=name).sum()),
                    "runs": int(clear.sel(algorithm=name).size),
                    "iterations": int(part["iterations"].sel(algorithm=name)),
                    "evaluations": int(part["evaluations"].sel(algorithm=name)[0]),
                }
            )
    frame = pd.DataFrame(rows)
    frame = frame.groupby("budget", sort=False)[list(frame)].apply(
        lambda part: part.sort_values("mean_rank", kind="stable")
    )
    frame = frame.reset_index(drop=True)
    frame.attrs["title"] = "Ranks in three budgets"
    frame.attrs["columns"] = {
        "low": Column("from", two_decimals),
        "high": Column("to", two_decimals),
        "gap": Column("median gap (%)", above),
        "evaluations": Column("evaluations"),
    }
    frame.attrs["caption"] = (
        f"Mean over {ds.sizes['scenario']} scenarios of the rank by median fitness, 1 the best of "
        f"{ds.sizes['algorithm']}, with the 95 % interval of a bootstrap over the "
        f"{ds.sizes['run']} runs; median over all runs of the gap to the best known fitness. Equal "
        "time is what the slowest takes for the iterations of the others, measured on the machine "
        "that made the data: another one gives other iterations."
    )
    return frame


def figure(frame: pd.DataFrame) -> Figure:
    """Mean rank by budget, a line per algorithm that is named at its end."""
    drawing = picture(3.46, 3.6)
    axes = drawing.subplots()
    quiet(axes)
    names = list(dict.fromkeys(frame["algorithm"]))
    wide = frame.pivot(index="algorithm", columns="budget", values="mean_rank")
    wide = wide[[f"equal {budget}" for budget in BUDGETS]]
    look = styles([name for name in js.ALGORITHMS if name in names])
    last = wide.iloc[:, -1].sort_values()
    heights = spread(last.to_numpy(), 0.045 * (len(names) + 1))
    for name in names:
        style = look[name]
        axes.plot(
            range(3), wide.loc[name], color=style.color, ls=style.dash, marker=style.marker,
            lw=1.4, markersize=5,
        )  # fmt: skip
    for name, height in zip(last.index, heights, strict=True):
        axes.plot([2.03, 2.13], [last[name], height], color=look[name].color, lw=0.6)
        axes.text(2.16, height, label(name), fontsize=7.5, va="center", color=INK)
    axes.set_xticks(range(3), [f"equal\n{budget}" for budget in BUDGETS])
    axes.set_xlim(-0.15, 2.95)
    axes.set_ylim(len(names) + 0.3, 0.7)
    axes.set_ylabel("mean rank (1: best)", fontsize=8.0)
    axes.tick_params(labelsize=8.0)
    drawing.set_label(
        "Mean rank by median fitness over the scenarios where all algorithms get equally many "
        "iterations, equally many evaluations, or equally much time."
    )
    return drawing


def spread(heights: np.ndarray, apart: float) -> np.ndarray:
    """Sorted heights of labels moved apart as little as need be."""
    found = heights.astype(float).copy()
    for _ in range(200):
        short = apart - np.diff(found)
        push = np.where(short > 1e-9, short / 2, 0)
        if not push.any():
            break
        found[:-1] -= push
        found[1:] += push
    return found


def findings(ds: xr.Dataset, frame: pd.DataFrame, ranks: dict[str, np.ndarray]) -> str:
    """Whether the order changes, and whether any change is sure."""
    names = ds["algorithm"].values.tolist()
    order = {
        budget: frame.loc[frame["budget"] == f"equal {budget}", "algorithm"].tolist()
        for budget in BUDGETS
    }
    said = [
        f"At equal {budget} the order is {listed([*map(label, order[budget])])}."
        for budget in BUDGETS
    ]
    answer = _firsts({budget: _first(order[budget], names, ranks[budget]) for budget in BUDGETS})
    if "sdbo" in names:
        places = [order[budget].index("sdbo") + 1 for budget in BUDGETS]
        where = [
            f"{place} at equal {budget}" for place, budget in zip(places, BUDGETS, strict=True)
        ]
        told = f"{places[0]} in all of them" if len(set(places)) == 1 else listed(where)
        said.append(f"SDBO, which evaluates most per iteration, has place {told}, of {len(names)}.")
    base, *others = BUDGETS
    first = order_of(ranks[base])
    count, all_pairs = int((first > 0).sum()), len(names) * (len(names) - 1) // 2
    told = []
    for budget in others:
        now = order_of(ranks[budget])
        turned, open_now = (
            int(((first > 0) & (now < 0)).sum()),
            int(((first > 0) & (now == 0)).sum()),
        )
        tau = kendalltau(*([order[each].index(name) for name in names] for each in (base, budget)))
        told.append(
            f"at equal {budget} {turned} of them are surely the other way round and {open_now} are "
            f"no longer sure (Kendall's τ of the orders {tau.statistic:.2f})"
        )
    said.append(
        f"Of {counted(all_pairs, 'pair')} of algorithms, the order of {count} is sure at equal "
        f"{base} (the same in 95 % of resamples, each pair by itself); {', '.join(told)}."
    )
    moved = [text for budget in others for text in moves(frame, ranks, names, base, budget)]
    said.append(f"Mean ranks that surely change: {listed(moved)}.")
    return bulleted(answer, *said, found_nothing(ds))


def _first(order: list[str], names: list[str], ranks: np.ndarray) -> tuple[str, ...]:
    """The first, and those that are not surely behind it."""
    before = order_of(ranks)[names.index(order[0])]
    return tuple(label(name) for name in order if before[names.index(name)] <= 0)


def _firsts(firsts: dict[str, tuple[str, ...]]) -> str:
    """Who is first where, and whether that surely changes."""
    told = []
    for group in dict.fromkeys(firsts.values()):
        where = listed([f"equal {budget}" for budget, each in firsts.items() if each == group])
        verb = "is first" if len(group) == 1 else "are first and not told apart"
        told.append(f"at {where} {listed(group)} {verb}")
    text = "; ".join(told)
    common = set.intersection(*map(set, firsts.values()))
    if len(told) > 1:
        text += (
            "; so that the first place changes is not told"
            if common
            else "; so the first place changes"
        )
    return f"{text[0].upper()}{text[1:]}."


def moves(frame: pd.DataFrame, ranks: dict[str, np.ndarray], names, base: str, budget: str):
    """Algorithms whose mean rank surely is another in another budget."""
    place = frame.set_index(["budget", "algorithm"])["mean_rank"]
    low, high = np.quantile(ranks[budget] - ranks[base], [0.025, 0.975], axis=0)
    for i, name in enumerate(names):
        if low[i] > 0 or high[i] < 0:
            before, after = (place[f"equal {each}", name] for each in (base, budget))
            yield f"{label(name)} from {before:.1f} to {after:.1f} at equal {budget}"


def order_of(ranks: np.ndarray) -> np.ndarray:
    """Of every two algorithms: 1 where the first is surely before the second, −1 after, 0 open."""
    difference = ranks[:, None, :] - ranks[:, :, None]
    low, high = np.quantile(difference, [0.025, 0.975], axis=0)
    return (low > 0).astype(int) - (high < 0).astype(int)
