"""Compare algorithms on scenarios in one call (the main job)."""

import json
import os
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jax
import numpy as np
import xarray as xr

from jaxsusp.cluster.employment import employed
from jaxsusp.comparison import dataset, timebudget
from jaxsusp.comparison.choices import BUDGETS
from jaxsusp.comparison.chunks import Chunk, computed, cut, estimate, is_long, pace, usual_size
from jaxsusp.comparison.events import Event, Tally
from jaxsusp.comparison.kept.store import Store
from jaxsusp.comparison.workunit import Unit, stack_scenarios
from jaxsusp.errors import (
    InputError,
    require,
    require_counts,
    require_known,
    require_label,
    require_seed,
)
from jaxsusp.optim.base import AnyOptimizer
from jaxsusp.optim.choices import PUBLISHED
from jaxsusp.optim.registry import algorithms as algorithms_of
from jaxsusp.problem.choices import SEARCHES
from jaxsusp.scenario.builtin import scenarios as built_in
from jaxsusp.scenario.scenario import Scenario, load_scenario

if TYPE_CHECKING:
    from jaxsusp.cluster.client import Cluster


def compare(
    scenarios: str | Sequence[str | os.PathLike[str] | Scenario] = built_in(),
    algorithms: str | Sequence[str | AnyOptimizer] = PUBLISHED,
    runs: int = 20,
    iterations: int = 500,
    population: int = 30,
    seed: int = 0,
    *,
    budget: str = "iterations",
    polish: bool = False,
    search: str = SEARCHES[0],
    waypoints: int = 5,
    samples: int = 40,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
    chunk: int | None = None,
    workers: Any = None,
    progress: Callable[[Event], None] | None = None,
) -> xr.Dataset:
    """Run every algorithm on every scenario, several independent runs each, as array programs.

    Args:
        scenarios: built-in names, paths of scenario files, or scenarios.
        algorithms: names (see `jaxsusp.ALGORITHMS`), "all" of them, names of other libraries' (such
            as "evosax:CMA_ES" or "pymoo:GA"), or optimisers.
        runs: independent runs of every algorithm on every scenario.
        iterations: iterations per run.
        population: candidates per iteration.
        seed: root of all randomness.
        budget: "iterations" gives every algorithm as many iterations (the paper); "evaluations"
            as many as fit into population × (iterations + 1) fitness evaluations; "time" as many
            as fit into the time that the slowest takes for `iterations`, measured here and now,
            see `comparison.timebudget`. What was made is in the dataset's `iterations`.
        polish: whether the best of every run of every algorithm is improved along a gradient at
            the end, see `optim.polish`. It costs all of them equally much, `evaluations_polish`,
            which comes on top of any budget; `evaluations` and the seconds count it, and
            `history` ends before it.
        search: what waypoints are kept in: "free-space", "ellipsoid" or "box", see
            `problem.search`; the first two compute every scenario's free space once.
        waypoints: free waypoints m between start and goal; D = 3m.
        samples: trajectory samples n.
        output: folder for `compare.nc`; every finished unit is kept there at once, so that an
            interrupt loses nothing that finished. None saves nothing.
        resume: go on from what is in `output`: only runs that are not finished are computed, and
            nothing finished is lost, so that runs or algorithms beyond those asked for stay in
            the dataset.
        chunk: runs that are computed, and kept, at a time; default 250, or a two-hundredth of all.
            It changes no number.
        workers: who computes: None: this process; a number: so many processes of this machine; the
            address of a Dask scheduler, or its file; a `distributed.Client`; or a
            `jaxsusp.cluster.choices.Place`, with certificates.
        progress: called when something happens, see `Event`.

    Returns:
        The dataset described by `jaxsusp.comparison.dataset.VARIABLES`. Above 1000 runs `output`
        holds a file for every chunk and `compare.json`, which lists them; histories have 51 of
        their iterations, that of the best run all of them, and they are read when they are asked
        for, as decision vectors are.

    Raises:
        InputError: bad settings, a folder that cannot be written or that another process writes
            to, or finished runs that were made with other settings. Nothing has been written then.
            Or no scheduler or worker is there, or none any more: finished chunks are kept.
    """
    require_counts(runs=runs, iterations=iterations, population=population)
    require_seed(seed)
    require_known("budget", budget, BUDGETS)
    if chunk is not None:
        require_counts(chunk=chunk)
    require(not resume or output is not None, "resume = True: give the output folder to resume")
    optimizers = _optimizers(algorithms)
    chosen = _distinct(scenarios)

    def tell(event: Event) -> None:
        if progress is not None:
            progress(event)

    def told(scenario: Scenario) -> None:
        if search != "box":
            tell(Event(scenario.name, "free space", 0, 1))

    groups = stack_scenarios(chosen, waypoints, samples, search, told)
    units = [
        Unit.plan(group, optimizer, iterations, population, budget, polish)
        for optimizer in optimizers
        for group in groups
    ]
    _require_begun(units)
    settings = {
        "iterations": iterations,
        "population": population,
        "seed": seed,
        "waypoints": waypoints,
        "samples": samples,
        "search": search,
        "budget": budget,
        "polish": polish,
        "scenarios": {scenario.name: scenario.digest for scenario in chosen},
    }
    store = Store(
        None if output is None else Path(output),
        {
            "settings": json.dumps(settings),
            "seed": seed,
            "coefficients": json.dumps({each.name: _coefficients(each) for each in optimizers}),
            "scenario_files": json.dumps({each.name: each.to_toml() for each in chosen}),
            **dataset.provenance(),
        },
        is_long(runs),
    )
    size = usual_size(runs) if chunk is None else chunk

    def said(message: str) -> None:
        tell(Event("", "note", 0, 1, note=message))

    with store.claimed(resume), employed(workers, said) as cluster:
        finished = store.finished([group.names for group in groups]) if resume else []
        if budget == "time":

            def timed(unit: Unit) -> float:
                tell(Event(unit.optimizer.name, "timing", 0, 1))
                return pace(unit, seed, min(runs, size), cluster)

            units, allotted = timebudget.allot(units, finished, timed)
            _require_begun(units)
            store.attributes[dataset.TIME_BUDGET] = json.dumps(allotted)
        work = [(unit, unit.missing(runs, finished)) for unit in units]
        tally = Tally(work, runs, tell, workers_compile=cluster is not None)
        for unit, missing in work:
            if not missing:
                tally.tell(unit, "resumed")
        chunks = [each for work_of in work for each in cut(*work_of, size, store.is_long)]
        if is_long(runs) and chunks:
            needed = estimate(chunks, seed, cluster)
            said(f"{runs} runs in {len(chunks)} chunks: {needed}")
            if output is not None:
                needed.require_room(Path(output))
        ds = store.whole([*_compute_missing(chunks, seed, store, cluster, tally), *finished])
        ds = _sorted(ds, [each.name for each in chosen], [each.name for each in optimizers])
        store.complete(ds)
        return ds


