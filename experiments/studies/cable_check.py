"""The paper looks for contacts at 40 points in time: how many of its clear runs are clear?"""

import json
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.studies import cable_cuts as cuts
from jaxsusp._files import atomic_path
from jaxsusp.comparison import dataset
from jaxsusp.comparison.workunit import Group, evaluate_exactly, stack_scenarios
from jaxsusp.geometry.penetration import deepest
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.optim.registry import algorithm as algorithm_of
from jaxsusp.problem.choices import CONTACTS
from jaxsusp.problem.fitness import trajectory

TITLE = "Cables between two samples"
PRINTED = ""
DIFFERS = (
    "The paper checks a trajectory at 40 points in time. Between two of them a cable can pass "
    "through an obstacle. How many runs that its check calls clear truly are, and how deep do the "
    "others cut?"
)
MADE = READ = ("cable-check",)
MINUTES = 8.0


class Settings(NamedTuple):
    """Every algorithm on every scenario, with either check, where either rule keeps waypoints."""

    scenarios: tuple[str, ...] = js.scenarios()
    algorithms: tuple[str, ...] = (*PUBLISHED, "cmaes", "routed")
    searches: tuple[str, ...] = ("box", "free-space")  # of `problem.choices.SEARCHES`
    runs: int = 10
    iterations: int = 500
    population: int = 30
    samples: int = 40
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), ("pso",), ("box",), 2, 20)


def make(settings: Settings, work: Work) -> None:
    """Search with either check, and judge every run."""
    tasks = [js.load_scenario(name) for name in settings.scenarios]
    parts = []
    for search in settings.searches:
        (group,) = stack_scenarios(tasks, 5, settings.samples, search)
        for contacts in CONTACTS:
            for name in settings.algorithms:
                kept = Path(work.folder) / f"{search}-{contacts}-{name}.nc"
                if not kept.exists():
                    work.told(f"{name}, waypoints in {search}, contacts {contacts}")
                    part = judged(group, settings, contacts, name)
                    labels = {"search": [search], "contacts": [contacts], "algorithm": [name]}
                    kept.parent.mkdir(parents=True, exist_ok=True)
                    with atomic_path(kept) as scratch:
                        part.expand_dims(labels).to_netcdf(scratch, engine="h5netcdf")
                part = xr.load_dataset(kept, engine="h5netcdf")
                # Texts of unequal length would be cut to the first one's when parts are joined.
                parts.append(
                    part.assign_coords({each: part[each].astype(object) for each in _OVER})
                )
    ds = xr.combine_by_coords(parts, combine_attrs="drop")
    assert isinstance(ds, xr.Dataset)
    ds = ds.sel(scenario=list(settings.scenarios), algorithm=list(settings.algorithms))
    work.artefacts.keep(
        "cable-check",
        ds.assign_attrs(settings=json.dumps(settings._asdict()), **dataset.provenance()),
    )


_OVER = ("search", "contacts", "algorithm")


def judged(group: Group, settings: Settings, contacts: str, name: str) -> xr.Dataset:
    """Runs of one algorithm with one check, (scenario, run), and the certificate of the best."""
    searched = replace(group.problems.fitness, contacts=contacts)
    swept = replace(searched, contacts=CONTACTS[0])
    found = run_batch(
        group.problems.with_fitness(searched), algorithm_of(name), settings.seed,
        range(settings.runs), settings.iterations, settings.population,
    )  # fmt: skip
    own = evaluate_exactly(searched, found.x)
    clear = (own.terms.collisions + own.terms.violations) == 0
    with jax.enable_x64(True):
        cuts = np.stack(_cuts(swept, jnp.asarray(found.x, jnp.float64)))
    best = np.where(clear, own.fitness, np.inf).argmin(axis=1)
    proofs = [
        certified(task, group.problems, x[run]) if free[run] else (np.nan,) * 2
        for task, x, run, free in zip(group.scenarios, found.x, best, clear, strict=True)
    ]
    proved, slack = np.array(proofs).T
    over = ("scenario", "run")
    return xr.Dataset(
        {
            "fitness": (over, own.fitness),
            "clear": (over, clear),  # by the check of the search, in float64
            "swept": (over, evaluate_exactly(swept, found.x).terms.collisions),
            "load_depth": (over, cuts[0].astype(np.float32)),  # m, in an obstacle itself
            "cable_depth": (over, cuts[1].astype(np.float32)),
            "warning_depth": (over, cuts[2:].max(axis=0).astype(np.float32)),  # in a warning area
            "best": ("scenario", best),  # the best clear run, where there is one
            "proved": ("scenario", proved),  # whether load and cables of its plan keep ϑ
            "slack": ("scenario", slack),  # m, the least clearance of its plan beyond ϑ
        },
        {"scenario": group.names, "run": range(settings.runs)},
    )


@jax.jit
def _cuts(suspension, x):
    """Depths of load and cables in obstacles, then in warning areas, each (scenario, run)."""

    def one(suspension, x):
        fine = cuts.INSTANTS * (suspension.samples - 1) + 1
        position = trajectory(suspension.world, x.T, fine)
        bodies, obstacles = suspension.world.bodies, suspension.world.obstacles
        bare = bodies._replace(clearance=jnp.zeros_like(bodies.clearance))
        return *deepest(position, bare, obstacles), *deepest(position, bodies, obstacles)

    return jax.lax.map(lambda each: one(*each), (suspension, x))


def certified(task: js.Scenario, problem: js.Problem, x: np.ndarray) -> tuple[float, float]:
    """Whether load and cables keep ϑ from obstacles on the plan's curve, and how much more (m)."""
    plan = js.plan_through(task, x.astype(np.float64).reshape(-1, 3))
    kinds = ("load to obstacles", "cables to obstacles")
    slack = min(each.slack for each in plan.certificate.clearances if each.kind in kinds)
    return float(slack >= -cuts.TOUCH), slack


def draw(artefacts: Artefacts) -> Page:
    """Shares by check, and how deep the others cut."""
    ds = artefacts.dataset("cable-check")
    figures = {"cable-check": cuts.depths(ds)}
    tables = {"cable-check": cuts.checks_table(ds), "cable-check-winners": cuts.winners_table(ds)}
    return Page(figures, tables, cuts.findings(ds))
