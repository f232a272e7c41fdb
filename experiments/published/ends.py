"""Ends placed by the four algorithms for one trajectory, and the lengths of the cables."""

import hashlib
import json
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.words import counted, winners
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.report.comparison import paper
from jaxsusp.report.comparison.best import best_plan
from jaxsusp.report.render import Column, Footnote, percent, significant
from jaxsusp.suspension.armclearance import ARM_MARGIN

TITLE = "Where the ends are placed"
PRINTED = "Tables 2, 3"
DIFFERS = (
    "One trajectory for all, SDBO's best of Table 1, in each of our six scenarios. Ends stay "
    "within reach of their robots, tensions within limits and cables clear, which the printed ends "
    "do not keep."
)
MADE = ("ends",)
READ = ("ends",)
MINUTES = 3.0


class Settings(NamedTuple):
    """Of `jaxsusp.place_ends`; the winners are not refined: the algorithms are compared."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = PUBLISHED
    runs: int = 20
    iterations: int = 200
    population: int = 30
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), ("dbo",), 2, 20)
GIVEN = "given"
KEYS = ["scenario", "algorithm"]
TIE = 0.001
"""Share of f₃ + f₄ below which two placements are as good as each other."""


def make(settings: Settings, work: Work) -> None:
    """Place, scenario by scenario; what is finished is kept in the folder."""
    ds, parts, frames = work.artefacts.comparison("comparison"), Artefacts(work.folder), []
    told = json.dumps([settings._replace(scenarios=()), ds.attrs["created"]])
    digest = hashlib.sha256(told.encode()).hexdigest()[:12]
    for name in settings.scenarios:
        if parts.missing([f"{name}-{digest}"]):
            work.told(f"ends for {name}")
            parts.keep(f"{name}-{digest}", placed(ds, name, settings), settings)
        frames.append(parts.frame(f"{name}-{digest}"))
    work.artefacts.keep("ends", pd.concat(frames), settings)


def placed(ds, name: str, settings: Settings) -> pd.DataFrame:
    """One row per robot and algorithm, and the ends that are given first."""
    from jaxsusp.coordination.ends import encode, end_problem, evaluate_ends

    plan = best_plan(ds, name, "sdbo")
    if plan is None:
        return pd.DataFrame()
    given = encode(np.array([robot.end for robot in plan.scenario.robots]))
    found = {GIVEN: evaluate_ends(end_problem(plan.scenario, plan.position), given)}
    for algorithm in settings.algorithms:
        found[algorithm] = js.place_ends(
            plan.scenario, plan.position, algorithm, settings.seed, settings.runs,
            settings.iterations, settings.population, refined=False,
        )  # fmt: skip
    rows = [
        (name, by, robot + 1, *end, length, each.cable, each.tension_rate, each.faults)
        for by, each in found.items()
        for robot, (end, length) in enumerate(zip(each.ends, each.lengths, strict=True))
    ]
    columns = ["scenario", "algorithm", "robot", "x", "y", "z", "length", "f3", "f4", "faults"]
    return pd.DataFrame(rows, columns=columns)


def draw(artefacts: Artefacts) -> Page:
    """Both tables with the printed values first."""
    frame = artefacts.frame("ends")
    printed = paper.tables_2_3()
    tables = {"table-2": ends_table(frame, printed), "table-3": lengths_table(frame, printed)}
    return Page({}, tables, findings(frame, printed))


def ends_table(frame: pd.DataFrame, printed: pd.DataFrame) -> pd.DataFrame:
    """Table 2: a row per algorithm, an end per robot."""
    both: Any = pd.concat([printed.assign(scenario="printed"), frame])
    end = "(" + both[["x", "y", "z"]].map("{:.3f}".format).agg(", ".join, axis=1) + ")"
    wide: Any = _by_robot(both.assign(end=end), "end").add_prefix("robot ").add_suffix(" (m)")
    wide = wide.reset_index()
    wide.attrs["title"] = "Ends of the cables (Table 2)"
    wide.attrs["group"] = ["scenario"]
    wide.attrs["caption"] = (
        "Given: the scenario's own ends, before any algorithm. The paper prints one row per "
        "algorithm, and does not say for which scenario."
    )
    rows = wide.index[wide["scenario"] == "printed"]
    count = int(out_of_reach(printed).sum())
    if count:
        wide.attrs["footnotes"] = [
            Footnote(
                f"{count} of {len(printed)} printed ends are farther from their robot's shoulder "
                "than its two links reach.",
                frozenset((row, "algorithm") for row in rows),
            )
        ]
    return wide


def lengths_table(frame: pd.DataFrame, printed: pd.DataFrame) -> pd.DataFrame:
    """Table 3: greatest lengths, their sum f3, what f4 adds, and whether all limits are kept."""
    both: Any = pd.concat([printed.assign(scenario="printed"), frame])
    wide: Any = _by_robot(both, "length").add_prefix("cable ")
    wide["sum"] = wide.sum(axis=1)
    rest = frame.groupby(KEYS, sort=False)[["f4", "faults"]].first()
    wide = wide.join(rest).reset_index()
    wide["total"] = wide["sum"] + wide["f4"]
    wide["fine"] = ["–" if np.isnan(n) else "yes" if n == 0 else f"no ({n:.0f})"
                    for n in wide["faults"]]  # fmt: skip
    wide = wide.drop(columns="faults")
    wide.attrs["title"] = "Greatest lengths of the cables (Table 3)"
    wide.attrs["group"] = ["scenario"]
    wide.attrs["columns"] = {f"cable {k}": Column(f"cable {k} (m)") for k in (1, 2, 3)} | {
        "sum": Column("sum f₃ (m)"),
        "f4": Column("f₄ (N m/s²)"),
        "total": Column("f₃ + f₄"),
        "fine": Column("limits kept"),
    }
    wide.attrs["bold"] = frozenset(
        (int(row), "total")
        for name, part in wide[(wide["algorithm"] != GIVEN) & (wide["fine"] == "yes")].groupby(
            "scenario"
        )
        if name != "printed"
        for row in part.index[_least(part["total"])]
    )
    runs = frame.attrs["settings"]
    wide.attrs["caption"] = (
        f"The best of {runs['runs']} runs of {runs['iterations']} iterations with "
        f"{runs['population']} candidates; minimised is f₃ + f₄ with κ per fault, for the same "
        f"trajectory. Bold: the least, and what is less than {100 * TIE:g} % above it. "
        "Limits kept: with the "
        f"{ARM_MARGIN:g} m that placing keeps arms off everything beyond what is required."
    )
    return wide


def _least(total: Any) -> Any:
    """Which of some sums are the least of them, or as good."""
    return total <= total.min() * (1 + TIE)


def _by_robot(both: Any, value: str) -> Any:
    """A row per scenario and algorithm as they come, a column per robot."""
    rows = both[KEYS].drop_duplicates()
    wide = both.set_index([*KEYS, "robot"])[value].unstack("robot")
    return wide.loc[pd.MultiIndex.from_frame(rows)].rename_axis(columns=None)


def out_of_reach(printed: pd.DataFrame) -> pd.Series:
    """Which printed ends are out of their robot's reach in the benchmark, whose arms are theirs."""
    robots = js.load_scenario("scenario-1").robots
    shoulders = np.array([np.add(robot.base, [0, 0, robot.links[0]]) for robot in robots])
    reach = np.array([sum(robot.links[1:]) for robot in robots])
    place = printed["robot"].to_numpy() - 1
    far = np.linalg.norm(printed[["x", "y", "z"]].to_numpy() - shoulders[place], axis=1)
    return pd.Series(far > reach[place], printed.index)