def _require_begun(units: Sequence[Unit]) -> None:
    for unit in units:
        unit.require_begun()


def _compute_missing(
    chunks: Sequence[Chunk],
    seed: int,
    store: Store,
    cluster: "Cluster | None",
    tally: Tally,
) -> list[xr.Dataset]:
    """Compute what is not finished, chunk by chunk, and store each at once."""
    found = []
    with closing(computed(chunks, seed, cluster, tally.report)) as results:  # or they are cancelled
        for chunk, ds in results:
            part = ds.assign_attrs({**store.attributes, **ds.attrs})
            store.save(part)
            if not store.is_long:  # what is long does not fit into memory
                found.append(part)
            tally.finished(chunk)
    return found


def _sorted(ds: xr.Dataset, scenarios: list[str], algorithms: list[str]) -> xr.Dataset:
    """In the order asked for; algorithms that were there before come last."""
    there = ds["algorithm"].values.tolist()
    others = [name for name in there if name not in algorithms]
    return ds.sel(scenario=scenarios, algorithm=[*algorithms, *others])


def _optimizers(choices: str | Sequence[str | AnyOptimizer]) -> list[AnyOptimizer]:
    """Optimisers with distinct names that can label the dataset."""
    optimizers = algorithms_of(choices)
    for optimizer in optimizers:
        require_label("algorithm", optimizer.name)
    return optimizers


def _coefficients(optimizer: AnyOptimizer) -> list:
    """What an optimiser's name does not tell, to notice when it changes.

    Numbers, and behind them what an algorithm of another library is from.
    """
    numbers = [np.asarray(leaf).tolist() for leaf in jax.tree.leaves(optimizer)]
    return [*numbers, optimizer.origin] if optimizer.origin else numbers


def _distinct(choices: str | Sequence[str | os.PathLike[str] | Scenario]) -> list[Scenario]:
    """Load scenarios and refuse two of one name, which label the dataset."""
    chosen: dict[str, tuple[Scenario, str]] = {}
    for choice in [choices] if isinstance(choices, str) else choices:
        scenario = load_scenario(choice)
        source = repr(choice.name) if isinstance(choice, Scenario) else os.fspath(choice)
        require_label(f"name of scenario {source}", scenario.name)
        if scenario.name in chosen:
            other = chosen[scenario.name][1]
            raise InputError(
                f"scenarios: {other} and {source} are both named {scenario.name!r}; give every "
                "scenario once, under its own name"
            )
        chosen[scenario.name] = scenario, source
    require(bool(chosen), "scenarios: none given; name at least one")
    return [scenario for scenario, _ in chosen.values()]
