"""What makes a task hard: many obstacles, many robots, or a narrow passage?"""

import json
import multiprocessing
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.studies.difficulty_figures import (
    by_width,
    clear_figure,
    cost_figure,
    levels,
    sweeps,
)
from jaxsusp._files import write_text
from jaxsusp.freespace.cells.passage import widest_way
from jaxsusp.optim import devices
from jaxsusp.report.comparison.gaps import clear_fitness, clear_runs, evaluations_to
from jaxsusp.report.comparison.logistic import fitted, resampled, share_interval
from jaxsusp.report.drawing.style import label
from jaxsusp.report.render import Column, above, evaluations, significant

TITLE = "What makes a task hard"
PRINTED = ""
DIFFERS = (
    "Random scenes, blocked and proved to be solvable, in which one thing is changed at a time: "
    "the number of obstacles, the number of robots, the width of the narrowest passage, which lies "
    "between start and goal and not at one of them. How often is a plan found, how often does a "
    "search end clear, and what does it cost?"
)
MADE = READ = ("difficulty",)
MINUTES = 32.0


class Level(NamedTuple):
    """Scenes of one kind, a seed each."""

    obstacles: int = 12
    robots: int = 3
    narrowest: float = 0.2  # m, of `jaxsusp.passage`
    widest: float = 0.4


class Settings(NamedTuple):
    """One sweep after the other about the level that all of them share, and the comparison."""

    base: Level = Level()
    obstacles: tuple[int, ...] = (6, 25, 50, 100, 200)
    robots: tuple[int, ...] = (4, 5, 6, 8)
    passages: tuple[tuple[float, float], ...] = ((0.05, 0.1), (0.1, 0.2), (0.4, 0.8))
    scenes: int = 8  # of a level, on which algorithms are compared …
    planned: int = 1  # … and of these so many are planned as well, with the base's robots …
    planned_up_to: int = 25  # … and up to so many obstacles: each shape compiles programs anew
    fewer: tuple[tuple[int, int], ...] = ()  # (obstacles, scenes) of slow draws
    algorithms: tuple[str, ...] = ("pso", "ga", "dbo", "sdbo")
    runs: int = 10
    iterations: int = 200
    population: int = 30
    processes: int = 2

    def levels(self) -> list[Level]:
        """All of them, that of the base first."""
        return [
            self.base,
            *(self.base._replace(obstacles=count) for count in self.obstacles),
            *(self.base._replace(robots=count) for count in self.robots),
            *(self.base._replace(narrowest=low, widest=high) for low, high in self.passages),
        ]

    def draws(self) -> list[tuple[Level, int]]:
        """Level and seed of every scene."""
        fewer = dict(self.fewer)
        return [
            (level, seed)
            for level in self.levels()
            for seed in range(min(self.scenes, fewer.get(level.obstacles, self.scenes)))
        ]

    def plans(self, level: Level, seed: int) -> bool:
        """Whether a scene is planned as well."""
        few = level.robots == self.base.robots and level.obstacles <= self.planned_up_to
        return few and seed < self.planned


FULL = Settings()
MINIATURE = Settings(
    Level(6, 3, 0.4, 0.8), (), (), ((0.3, 0.4),), scenes=2, algorithms=("pso",), runs=4,
    iterations=60, processes=1,
)  # fmt: skip


def make(settings: Settings, work: Work) -> None:
    """Draw the scenes, compare on all of them in the whole workspace, and plan some."""
    scenes = drawn(settings, work)
    tasks = [js.load_scenario(row["file"]) for row in scenes]
    ds = js.compare(
        tasks, settings.algorithms, settings.runs, settings.iterations, settings.population,
        search="box", output=work.folder / "comparison", resume=True,
    )  # fmt: skip
    plans = [
        planned(task, work) if settings.plans(*draw) else _UNPLANNED
        for draw, task in zip(settings.draws(), tasks, strict=True)
    ]
    frame = pd.DataFrame([row | plan for row, plan in zip(scenes, plans, strict=True)])
    work.artefacts.keep("difficulty", beside(frame.drop(columns="file"), ds), settings)


_UNPLANNED = dict.fromkeys(
    ("seconds_space", "seconds_plan", "feasible", "attempts", "fitness", "taut"), np.nan
)


def drawn(settings: Settings, work: Work) -> list[dict]:
    """What is known of every scene before it is planned, in the order of `draws`."""
    folder = Path(work.folder) / "scenes"
    folder.mkdir(parents=True, exist_ok=True)
    asked = [(level, seed, folder) for level, seed in settings.draws()]
    if settings.processes == 1:
        return [drawn_scene(each) for each in asked]
    spawned = multiprocessing.get_context("spawn")
    with spawned.Pool(settings.processes, devices.configure) as pool:
        rows = []
        for row in pool.imap(drawn_scene, asked):
            work.told(f"drew {row['scenario']}: {row['width']:.3f} m wide")
            rows.append(row)
        return rows


