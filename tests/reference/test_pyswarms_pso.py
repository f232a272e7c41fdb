"""The particle swarm against pyswarms' `GlobalBestPSO` at the same settings.

Inertia falls from 0.9 to 0.4 at the same rate, both accelerations are 2, a velocity is at most a
fifth of the range and begins at zero, positions are clipped to the bounds. What pyswarms lacks,
stopping a particle in the one direction in which a bound holds it, is added to its boundary
handler; everything else is its own. Once runs are compared by what they find, and once step by
step, with pyswarms given our random numbers.
"""

import functools

import jax
import numpy as np
import pytest
from equivalence import DIM, FUNCTIONS, POPULATION, Function, compare, our_fitness, problem_of
from pyswarms.backend.handlers import BoundaryHandler, OptionsHandler
from pyswarms.single.global_best import GlobalBestPSO

import jaxsusp as js

ITERATIONS = 300
THEIR_RUNS = 240


class StoppingHandler(BoundaryHandler):
    """Clips positions to the nearest bound, and a clipped coordinate loses its velocity."""

    def __init__(self, optimizer: GlobalBestPSO):
        super().__init__(strategy="nearest")
        self.optimizer = optimizer

    def __call__(self, position, bounds, **kwargs):
        clipped = super().__call__(position, bounds, **kwargs)
        swarm, free = self.optimizer.swarm, clipped == position
        swarm.velocity = np.where(free, swarm.velocity, 0.0)
        return clipped


def pyswarms_run(function: Function, seed: int) -> GlobalBestPSO:
    """One run of pyswarms, ready for `optimize`.

    Its k-th position update, from k = 0, takes inertia w(k) on a line from `start` to `end` over
    one update more than is evaluated; ours is 0.9 - 0.5 (k + 1) / T.
    """
    np.random.seed(seed)  # noqa: NPY002  the only source pyswarms draws from
    limit = np.full(DIM, function.bound)
    start = 0.9 - 0.5 / ITERATIONS
    end = start - 0.5 * (ITERATIONS + 1) / ITERATIONS
    optimizer = GlobalBestPSO(
        POPULATION,
        DIM,
        options={"c1": 2.0, "c2": 2.0, "w": start},
        bounds=(-limit, limit),
        velocity_clamp=(-0.4 * limit, 0.4 * limit),
    )
    optimizer.oh = functools.partial(
        OptionsHandler(strategy={"w": "lin_variation"}), end_opts={"w": end}
    )
    optimizer.bh = StoppingHandler(optimizer)
    optimizer.swarm.velocity = np.zeros((POPULATION, DIM))
    return optimizer


def found_by_pyswarms(function: Function) -> np.ndarray:
    """Final fitness of its runs; its first iteration evaluates the initial positions."""
    objective = functools.partial(function.value, xp=np)
    return np.array(
        [
            pyswarms_run(function, seed).optimize(objective, ITERATIONS + 1, verbose=False)[0]
            for seed in range(THEIR_RUNS)
        ]
    )


@pytest.fixture(scope="module")
def pyswarms_runs() -> dict[str, np.ndarray]:
    return {name: found_by_pyswarms(function) for name, function in FUNCTIONS.items()}


def test_pyswarms_runs_at_the_settings_stated():
    optimizer = pyswarms_run(FUNCTIONS["sphere"], seed=0)
    seen = []
    handle = optimizer.oh
    optimizer.oh = lambda *args, **kwargs: seen.append(handle(*args, **kwargs)) or seen[-1]
    optimizer.optimize(lambda x: -(x**2).sum(axis=-1), ITERATIONS + 1, verbose=False)
    w = [options["w"] for options in seen[:ITERATIONS]]
    np.testing.assert_allclose(w, 0.9 - 0.5 * np.arange(1, ITERATIONS + 1) / ITERATIONS)
    assert {(options["c1"], options["c2"]) for options in seen} == {(2.0, 2.0)}
    positions, velocities = (
        np.array(h) for h in (optimizer.pos_history, optimizer.velocity_history)
    )
    assert not velocities[0].any()
    assert np.abs(velocities).max() == pytest.approx(0.2 * 2 * 5.12)
    assert np.abs(positions).max() == 5.12
    moved = np.isclose(np.diff(positions, axis=0), velocities[1:], rtol=0, atol=1e-12)
    assert (~moved).any()
    assert (velocities[1:][~moved] == 0).all()
    assert (np.abs(positions[1:][~moved]) == 5.12).all()


def test_every_step_is_that_of_pyswarms(monkeypatch):
    """With the same draws both swarms move alike; the optimum beyond a corner tries the bounds."""
    steps = 60
    corner = Function(
        lambda x, xp: ((x[..., :5] - 6) ** 2).sum(-1) + (x[..., 5:] ** 2).sum(-1), 5.12
    )
    problem, ours = problem_of(corner), js.pso()
    keys = jax.random.split(jax.random.key(5), ITERATIONS + 1)
    states = [ours.init(jax.random.key(4), problem, POPULATION, ITERATIONS)]
    step = jax.jit(lambda key, state: ours.step(key, problem, state)[0])
    for key in keys[:steps]:
        states.append(step(key, states[-1]))

    theirs = pyswarms_run(corner, seed=0)
    theirs.swarm.position = np.asarray(states[0].x)
    shape = (2, POPULATION, DIM)  # the cognitive draws, then the social ones
    draws = iter(np.concatenate([jax.random.uniform(key, shape) for key in keys]))
    monkeypatch.setattr(np.random, "uniform", lambda *_: next(draws))
    theirs.optimize(functools.partial(corner.value, xp=np), ITERATIONS + 1, verbose=False)

    x, velocity = (np.array([getattr(each, name) for each in states]) for name in ("x", "velocity"))
    held = (np.abs(x[1:]) == corner.bound) & (velocity[1:] == 0)
    error = np.abs(x - theirs.pos_history[: steps + 1]).max()
    print(f"\nPSO: {held.sum()} coordinates held by a bound in {steps} steps, error {error:.1e}")
    assert held.sum() > 1000
    best = [state.best.fitness for state in states]
    np.testing.assert_allclose(x, theirs.pos_history[: steps + 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(velocity, theirs.velocity_history[: steps + 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(best, theirs.cost_history[: steps + 1], rtol=1e-9)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_finds_what_pyswarms_finds(name, pyswarms_runs):
    outcome = compare(our_fitness(FUNCTIONS[name], js.pso(), ITERATIONS), pyswarms_runs[name])
    print(f"\nPSO, {name}: {outcome}")
    assert outcome.holds, str(outcome)


@pytest.mark.parametrize("wrong", [{"inertia_end": 0.45}, {"social": 1.8}, {"max_velocity": 0.1}])
def test_the_statistic_tells_another_swarm_apart(wrong, pyswarms_runs):
    outcome = compare(
        our_fitness(FUNCTIONS["sphere"], js.pso(**wrong), ITERATIONS), pyswarms_runs["sphere"]
    )
    print(f"\nPSO with {wrong}, sphere: {outcome}")
    assert not outcome.holds, str(outcome)
