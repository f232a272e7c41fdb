"""All instances of a function at once, and every evaluation of theirs on record.

A run is a lane of one compiled program: instances are mapped over and shared among the devices,
the function's number is not mapped, so that one program per algorithm and dimension serves all 24.
What an optimiser evaluates is listened to while its step is traced: points and values leave the
program as outputs, in the order in which they are asked for. Running times are therefore exact.
"""

import functools
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, PartitionSpec

from jaxsusp._types import Array, Float, Key
from jaxsusp.optim.base import Optimizer, require_compiled
from jaxsusp.optim.loop import count_evaluations, run_key
from jaxsusp.problem.problem import Problem
from jaxsusp.studies.bbob.instances import Instance, stacked
from jaxsusp.studies.bbob.record import Record
from jaxsusp.studies.bbob.suite import Landscape, landscape, problem_of

MEMORY = 64 * 2**20
"""Bytes of points and values that a program hands over at once."""

POPULATION = 30
"""Candidates per iteration, the package's default."""


class Course(NamedTuple):
    """How a function is run."""

    dim: int
    instances: tuple[int, ...]
    budget: int  # evaluations of a run
    population: int = POPULATION
    seed: int = 0


class Asked(NamedTuple):
    """Evaluations in their order."""

    x: Float[Array, "*batch asked dim"]
    value: Float[Array, "*batch asked"]


class Outcome(NamedTuple):
    """Records of all instances, and how long they took."""

    records: list[Record]
    seconds_compile: float
    seconds_run: float


def run_function(
    optimizer: Optimizer,
    function: int,
    course: Course,
    report: Callable[[float], None] = lambda share: None,
) -> Outcome:
    """Run an optimiser once on every instance of a function, in float64.

    Run i of function f takes the key of run 1000 f + i, so that it does not depend on what is run
    beside it. A run ends where its function is solved, or with its budget; the optimiser's own
    horizon is the budget in any case.

    Args:
        optimizer: what minimises.
        function: number of the function, 1 to 24.
        course: dimension, instances, budget, population, seed.
        report: called with the share of the budget that is done, after every portion.

    Raises:
        InputError: no such function, dimension or instance, or a population that is too small.
    """
    require_compiled(optimizer)
    drawn = [landscape(function, course.dim, number) for number in course.instances]
    with jax.enable_x64(True):
        at, keys, devices = _lanes(optimizer, function, course, drawn)
        horizon, portions, length = _portions(optimizer, course, drawn[0], len(keys))
        start, go = _programs(devices, course.dim, course.population, horizon, length)
        records = [Record(course.dim, _least(each), course.budget) for each in drawn]
        number = jnp.asarray(function, jnp.int32)

        clock = time.perf_counter()
        state, asked = jax.block_until_ready(start(number, at, optimizer, keys))
        go = go.lower(number, at, optimizer, keys, state, jnp.asarray(1)).compile()
        seconds_compile = time.perf_counter() - clock
        clock = time.perf_counter()
        _note(records, asked)
        for part in range(portions):
            if all(record.ended for record in records):
                break
            begins = jnp.asarray(1 + part * length)
            state, asked = go(number, at, optimizer, keys, state, begins)
            _note(records, asked)
            report((part + 1) / portions)
    return Outcome(records, seconds_compile, time.perf_counter() - clock)


def heard(problem: Problem, call: Callable[[Problem], Any]) -> tuple[Any, Asked]:
    """What `call` makes of a problem, and all that it evaluates meanwhile, in its order."""
    listening = _Listening(problem.fitness)
    found = call(problem.with_fitness(listening))
    x, value = zip(*listening.asked, strict=True)
    return found, Asked(jnp.concatenate(x), jnp.concatenate(value))


class _Listening:
    """A fitness that remembers what it was asked for, and what it said."""

    def __init__(self, fitness: Any):
        self.fitness, self.asked = fitness, []

    def population(self, x: Array) -> Array:
        """Values of many points, by the fitness itself."""
        value = self.fitness.population(x)
        self.asked.append((x, value))
        return value

    def __call__(self, x: Array) -> Array:
        """The value of one point, by the fitness itself."""
        return self.population(x[None])[0]


@functools.lru_cache(maxsize=64)
def _programs(devices: tuple, dim: int, population: int, horizon: int, length: int):
    """Compiled-once entry points: begin all lanes, and advance them by `length` iterations."""
    lanes, everywhere = PartitionSpec("lanes"), PartitionSpec()
    mesh = Mesh(np.asarray(devices), ("lanes",))

    def start(number, at: Instance, optimizer: Optimizer, keys: Key[Array, "lanes"]):
        def one(at: Instance, key):
            problem, key = problem_of(Landscape(number, at), dim), jax.random.fold_in(key, 0)
            return heard(problem, lambda each: optimizer.init(key, each, population, horizon))

        return jax.vmap(one)(at, keys)

    def go(number, at: Instance, optimizer: Optimizer, keys, states, first):
        def one(at: Instance, key, state):
            problem = problem_of(Landscape(number, at), dim)

            def iterate(state, t):
                key_t = jax.random.fold_in(key, t)
                found, asked = heard(problem, lambda each: optimizer.step(key_t, each, state))
                return found[0], asked

            return jax.lax.scan(iterate, state, first + jnp.arange(length))

        return jax.vmap(one)(at, keys, states)

    shard = functools.partial(jax.shard_map, mesh=mesh, out_specs=lanes, check_vma=False)
    arguments = (everywhere, lanes, everywhere, lanes)
    return (
        jax.jit(shard(start, in_specs=arguments)),
        jax.jit(shard(go, in_specs=(*arguments, lanes, everywhere))),
    )


def _lanes(optimizer: Optimizer, function: int, course: Course, drawn: list[Landscape]):
    """Instances and keys of as many lanes as the devices take evenly; the last one fills up."""
    devices = jax.devices()[: len(drawn)]
    spare = -len(drawn) % len(devices)
    runs = jnp.asarray([*course.instances, *course.instances[-1:] * spare]) + 1000 * function
    keys = jax.vmap(functools.partial(run_key, course.seed, optimizer.name))(runs)
    at = [each.at for each in drawn]
    return stacked(at + at[-1:] * spare), keys, tuple(devices)


def _portions(optimizer: Optimizer, course: Course, fitness: Landscape, lanes: int):
    """Iterations of a run, in how many portions, and of how many iterations each."""
    problem = problem_of(fitness, course.dim)
    counted = count_evaluations(optimizer, problem, course.population)
    horizon = max(1, -(-(course.budget - counted.initial) // counted.per_step))
    size = 8 * lanes * counted.per_step * (course.dim + 1)
    portions = max(1, -(-horizon * size // MEMORY))
    return horizon, portions, -(-horizon // portions)


@functools.cache
def _value() -> Callable:
    return jax.jit(lambda fitness: fitness(fitness.at.optimum))


def _least(fitness: Landscape) -> float:
    """What COCO takes for the least value: f at its optimum, f_opt but for rounding."""
    return float(_value()(fitness))


def _note(records: list[Record], asked: Asked) -> None:
    """Tell every record its lane; iterations are flattened, in their order."""
    x, value = np.asarray(asked.x), np.asarray(asked.value)
    for record, points, values in zip(records, x, value, strict=False):
        record.add(points.reshape(-1, x.shape[-1]), values.reshape(-1))