def drawn_scene(asked: tuple[Level, int, Path]) -> dict:
    """Draw a scene; what is kept stays."""
    level, seed, folder = asked
    kept = folder / f"{'-'.join(map(str, level))}-{seed}.json"
    if kept.exists():
        return json.loads(kept.read_text(encoding="utf-8"))
    clock = time.perf_counter()
    task = js.random_scenario(
        seed, level.obstacles, robots=level.robots, passage=(level.narrowest, level.widest)
    )
    row = {
        "scenario": task.name, **level._asdict(), "seed": seed, "width": widest_way(task).width,
        "seconds_draw": time.perf_counter() - clock, "file": str(folder / f"{task.name}.toml"),
    }  # fmt: skip
    write_text(row["file"], task.to_toml())
    write_text(kept, json.dumps(row))
    return row


def planned(task: js.Scenario, work: Work) -> dict:
    """How planning it went, a second time: programs are compiled and the space is mapped."""
    kept = Path(work.folder) / "plans" / f"{task.name}.json"
    if kept.exists():
        return json.loads(kept.read_text(encoding="utf-8"))
    kept.parent.mkdir(parents=True, exist_ok=True)
    clock = time.perf_counter()
    js.free_space(task)
    mapped = time.perf_counter() - clock
    js.plan(task)
    clock = time.perf_counter()
    plan = js.plan(task)
    seconds = time.perf_counter() - clock
    row = {
        "seconds_space": mapped, "seconds_plan": seconds, "feasible": plan.feasible,
        "attempts": plan.settings["attempts"], "runs_made": plan.settings["runs_made"],
        "fitness": plan.settings["fitness"],
        "clearance": plan.clearance, "reasons": "; ".join(plan.reasons), **taut(task),
    }  # fmt: skip
    write_text(kept, json.dumps(row))
    work.told(f"planned {task.name}: {'feasible' if plan.feasible else row['reasons']}")
    return row


def taut(task: js.Scenario) -> dict:
    """The plan that is there without any search."""
    try:
        plan = js.plan(task, "taut", simulate=False)
    except js.InputError:
        return {"taut": np.nan, "taut_feasible": False}
    return {"taut": plan.settings["fitness"], "taut_feasible": plan.feasible}


def beside(frame: pd.DataFrame, ds: xr.Dataset) -> pd.DataFrame:
    """The scenes with clear runs, fitness and evaluations until clear of every algorithm."""
    clear, needed = clear_runs(ds), evaluations_to(ds, clear_fitness(ds))
    for name in ds["algorithm"].values.tolist():
        of = {"algorithm": name, "scenario": frame["scenario"].tolist()}
        frame[f"{name}_clear"] = clear.sel(of).sum("run").values
        frame[f"{name}_runs"] = ds.sizes["run"]
        frame[f"{name}_fitness"] = ds["fitness"].where(clear).sel(of).median("run").values
        frame[f"{name}_evaluations"] = ds["evaluations"].sel(of).values
        frame[f"{name}_spent"] = (
            needed.where(needed < np.inf, ds["evaluations"]).sel(of).sum("run").values
        )
    return frame


def draw(artefacts: Artefacts) -> Page:
    """Shares and costs by level, and a logistic curve by width."""
    frame = artefacts.frame("difficulty")
    names = frame.attrs["settings"]["algorithms"]
    figures = {
        "difficulty": clear_figure(frame, names),
        "difficulty-cost": cost_figure(frame, names),
    }
    tables = {"difficulty": level_table(frame, names), "difficulty-odds": odds_table(frame, names)}
    return Page(figures, tables, findings(frame, names))


