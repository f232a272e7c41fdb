"""Do algorithms find what they find because of where the origin is?"""

import json
import math
from typing import NamedTuple

import numpy as np
import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.ends import ends, telling
from experiments.studies import origin_bias as bias
from jaxsusp._files import write_netcdf
from jaxsusp.comparison import dataset
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import stack_problems
from jaxsusp.scenario.ownunits import Frame, restated
from jaxsusp.studies.classical import CASES, FUNCTIONS, classical

TITLE = "Bias to the origin"
PRINTED = ""
DIFFERS = (
    'DBO and SDBO scale positions about the world\'s origin, as printed (`frame="world"`), or '
    'about the task (`frame="task"`, `dbo-task` and `sdbo-task`). How much of what they find do '
    "they owe to where the origin is: of tasks that are moved, and of classical functions?"
)
MADE = READ = ("origin_tasks", "origin_functions")
MINUTES = 8.0


class Settings(NamedTuple):
    """Of `jaxsusp.compare`, and of the functions."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = tuple(js.ALGORITHMS)
    distances: tuple[float, ...] = (0.0, 1.0, 3.0, 10.0)  # m
    runs: int = 20
    iterations: int = 500
    population: int = 30
    seed: int = 0
    functions: tuple[str, ...] = tuple(FUNCTIONS)
    dim: int = 30
    runs_of_functions: int = 20


FULL = Settings()
MINIATURE = Settings(
    ("scenario-1",), ("pso", "sdbo", "sdbo-task"), (0.0, 1.0, 10.0), 2, 20, 30, 0, ("sphere",), 4, 2
)


def make(settings: Settings, work: Work) -> None:
    """A comparison per distance, and one program per algorithm for all functions and cases."""
    runs = {
        each: getattr(settings, each)
        for each in ("algorithms", "runs", "iterations", "population", "seed")
    }
    tasks = {
        distance: js.compare(
            [moved(name, distance) for name in settings.scenarios],
            **runs,
            search="box",
            output=work.folder / f"moved-{distance:g}",
            resume=True,
            progress=telling(work.told, f"{distance:g} m away"),
        )
        for distance in settings.distances
    }
    work.artefacts.keep("origin_tasks", ends(tasks, "distance", settings))
    work.artefacts.keep("origin_functions", functions(settings, work))


def moved(name: str, distance: float) -> js.Scenario:
    """A task as it is, but so many metres away from the origin, along x and y alike."""
    aside = distance / math.sqrt(2)
    scenario = restated(js.load_scenario(name), Frame(origin=(aside, aside, 0.0)))
    return js.load_scenario(scenario)


def functions(settings: Settings, work: Work) -> xr.Dataset:
    """What every algorithm finds of every function in every case."""
    labels = [(case, name) for case in CASES for name in settings.functions]
    problems = stack_problems([classical(name, case, settings.dim) for case, name in labels])
    shape = len(CASES), len(settings.functions), settings.runs_of_functions
    found = {}
    for name in settings.algorithms:
        file = work.folder / f"functions-{name}-{settings.iterations}.nc"
        if not file.exists():
            work.told(f"  functions: {name}")
            outcome = run_batch(
                problems, algorithm(name), settings.seed, range(settings.runs_of_functions),
                settings.iterations, settings.population,
            )  # fmt: skip
            values = outcome.fitness.astype(np.float64).reshape(shape)
            write_netcdf(xr.Dataset({"fitness": (("case", "function", "run"), values)}), file)
        found[name] = xr.load_dataset(file, engine="h5netcdf")["fitness"].values
    return xr.Dataset(
        {"fitness": (("algorithm", "case", "function", "run"), np.stack([*found.values()]))},
        {"algorithm": [*found], "case": [*CASES], "function": [*settings.functions]},
        {
            "settings": json.dumps(settings._asdict()),
            "dim": settings.dim,
            **dataset.provenance(),
        },
    )


def draw(artefacts: Artefacts) -> Page:
    """What moving changes, of tasks and of functions."""
    tasks, functions = artefacts.dataset("origin_tasks"), artefacts.dataset("origin_functions")
    changes = bias.changes_of(tasks)
    return Page(
        {"origin": bias.figure(changes, functions)},
        {
            "origin-tasks": bias.task_table(tasks, changes),
            "origin-functions": bias.function_table(functions),
        },
        bias.findings(tasks, changes, functions),
    )
