"""What SDBO's four improvements of DBO are worth, one by one and together."""

import hashlib
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import jax
import pandas as pd
import xarray as xr

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page, Work
from experiments.ends import random_scenes
from experiments.studies import ablation_effects as effects
from jaxsusp._files import write_netcdf
from jaxsusp.comparison import dataset
from jaxsusp.comparison.workunit import Group, Unit, stack_scenarios
from jaxsusp.studies.ablation import VARIANTS, Switches, switched

TITLE = "What the four improvements are worth"
PRINTED = ""
DIFFERS = (
    "The paper compares SDBO with DBO as a whole. Here each of its four additions comes on and off "
    "by itself, in all sixteen combinations: none of them is DBO, all of them are SDBO."
)
MADE = READ = ("ablation_six", "ablation_random")
MINUTES = 20.0
WAYPOINTS, SAMPLES, SEARCH = 5, 40, "free-space"


class Settings(NamedTuple):
    """Sixteen variants on all scenes, twice: as many iterations, as many evaluations."""

    scenarios: tuple[str, ...] = js.scenarios()
    runs: int = 6  # on each of them
    random: int = 50  # random scenes beside them
    runs_of_random: int = 2
    iterations: int = 500
    population: int = 30
    seed: int = 0


FULL = Settings()
MINIATURE = Settings(("scenario-1",), 2, 0, 2, 20)


def make(settings: Settings, work: Work) -> None:
    """All variants in both budgets; those that are finished are not run again."""
    six = [*map(js.load_scenario, settings.scenarios)]
    drawn = random_scenes(settings.random, work.folder / "scenes", work.told)
    (group,) = stack_scenarios([*six, *drawn], WAYPOINTS, SAMPLES, SEARCH)
    parts = work.folder / hashlib.sha256(repr(settings).encode()).hexdigest()[:8]
    found = {}
    for budget, made in itertools.product(effects.BUDGETS, VARIANTS):
        name = effects.label(made)
        file = parts / f"{budget}-{name.replace(' ', '')}.nc"
        if not file.exists():
            work.told(f"  equal {budget}: {name}")
            units = [unit_of(made, each, settings, budget) for each in blocks(group, len(six))]
            if budget != effects.BUDGETS[0] and units[0].iterations == settings.iterations:
                found[budget, name] = found[effects.BUDGETS[0], name]  # the very same runs
                continue
            write_netcdf(ended(units, settings), file)
        found[budget, name] = xr.load_dataset(file, engine="h5netcdf")
    ds = gathered(found, settings)
    for name, scenes in (("six", six), ("random", drawn)):
        part = ds.sel(scenario=[scene.name for scene in scenes])
        made = part["fitness"].notnull().any(("budget", "variant", "scenario"))
        work.artefacts.keep(f"ablation_{name}", part.isel(run=made.values))


def blocks(group: Group, size: int) -> Iterator[Group]:
    """So many scenes at a time, in arrays of one shape: they share a compiled program.

    The last ones are as many, too: some of them have been there before.
    """
    count = len(group.scenarios)
    for first in range(0, count, size):
        there = slice(min(first, count - size), min(first, count - size) + size)
        problems = jax.tree.map(lambda leaf, there=there: leaf[there], group.problems)
        yield Group(group.scenarios[there], problems)


def unit_of(made: Switches, group: Group, settings: Settings, budget: str) -> Unit:
    """One variant on some scenes: planned as what a person would call, run in the one program."""
    optimizer = js.sdbo(**made._asdict())
    unit = Unit.plan(group, optimizer, settings.iterations, settings.population, budget)
    return unit._replace(optimizer=switched(made))


def ended(units: Sequence[Unit], settings: Settings) -> xr.Dataset:
    """How the runs of one variant ended: the first unit has more of them, as many at a time."""
    done: list[xr.Dataset] = []
    for number, unit in enumerate(units):
        runs = settings.runs_of_random if number else settings.runs
        for first in range(0, runs, settings.runs_of_random):
            pair = range(first, first + settings.runs_of_random)
            ds = unit.compute(settings.seed, pair)
            there = {name for each in done if number for name in each["scenario"].values}
            new = [name for name in ds["scenario"].values.tolist() if name not in there]
            done.append(ds.sel(scenario=new))
    whole = dataset.merge(done)
    kept = whole[["fitness", "collisions", "violations", "evaluations"]]
    return kept.isel(algorithm=0, drop=True)


def gathered(found: Mapping[tuple[str, str], xr.Dataset], settings: Settings) -> xr.Dataset:
    """Variants beside each other, in both budgets."""
    join = {"data_vars": "all", "coords": "minimal", "join": "exact", "compat": "equals"}
    variants = pd.Index([effects.label(made) for made in VARIANTS], name="variant")
    rows = [
        xr.concat([found[budget, each] for each in variants], variants, **join)
        for budget in effects.BUDGETS
    ]
    whole = xr.concat(rows, pd.Index(effects.BUDGETS, name="budget"), **join)
    told = {"settings": json.dumps(settings._asdict()), **dataset.provenance()}
    return whole.drop_attrs().assign_attrs(told)


def draw(artefacts: Artefacts) -> Page:
    """Effects with intervals, and all variants."""
    sets = {name: artefacts.dataset(f"ablation_{name}") for name in effects.SETS}
    sets = {name: ds for name, ds in sets.items() if ds.sizes["scenario"]}
    found = effects.effects_of(sets)
    return Page(
        {"ablation": effects.figure(found)},
        {
            "ablation": effects.main_table(found, sets),
            "ablation-pairs": effects.pair_table(found),
            "ablation-variants": effects.variant_table(sets),
        },
        effects.findings(found, sets),
    )
