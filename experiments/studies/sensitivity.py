"""Which setting decides what a search finds: Sobol indices of its results."""

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import jax
import numpy as np
import pandas as pd

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from jaxsusp._files import atomic_path
from jaxsusp.comparison.bestknown import best_known
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.studies.settings import Found, run_settings

TITLE = "Which settings matter"
PRINTED = ""
DIFFERS = (
    "The paper sets population, waypoints, samples, weights and κ once. How much of the variance "
    "of what a search finds is due to each of them, alone and together with the others, and how "
    "much to luck?"
)
MADE = READ = ("sensitivity",)
MINUTES = 6.0

WEIGHTS = ("w1", "w2", "w3", "w4", "w5")
FACTORS = ("population", "waypoints", "samples", *WEIGHTS, "kappa", "luck")
TERMS = ("f1", "f2", "f3", "f4", "f5")
RULER = 5, 40
"""Waypoints of the best known fitness, and samples at which all trajectories are measured."""


class Settings(NamedTuple):
    """Levels of what a compiled program is for; weights and κ go from 1/spread to spread times."""

    scenario: str = "scenario-5"
    algorithm: str = "pso"
    populations: tuple[int, ...] = (15, 30, 60)
    waypoints: tuple[int, ...] = (3, 5, 8)
    samples: tuple[int, ...] = (20, 40, 80)
    spread: float = 10.0
    base: int = 32  # N of the design: (factors + 2) N settings are run
    runs: int = 4  # of every setting
    iterations: int = 200
    together: int = 16  # settings in a batch
    seed: int = 0


FULL = Settings()
MINIATURE = Settings("scenario-1", "pso", (30,), (5,), (40,), 10.0, 2, 2, 20)


def problem_of(settings: Settings) -> dict:
    """The design's factors in SALib's words, each uniform in [0, 1)."""
    return {"num_vars": len(FACTORS), "names": [*FACTORS], "bounds": [[0.0, 1.0]] * len(FACTORS)}


def design(settings: Settings) -> pd.DataFrame:
    """Saltelli's design: a row per setting, columns as the searches understand them."""
    from SALib.sample import sobol as sampler

    rows = sampler.sample(
        problem_of(settings), settings.base, calc_second_order=False, seed=settings.seed
    )
    unit = pd.DataFrame(rows, columns=FACTORS)
    frame = pd.DataFrame(index=unit.index)
    for name, levels in zip(FACTORS, settings[2:5], strict=False):
        frame[name] = np.array(levels)[(unit[name] * len(levels)).astype(int)]
    spread = settings.spread ** (2 * unit[[*WEIGHTS, "kappa"]] - 1)
    frame[[*WEIGHTS]] = spread[[*WEIGHTS]]
    frame["kappa"] = 1000 * spread["kappa"]
    frame["luck"] = (unit["luck"] * 2**20).astype(int)  # which runs of the algorithm these are
    return frame


def make(settings: Settings, work: Work) -> None:
    """Run the design, shape by shape."""
    frame, task = design(settings), js.load_scenario(settings.scenario)
    Path(work.folder).mkdir(parents=True, exist_ok=True)
    rows = {}
    shapes = list(itertools.product(*settings[2:5]))
    for number, shape in enumerate(shapes, 1):
        part = frame[(frame[[*FACTORS[:3]]] == shape).all(axis=1)]
        if part.empty:
            continue
        kept = Path(work.folder) / f"{'-'.join(map(str, shape))}.csv"
        if not kept.exists():
            work.told(f"shape {number}/{len(shapes)}: {len(part)} settings {shape}")
            found = pd.concat(measured(task, settings, shape, part))
            with atomic_path(kept) as scratch:
                found.to_csv(scratch, index_label="row")
        rows |= pd.read_csv(kept, index_col="row").to_dict("index")
    found = frame.join(pd.DataFrame.from_dict(rows, orient="index").sort_index())
    work.artefacts.keep("sensitivity", found.round(6), settings)


def measured(task, settings: Settings, shape, part: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """What the runs of settings of one shape found, a batch after the other."""
    population, waypoints, samples = shape
    problem = js.Problem.from_scenario(task, waypoints, samples, dtype=np.float32)
    for first in range(0, len(part), settings.together):
        batch = part.iloc[first : first + settings.together]
        filled = batch.iloc[np.resize(np.arange(len(batch)), settings.together)]  # one program
        runs = filled["luck"].to_numpy()[:, None] * settings.runs + np.arange(settings.runs)
        found = run_settings(
            problem, algorithm_of(settings.algorithm), filled[[*WEIGHTS, "kappa"]].to_numpy(),
            runs, settings.iterations, population, settings.seed,
        )  # fmt: skip
        yield described(task, problem, Found(*(each[: len(batch)] for each in found)), batch)


def described(task, problem: js.Problem, found: Found, batch: pd.DataFrame) -> pd.DataFrame:
    """Terms of the best run of every setting by one ruler, and how many runs are clear."""
    with jax.enable_x64(True):
        own = _terms(problem.fitness, found.x.astype(np.float64))
        ruler = js.Problem.from_scenario(task, *RULER, search="box").fitness
        measured = _terms(ruler, found.x.astype(np.float64))
    faults = np.asarray(own.collisions + own.violations)
    rows, best = np.arange(len(batch)), found.fitness.argmin(axis=1)
    smooth = np.stack([np.asarray(term) for term in measured[:5]], axis=-1)[rows, best]
    frame = pd.DataFrame(smooth, columns=TERMS, index=batch.index)
    frame["clear"] = (faults == 0).mean(axis=1)
    default = smooth @ np.array(task.fitness.weights[:5])
    default += task.fitness.weights[5] * task.fitness.kappa * faults[rows, best]
    known = best_known(task, *RULER)
    frame["excess"] = default / known if known else np.nan
    return frame


@jax.jit
def _terms(fitness, x):
    """Of decision vectors (settings, runs, D)."""
    flat = fitness.terms(x.reshape(-1, x.shape[-1]).T)
    return jax.tree.map(lambda leaf: leaf.reshape(x.shape[:-1]), flat)


def draw(artefacts: Artefacts) -> Page:
    """First and total indices of every result, with intervals."""
    return Page()
