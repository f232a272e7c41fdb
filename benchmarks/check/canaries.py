"""What is timed of a tree: run as a script in a process of its own, with that tree's package.

It calls nothing but public names that older trees have as well. Prints a JSON object of seconds.
"""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

RUNS, ITERATIONS, POPULATION, CANDIDATES = 20, 50, 30, 600


def fitness() -> Callable[[], Any]:
    """A population's fitness, in the scene with ten obstacles."""
    import jax
    import jax.numpy as jnp
    import numpy as np

    import jaxsusp as js

    scenario = js.load_scenario("scenario-6")
    problem = js.Problem.from_scenario(scenario, search="box", dtype=np.float32)
    problem = jax.tree.map(jnp.asarray, problem)
    unit = jax.random.uniform(jax.random.key(0), (CANDIDATES, len(problem.lower)), jnp.float32)
    x = problem.lower + (problem.upper - problem.lower) * unit
    evaluate = jax.jit(lambda problem, x: jax.vmap(problem.fitness)(x))

    def work() -> None:
        for _ in range(200):
            found = evaluate(problem, x)
        found.block_until_ready()

    return work


def optimiser() -> Callable[[], Any]:
    """A batch of runs of SDBO."""
    import numpy as np

    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    problem = js.Problem.from_scenario(scenario, search="box", dtype=np.float32)
    sizes = {"runs": RUNS, "iterations": ITERATIONS, "population": POPULATION}
    return lambda: js.minimize(problem, js.sdbo(), seed=0, **sizes)


def free_space() -> Callable[[], Any]:
    """The free space of a scene, not looked up."""
    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    return lambda: js.free_space(scenario, cache=False)


def plan() -> Callable[[], Any]:
    """A plan with its free space at hand, played in simulation."""
    import jaxsusp as js

    scenario = js.load_scenario("scenario-1")
    return lambda: js.plan(scenario, runs=4, iterations=100)


def start_up() -> Callable[[], Any]:
    """The command line's help, in a process of its own."""
    quiet = {"check": True, "stdout": subprocess.DEVNULL}
    return lambda: subprocess.run([sys.executable, "-P", "-m", "jaxsusp", "--help"], **quiet)


def loading() -> Callable[[], Any]:
    """All that a comparison imports, in a process of its own."""
    command = [sys.executable, "-P", "-c", "import jaxsusp; jaxsusp.compare"]
    return lambda: subprocess.run(command, check=True)


CANARIES = {
    each.__name__.replace("_", "-"): each
    for each in (fitness, optimiser, free_space, plan, start_up, loading)
}

REPEATS = 3


def least(work: Callable[[], Any], repeats: int = REPEATS) -> float:
    """Seconds of the quickest of several calls after a first one."""
    work()
    times = []
    for _ in range(repeats):
        clock = time.perf_counter()
        work()
        times.append(time.perf_counter() - clock)
    return min(times)


def main(tree: str, *names: str) -> None:
    """Time some of them.

    Args:
        tree: a folder that the package has to come from.
        names: of canaries.
    """
    import jaxsusp

    place = Path(jaxsusp.__file__).resolve()
    if not place.is_relative_to(Path(tree).resolve()):
        sys.exit(f"the package comes from {place.parent}, not from {tree}")
    os.environ["JAX_PLATFORMS"] = "cpu"
    print(json.dumps({name: least(CANARIES[name]()) for name in names}))


if __name__ == "__main__":
    main(*sys.argv[1:])