def findings(frame: Any, printed: Any) -> str:
    """Whose ends hang lowest and shortest, here and as printed."""
    wide: Any = lengths_table(frame, printed)
    ours = wide[(wide["scenario"] != "printed") & (wide["algorithm"] != GIVEN)]
    scenarios = list(dict.fromkeys(ours["scenario"]))
    fine = ours[ours["fine"] == "yes"]
    best = [
        name
        for _, part in fine.groupby("scenario", sort=False)
        for name in part.loc[_least(part["total"]), "algorithm"]
    ]
    order = ours["algorithm"].unique().tolist()
    text = (
        f"{winners(best, 'the least f₃ + f₄ with all limits kept', order)} of "
        f"{counted(len(scenarios), 'scenario')}, where what is less than {100 * TIE:g} % above the "
        "least counts as the least, too"
        if best
        else "Nobody keeps all limits"
    )
    told = wide[wide["scenario"] == "printed"].set_index("algorithm")["sum"]
    low = printed.groupby("algorithm", sort=False)["z"].first()
    spread = [
        part["total"].max() / part["total"].min() - 1
        for _, part in fine.groupby("scenario", sort=False)
    ]
    second = "" if low.idxmin() == told.idxmin() else f"{low.idxmin().upper()} "
    text += (
        "; the best and the worst of them are at most "
        f"{percent(max(spread, default=np.nan))} apart. As printed, {told.idxmin().upper()} has "
        f"the shortest cables ({significant(told.min())} m in all) and {second}the "
        f"lowest ends ({low.min():g} m); but {int(out_of_reach(printed).sum())} of the "
        f"{len(printed)} printed ends are out of reach. "
    )
    heights = frame.groupby(["scenario", "algorithm"], sort=False)["z"].first().unstack()
    if {"sdbo", "dbo"} <= set(heights):
        lower = int((heights["sdbo"] <= heights.drop(columns=GIVEN).min(axis=1)).sum())
        text += f"SDBO's ends are the lowest in {lower} of {len(scenarios)} here. "
    bad = ours[ours["fine"].str.startswith("no")]
    if len(bad):
        names = ", ".join(f"{row.algorithm.upper()} in {row.scenario}" for row in bad.itertuples())
        text += f"Ends that break a limit: {names}."
    return text.strip()
