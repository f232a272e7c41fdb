"""Many settings of the fitness as one batch: every run has weights and κ of its own.

What a setting changes is the sum of Eq. 21 alone, so the physics of all runs is one flat batch of
candidates: hundreds of settings cost no more than as many runs of one.
"""

import functools
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.sharding import Mesh, PartitionSpec

from jaxsusp._types import Array, Float, Int
from jaxsusp.optim.base import Best, Optimizer
from jaxsusp.optim.batch import ONCE
from jaxsusp.optim.loop import advance, begin, run_key
from jaxsusp.problem.flatbatch import one_flat_batch
from jaxsusp.problem.problem import Problem
from jaxsusp.problem.suspension import Suspension


@jax.jit
def _flat_terms(suspension: Suspension, x: Array) -> Array:
    terms = suspension.terms(x.T)
    faults = (terms.collisions + terms.violations).astype(x.dtype)
    return jnp.stack([*terms[:5], faults], axis=1)


_population_terms = one_flat_batch(_flat_terms)


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class Weighted:
    """The suspension's fitness with other weights than its world's."""

    suspension: Suspension
    prices: Array  # (6,): w_1 … w_5, and w_6 κ

    def population(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop"]:
        """Total fitness of many decision vectors."""
        terms = _population_terms(self.suspension, x)
        return (terms * self.prices[None].astype(x.dtype)).sum(axis=1)

    def __call__(self, x: Float[Array, "dim"]) -> Float[Array, ""]:
        """Total fitness of one decision vector."""
        return self.population(x[None])[0]

    def stability(self, x: Float[Array, "pop dim"]) -> Float[Array, "pop waypoints"]:
        """S_c of every waypoint of every candidate (Eq. 18)."""
        return self.suspension.stability(x)


class Found(NamedTuple):
    """The best of every run, host arrays."""

    x: Float[np.ndarray, "settings runs dim"]
    fitness: Float[np.ndarray, "settings runs"]  # by the weights of its setting


def run_settings(
    problem: Problem,
    optimizer: Optimizer,
    prices: Float[np.ndarray, "settings terms=6"],
    runs: Int[np.ndarray, "settings runs"],
    iterations: int,
    population: int,
    seed: int = 0,
) -> Found:
    """Minimise one problem under many weights, some runs each, in one compiled program.

    Args:
        problem: of a scenario, whose own weights and κ do not count.
        optimizer: what minimises.
        prices: w_1 … w_5 and w_6 κ of every setting.
        runs: indices of the runs of every setting; a run of the same index begins with the same
            random numbers whatever the setting, and with those of `js.minimize`.
        iterations: number T.
        population: number N.
        seed: root of all randomness.
    """
    dtype = problem.lower.dtype
    with jax.enable_x64(dtype == np.float64):
        devices, count = jax.devices(), runs.size
        lanes = np.resize(np.arange(count), count + -count % len(devices))
        keys = jax.vmap(functools.partial(run_key, seed, optimizer.name))(
            jnp.asarray(runs.reshape(-1)[lanes])
        )
        each = np.repeat(prices.astype(dtype), runs.shape[1], axis=0)[lanes]
        go = _program(tuple(devices), population, iterations)
        best = go(jax.tree.map(jnp.asarray, problem), optimizer, keys, each)
        x, fitness = np.asarray(best.x)[:count], np.asarray(best.fitness)[:count]
    return Found(x.reshape(*runs.shape, -1), fitness.reshape(runs.shape))


@functools.lru_cache(maxsize=64)
def _program(devices: tuple, population: int, iterations: int):
    """All of it in one call, runs sharded over the devices."""
    per_run, everywhere = PartitionSpec("runs"), PartitionSpec()

    def everything(problem: Problem, optimizer: Optimizer, keys: Array, prices: Array) -> Best:
        def one(key: Array, prices: Array) -> Best:
            this = problem.with_fitness(Weighted(problem.fitness, prices))  # type: ignore[arg-type]
            progress = begin(optimizer, this, key, population, iterations)
            return advance(optimizer, this, key, progress, 1, iterations + 1).state.best

        return jax.vmap(one)(keys, prices)

    shard = jax.shard_map(
        everything,
        mesh=Mesh(np.asarray(devices), ("runs",)),
        in_specs=(everywhere, everywhere, per_run, per_run),
        out_specs=per_run,
        check_vma=False,
    )
    return jax.jit(shard, compiler_options=ONCE)
