"""Small comparisons, and what the tests of all of them ask."""

from typing import NamedTuple

import xarray as xr
from jax.tree_util import Partial

import jaxsusp as js
from jaxsusp.optim.base import Best, NoInfo

SCENARIOS = ("scenario-1", "scenario-3")
SMALL = {"runs": 2, "iterations": 6, "population": 8, "search": "box"}
TIMES = ["seconds_run", "seconds_compile"]


def assert_same_numbers(ds, other):
    xr.testing.assert_identical(
        ds.drop_vars(TIMES).drop_attrs(), other.drop_vars(TIMES).drop_attrs()
    )


def contents(folder):
    return {
        path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def interrupt_after(algorithm):
    def told(event):
        if event.phase == "finished" and event.algorithm == algorithm:
            raise KeyboardInterrupt

    return told


class Holding(NamedTuple):
    """State of an optimiser that hardly does anything."""

    best: Best


def thrifty(name="thrifty", evaluations=2, factor=1.0):
    """An optimiser that spends few evaluations per iteration and keeps its first candidate."""

    def init(factor, key, problem, population, iterations):
        x = problem.sample(key, population)
        return Holding(Best(x[0], problem.evaluate(x)[0]))

    def step(factor, key, problem, state):
        problem.evaluate(problem.sample(key, evaluations))
        return state, NoInfo()

    return js.Optimizer(name, Partial(init, factor), Partial(step, factor))


def again(folder, algorithms=("pso", "ga"), **changed):
    scenarios = changed.pop("scenarios", "scenario-1")
    settings = {**SMALL, "output": folder, "resume": True, **changed}
    return js.compare(scenarios, algorithms, **settings)
