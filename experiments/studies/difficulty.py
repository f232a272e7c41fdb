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
from jaxsusp._files import write_text
from jaxsusp.freespace.cells.passage import passage_width
from jaxsusp.optim import devices
from jaxsusp.report.comparison.gaps import clear_fitness, clear_runs, evaluations_to

TITLE = "What makes a task hard"
PRINTED = ""
DIFFERS = (
    "Random scenes, blocked and proved to be solvable, in which one thing is changed at a time: "
    "the number of obstacles, the number of robots, the width of the narrowest passage. How often "
    "is a plan found, how often do the paper's algorithms end clear, and what does it cost?"
)
MADE = READ = ("difficulty",)
MINUTES = 12.0


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
    robots: tuple[int, ...] = (5, 8)
    passages: tuple[tuple[float, float], ...] = ((0.03, 0.1), (0.1, 0.2), (0.4, 0.8))
    scenes: int = 4  # of a level, on which algorithms are compared …
    planned: int = 2  # … and of these so many are planned as well
    fewer: tuple[tuple[int, int], ...] = ((100, 3), (200, 2))  # scenes with so many obstacles
    algorithms: tuple[str, ...] = ("pso", "sdbo")
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


FULL = Settings()
MINIATURE = Settings(Level(6), (), (), ((0.4, 0.8),), 2, 1, (), ("pso",), 2, 20, processes=1)


def make(settings: Settings, work: Work) -> None:
    """Draw the scenes, compare on all of them in the whole workspace, and plan some."""
    scenes = drawn(settings, work)
    tasks = [js.load_scenario(row["file"]) for row in scenes]
    ds = js.compare(
        tasks, settings.algorithms, settings.runs, settings.iterations, settings.population,
        search="box", output=work.folder / "comparison", resume=True,
    )  # fmt: skip
    plans = [
        planned(task, work) if row["seed"] < settings.planned else {}
        for row, task in zip(scenes, tasks, strict=True)
    ]
    frame = pd.DataFrame([row | plan for row, plan in zip(scenes, plans, strict=True)])
    work.artefacts.keep("difficulty", beside(frame.drop(columns="file"), ds), settings)


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
        "scenario": task.name, **level._asdict(), "seed": seed, "width": passage_width(task),
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
        "attempts": plan.settings["attempts"], "runs_made": plan.settings["runs_made"], "fitness": plan.settings["fitness"],
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
    return Page()
