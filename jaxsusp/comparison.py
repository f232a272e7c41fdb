"""Compare algorithms on scenarios in one call (the main job)."""

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from jaxsusp import results
from jaxsusp.errors import InputError, require, require_count, require_known
from jaxsusp.optim.base import Optimizer
from jaxsusp.optim.registry import PUBLISHED
from jaxsusp.optim.registry import algorithms as algorithms_of
from jaxsusp.scenario import Scenario, load_scenario
from jaxsusp.scenario import scenarios as built_in
from jaxsusp.store import Store
from jaxsusp.workunit import Unit, stack_scenarios

BUDGETS = ("iterations", "evaluations")


class Event(NamedTuple):
    """What a progress callback is told."""

    algorithm: str
    phase: str  # "resumed", "compiling", "running" or "finished"
    done: int  # fitness evaluations done …
    total: int  # … of the whole comparison


def compare(
    scenarios: Sequence[str | os.PathLike[str] | Scenario] = built_in(),
    algorithms: Sequence[str | Optimizer] = PUBLISHED,
    runs: int = 20,
    iterations: int = 500,
    population: int = 30,
    seed: int = 0,
    *,
    budget: str = "iterations",
    search: str = "box",
    waypoints: int = 5,
    samples: int = 40,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
    progress: Callable[[Event], None] = lambda event: None,
) -> xr.Dataset:
    """Run every algorithm on every scenario, several independent runs each, as array programs.

    Args:
        scenarios: built-in names, paths of scenario files, or scenarios.
        algorithms: names (see `jaxsusp.ALGORITHMS`) or optimisers.
        runs: independent runs of every algorithm on every scenario.
        iterations: iterations per run.
        population: candidates per iteration.
        seed: root of all randomness.
        budget: "iterations" gives every algorithm as many iterations (the paper); "evaluations"
            as many as fit into population × (iterations + 1) fitness evaluations.
        search: rule that keeps waypoints inside, see `jaxsusp.problem.SEARCHES`.
        waypoints: free waypoints m between start and goal; D = 3m.
        samples: trajectory samples n.
        output: folder for `compare.nc`; every finished unit is kept there at once, so that an
            interrupt loses nothing that finished. None saves nothing.
        resume: take finished runs from `output` instead of computing them again; with more
            `runs` than before only the further ones are computed.
        progress: called when something happens, see `Event`.

    Returns:
        The dataset described by `jaxsusp.results.VARIABLES`.

    Raises:
        InputError: bad settings, or runs to resume that were made with others.
    """
    for name, value in (("runs", runs), ("iterations", iterations), ("population", population)):
        require_count(name, value)
    require_count("seed", seed, least=0)
    require_known("budget", budget, BUDGETS)
    require(not resume or output is not None, "resume = True: give the output folder to resume")
    optimizers = algorithms_of(algorithms)
    chosen = _distinct(scenarios)
    units = [
        Unit.plan(group, optimizer, iterations, population, budget)
        for optimizer in optimizers
        for group in stack_scenarios(chosen, waypoints, samples, search)
    ]
    settings = {
        "scenarios": {scenario.name: scenario.digest for scenario in chosen},
        "iterations": iterations,
        "population": population,
        "seed": seed,
        "waypoints": waypoints,
        "samples": samples,
        "search": search,
        "budget": budget,
    }
    store = Store(
        None if output is None else Path(output),
        {
            "settings": json.dumps(settings),
            "scenario_files": json.dumps({each.name: each.to_toml() for each in chosen}),
            **results.provenance(),
        },
    )
    return store.complete(
        _all_runs(units, runs, seed, iterations, store, store.finished() if resume else [], progress)
    )


def _all_runs(
    units: list[Unit],
    runs: int,
    seed: int,
    horizon: int,
    store: Store,
    finished: list[xr.Dataset],
    progress: Callable[[Event], None],
) -> list[xr.Dataset]:
    """Every run of every unit: taken from what is finished, else computed and stored."""
    total, done, parts = sum(unit.cost(runs) for unit in units), 0, []
    for unit in units:
        kept, missing = _still_missing(unit, range(runs), finished)
        parts += kept
        done += unit.cost(runs - len(missing))
        name = unit.optimizer.name
        if not missing:
            progress(Event(name, "resumed", done, total))
            continue

        def report(iterations: int, unit=unit, name=name, done=done, missing=missing) -> None:
            share = unit.cost(len(missing)) * iterations // unit.iterations
            progress(Event(name, "running", done + share, total))

        progress(Event(name, "compiling", done, total))
        part = unit.compute(seed, missing, horizon, report)
        store.save(part)
        parts.append(part)
        done += unit.cost(len(missing))
        progress(Event(name, "finished", done, total))
    return parts


def _still_missing(
    unit: Unit, runs: range, finished: list[xr.Dataset]
) -> tuple[list[xr.Dataset], list[int]]:
    """Finished datasets of a unit, cut to the runs asked for, and the runs that they lack."""
    kept, missing = [], set(runs)
    for ds in finished:
        if unit.covers(ds):
            there = ds["run"].values[ds["fitness"].notnull().all(("scenario", "algorithm"))]
            useful = sorted(missing.intersection(there.tolist()))
            kept += [ds.sel(run=useful)] if useful else []
            missing.difference_update(useful)
    return kept, sorted(missing)


def _distinct(choices: Sequence[str | os.PathLike[str] | Scenario]) -> list[Scenario]:
    """Load scenarios and refuse two of one name, which label the dataset."""
    chosen = [each if isinstance(each, Scenario) else load_scenario(each) for each in choices]
    names = [scenario.name for scenario in chosen]
    require(bool(names), "scenarios: none given; name at least one")
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"scenarios = {names}: {name!r} is there twice; give every scenario its own name"
            )
    return chosen