def level_table(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """The levels for people."""
    table = levels(frame, names)
    table.insert(
        2, "passage", [f"{a:g}–{b:g}" for a, b in table[["narrowest", "widest"]].to_numpy()]
    )
    table = table.drop(columns=["narrowest", "widest", "width"])
    table.attrs["title"] = "By level"
    table.attrs["columns"] = {
        "passage": Column("passage (m)"),
        "feasible": Column("planned", out_of="tried"),
        "below_taut": Column("plan below taut (%)", above),
        "seconds_space": Column("mapping (s)", lambda value: significant(value, 2)),
        "seconds_plan": Column("planning (s)", lambda value: significant(value, 2)),
    }
    for name in names:
        table.attrs["columns"] |= {
            f"{name}_clear": Column(f"{label(name)} clear", out_of=f"{name}_runs"),
            f"{name}_ert": Column(f"{label(name)} ERT clear", evaluations),
        }
    table.attrs["caption"] = (
        "Passage: range of the width of the narrowest place, `js.passage`. Clear: runs without any "
        "collision or violation, waypoints anywhere in the workspace. ERT: fitness evaluations of "
        "all runs until a first clear trajectory, or to their end, over the runs that end clear. "
        "Planned: scenes of those tried of which `js.plan` returns a certified and simulated plan; "
        "medians of the time for its free space and for the plan, and of how far its fitness is "
        "below that of the taut way, on a machine that was busy with other work."
    )
    return table


def columns_of(frame: pd.DataFrame) -> np.ndarray:
    """Doublings of obstacles, robots, doublings of the width."""
    return np.column_stack(
        [np.log2(frame["obstacles"]), frame["robots"].astype(float), np.log2(frame["width"])]
    )


_STEPS = ("twice the obstacles", "one robot more", "twice the width")


def odds_table(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """By which factor the odds of a clear run change."""
    rows = []
    for name in names:
        data = (
            columns_of(frame),
            *(frame[f"{name}_{each}"].to_numpy(float) for each in ("clear", "runs")),
        )
        best, curves = fitted(*data), resampled(*data)
        low, high = np.quantile([curve.slopes for curve in curves], [0.025, 0.975], axis=0)
        for i, step in enumerate(_STEPS):
            rows.append((name, step, *np.exp([best.slopes[i], low[i], high[i]])))
    table = pd.DataFrame(rows, columns=["algorithm", "step", "factor", "low", "high"])
    table.attrs["title"] = "Odds of a clear run"
    table.attrs["columns"] = {
        "factor": Column("odds times", lambda value: significant(value, 2)),
        "low": Column("from", lambda value: significant(value, 2)),
        "high": Column("to", lambda value: significant(value, 2)),
    }
    table.attrs["caption"] = (
        "Logistic curve of the share of clear runs by the logarithm of the obstacles, the robots "
        "and the logarithm of the width together; 95 % intervals from drawing whole scenes anew."
    )
    return table


def findings(frame: pd.DataFrame, names: list[str]) -> str:
    """What makes clear runs rarer, where the curve bends, and what plans come to."""
    odds = odds_table(frame, names).set_index(["algorithm", "step"])
    runs = frame.attrs["settings"]["runs"]
    said = [
        f"{len(frame)} scenes, {runs} runs of {frame.attrs['settings']['iterations']} iterations "
        "each, waypoints anywhere in the workspace."
    ]
    for name in names:
        clear, total = int(frame[f"{name}_clear"].sum()), int(frame[f"{name}_runs"].sum())
        parts = []
        for step in _STEPS:
            factor, low, high = odds.loc[(name, step)]
            if high < 1 or low > 1:
                parts.append(
                    f"{step} multiplies the odds of a clear run by {factor:.2g} "
                    f"({low:.2g} to {high:.2g})"
                )
            else:
                parts.append(f"no effect of {step} is told from chance")
        bend = bend_of(sweeps(frame)["width"], name)
        said.append(
            f"{label(name)} ends clear in {clear} of {total} runs: {'; '.join(parts)}. {bend}"
        )
    if ((odds["low"] < 1) & (odds["high"] > 1)).all():
        said.append(
            f"So {len(frame)} scenes, most of them easy for the search, do not tell what makes a "
            "task hard; they bound it only as widely as the intervals of the odds say."
        )
    tried = frame[frame["feasible"].notna()]
    if len(tried):
        good = int((tried["feasible"] == True).sum())  # noqa: E712
        low, high = share_interval(good, len(tried))
        gain = 100 * (1 - tried["fitness"] / tried["taut"])
        said.append(
            f"`js.plan`, which knows the free space, returns a certified plan in {good} of "
            f"{len(tried)} scenes (95 % interval {100 * low:.0f} to {100 * high:.0f} %), "
            f"{int((tried['attempts'] == 1).sum())} of them at the first attempt; its fitness is "
            f"{gain.median():.0f} % below that of the taut way in the median. Mapping the free "
            f"space takes {tried['seconds_space'].min():.1f} to "
            f"{tried['seconds_space'].max():.0f} s and planning "
            f"{tried['seconds_plan'].min():.1f} to {tried['seconds_plan'].max():.1f} s."
        )
    return " ".join(said)


def bend_of(part: pd.DataFrame, name: str) -> str:
    """The width at which half of the runs end clear, if it is among those drawn."""
    data = by_width(part, name)
    slopes = [(curve.intercept, curve.slopes[0]) for curve in [fitted(*data), *resampled(*data)]]
    halves = np.exp2([np.clip(-a / b, -60, 60) if abs(b) > 1e-6 else np.nan for a, b in slopes])
    low, high = part["width"].min(), part["width"].max()
    if not (slopes[0][1] > 0 and low <= halves[0] <= high):
        return f"Its curve passes one half nowhere between {low:.2f} and {high:.2f} m of width."
    interval = np.nanquantile(halves[1:], [0.025, 0.975])
    return (
        f"Its curve passes one half at {halves[0]:.2f} m of width "
        f"(95 % interval {interval[0]:.2g} to {interval[1]:.2g} m)."
    )
