"""Many scenarios planned in one call, here or by the workers of a cluster: the same plans."""

import inspect
import os
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, nullcontext
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from jaxsusp._files import sole_writer
from jaxsusp.cluster.employment import employed
from jaxsusp.cluster.jobs import Job
from jaxsusp.errors import InputError, require, require_count, require_counts, require_seed
from jaxsusp.planning.document import stem
from jaxsusp.planning.many.kept import Folder, Planned, Task
from jaxsusp.planning.planner import plan
from jaxsusp.scenario.scenario import Named, Scenario, load_scenario

if TYPE_CHECKING:
    from jaxsusp.cluster.client import Cluster


class Step(NamedTuple):
    """What a progress callback is told."""

    phase: str  # "planning", "finished", "there already", "note"
    name: str  # of a scenario
    done: int
    total: int
    planned: Planned | None = None  # of what is finished
    note: str = ""


Progress = Callable[[Step], None]


def plan_many(
    scenarios: Sequence[Scenario | Named],
    *,
    output: str | os.PathLike[str] | None = None,
    resume: bool = False,
    workers: Any = None,
    progress: Progress | None = None,
    **settings: Any,
) -> tuple[Planned, ...]:
    """Plan many scenarios, each as `jaxsusp.plan` would by itself.

    A scenario that cannot be planned, or that fails, is told in its place and stops no other.

    Args:
        scenarios: tasks, their names or files.
        output: folder for a plan file of each, NAME.plan.json, and `plans.json`, which lists them;
            both are written as soon as a plan is finished, so that an interrupt loses none.
        resume: go on from what is in `output`: what is finished there is not planned again.
        workers: who plans, see `jaxsusp.compare`: None for this process, a number of processes of
            this machine, a scheduler, a client. A scenario is a task.
        progress: called when something happens, see `Step`.
        settings: those of `jaxsusp.plan` (algorithm, ends, runs, seed, …), for all of them.

    Returns:
        What became of every scenario, in the order in which they were given.

    Raises:
        InputError: bad settings, two scenarios of one name, a folder that cannot be used or that
            holds plans of other settings. Nothing has been planned then.
            Or no scheduler or worker is there, or none any more: what is finished is kept.
    """
    require(bool(scenarios), "scenarios: none given; name at least one")
    require(not resume or output is not None, "resume = True: give the output folder to resume")
    asked = _settings(settings)
    tasks = _tasks(scenarios)
    told = {"algorithm": _named(asked["algorithm"]), "jaxsusp": version("jaxsusp")}
    folder = Folder(output, asked | told)
    tell = progress or (lambda step: None)

    def said(message: str) -> None:
        tell(Step("note", "", 0, len(tasks), note=message))

    claimed = nullcontext() if output is None else sole_writer("output", output)
    with claimed, employed(workers, said) as cluster:
        found = folder.finished(tasks) if resume else {}
        for done, planned in enumerate(found.values(), 1):
            tell(Step("there already", planned.name, done, len(tasks), planned))
        left = [number for number in range(len(tasks)) if number not in found]

        def begun(number: int) -> None:
            tell(Step("planning", tasks[number].name, len(found), len(tasks)))

        with closing(_planned(tasks, left, asked, cluster, begun)) as results:
            for number, planned in results:
                found[number] = planned = folder.keep(tasks[number], planned)
                tell(Step("finished", planned.name, len(found), len(tasks), planned))
    return tuple(found[number] for number in range(len(tasks)))


_OURS = ("scenario", "progress")
"""Of a plan's arguments those that are no settings."""


def _settings(given: Mapping[str, Any]) -> dict[str, Any]:
    """Settings of `plan` with its defaults; what is wrong whatever the scenario is refused here."""
    known = [each for each in inspect.signature(plan).parameters if each not in _OURS]
    for name in given:
        require(name in known, f"{name}: is no setting of a plan; there are {', '.join(known)}")
    bound = inspect.signature(plan).bind("", **given)
    bound.apply_defaults()
    found = {name: value for name, value in bound.arguments.items() if name in known}
    require_counts(**{name: found[name] for name in ("runs", "iterations", "population")})
    require_counts(waypoints=found["waypoints"])
    require_count("samples", found["samples"], least=3)
    require_count("retries", found["retries"], least=0)
    require_seed(found["seed"])
    return found


def _named(algorithm: Any) -> str:
    return algorithm if isinstance(algorithm, str) else algorithm.name


def _tasks(scenarios: Sequence[Scenario | Named]) -> list[Task]:
    """Everything loaded; two that would be one file are refused."""
    tasks: dict[str, Task] = {}
    for each in scenarios:
        try:
            scenario = load_scenario(each)
            task = Task(scenario.name, each, scenario)
        except InputError as error:
            name = each.name if isinstance(each, Scenario) else Path(each).stem
            task = Task(name, each, None, str(error))
        key = stem(task.name)
        if key in tasks:
            first, second = (_source(one) for one in (tasks[key], task))
            raise InputError(
                f"scenarios: {first} and {second} would both be {key}.plan.json; give every "
                "scenario once, under its own name"
            )
        tasks[key] = task
    return [*tasks.values()]


def _source(task: Task) -> str:
    return repr(task.name) if isinstance(task.source, Scenario) else os.fspath(task.source)


def _planned(
    tasks: Sequence[Task],
    left: Sequence[int],
    settings: dict[str, Any],
    cluster: "Cluster | None",
    begun: Callable[[int], None],
) -> Generator[tuple[int, Planned], None, None]:
    """What becomes of every task that is left, in the order they finish."""
    able = []
    for number in left:
        if tasks[number].scenario is None:
            yield number, Planned(tasks[number].name, None, tasks[number].failure, 0.0)
        else:
            able.append(number)
    if cluster is None:
        for number in able:
            begun(number)
            yield number, attempt(settings, tasks[number].scenario)
        return
    jobs = [
        Job(f"planning {tasks[number].name}", attempt, settings, (tasks[number].scenario,))
        for number in able
    ]
    with closing(cluster.run(jobs)) as results:  # or what is not finished goes on
        for i, planned in results:
            yield able[i], planned


def attempt(settings: dict[str, Any], scenario: Scenario) -> Planned:
    """Plan one scenario; a failure of whatever kind is its own, and stops no other."""
    clock = time.perf_counter()
    found, failure = None, ""
    try:
        found = replace(plan(scenario, **settings))  # without what it has worked out meanwhile
    except InputError as error:
        failure = str(error)
    except Exception as error:
        failure = f"failed with {type(error).__name__}: {error}"
    return Planned(scenario.name, found, failure, time.perf_counter() - clock)
