"""evosax as its users write it: ask and tell in a scan, mapped over the runs, one compiled program.

It knows no bounds. Variables are measured so that they are between -5 and 5, for which its default
steps are meant, and it is told the admissible points that were evaluated in place of its
candidates.
"""

import functools
import inspect

import jax
import jax.numpy as jnp
import numpy as np
from evosax.algorithms import algorithms

from benchmarks.peers.task import Found, Peer, Task
from jaxsusp.problem.problem import Problem

SIDE = 5.0


@functools.lru_cache(maxsize=32)
def _program(name: str, dim: int, iterations: int, population: int):
    """All runs as one program, with the candidates that a run of it evaluates."""
    algorithm = algorithms[name](population, jnp.zeros(dim))
    params, asked = algorithm.default_params, []

    def run(problem: Problem, key: jax.Array) -> jax.Array:
        low, span = problem.low, problem.high - problem.low

        def evaluate(measured: jax.Array) -> tuple[jax.Array, jax.Array]:
            asked.append(len(measured))
            x = problem.repair(low + span * (measured / SIDE + 1) / 2)
            return SIDE * (2 * (x - low) / span - 1), problem.evaluate(x)

        def step(state, key):
            key_ask, key_tell = jax.random.split(key)
            candidates, state = algorithm.ask(key_ask, state, params)
            asked.append(-iterations)  # the next are evaluated in every iteration
            x, fitness = evaluate(candidates)
            return algorithm.tell(key_tell, x, fitness, state, params)[0], None

        key_sample, key_init, key_steps = jax.random.split(key, 3)
        first = jax.random.uniform(key_sample, (population, dim), minval=-SIDE, maxval=SIDE)
        x, fitness = evaluate(first)
        if "population" in inspect.signature(type(algorithm).init).parameters:
            state = algorithm.init(key_init, x, fitness, params)
        else:
            state = algorithm.init(key_init, x[fitness.argmin()], params)
        state, _ = jax.lax.scan(step, state, jax.random.split(key_steps, iterations))
        return low[0] + span[0] * (state.best_solution / SIDE + 1) / 2

    return jax.jit(jax.vmap(run, in_axes=(None, 0))), asked


def _go(name: str):
    def go(task: Task) -> Found:
        sizes = task.problem.dim, task.iterations, task.population
        program, asked = _program(name, *sizes)
        keys = jax.vmap(jax.random.key)(jnp.arange(task.runs))
        x = np.asarray(program(task.problem, keys))
        return Found(x, task.runs * _evaluations(asked))

    return go


def _evaluations(asked: list[int]) -> int:
    """Candidates of a run by what its tracing met: a negative number tells how often the next."""
    first, repeated, count = asked[:3]
    return first - repeated * count


PEERS = [
    Peer("evosax", name, ours, _go(name), compiled=True)
    for name, ours in (
        ("PSO", "pso"),
        ("SimpleGA", "ga"),
        ("DifferentialEvolution", "jde"),
        ("CMA_ES", "cmaes"),
    )
]
