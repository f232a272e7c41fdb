"""Islands: who gets turns, what is refused, and that the ways are found."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.errors import InputError
from jaxsusp.optim.algorithms.routed import CROWD, ISLANDS, PARTS
from jaxsusp.optim.loop import advance, begin
from jaxsusp.problem.starts import Starts


def valleys(x):
    """Four valleys, of which the one at +0.5, +0.5 is the deepest."""
    return ((jnp.abs(x) - 0.5) ** 2).sum() + 0.1 * (2 - (x > 0).astype(x.dtype).sum())


def problem(starts=None) -> js.Problem:
    return js.Problem(valleys, -np.ones(2), np.ones(2), starts=starts)


CORNERS = Starts(
    np.array([[-0.6, -0.6], [-0.6, 0.6], [0.6, -0.6], [np.nan] * 2, [0.6, 0.6]]),
    np.where(np.arange(5)[:, None] == 3, np.nan, np.full((5, 2), 0.1)),
)


def run(problem, iterations=24, population=2 * CROWD, **coefficients):
    optimizer = js.routed(**coefficients)
    progress = begin(optimizer, problem, jax.random.key(0), population, iterations)
    return advance(optimizer, problem, jax.random.key(0), progress, 1, iterations + 1).state


def test_the_race_gives_turns_to_those_that_can_win():
    state = run(problem(CORNERS))
    turns = np.asarray(state.islands.generation)
    assert turns.sum() == 24 * 2
    assert turns[3] == 0, "a row that only fills up"
    assert turns[4] == turns.max()
    assert turns[0] == 4, "the worst stops after the first part"
    np.testing.assert_allclose(state.best.x, [0.5, 0.5], atol=1e-3)


def test_without_halving_all_islands_have_as_many_turns():
    turns = np.asarray(run(problem(CORNERS), halving=0.0).islands.generation)
    assert turns[3] == 0
    assert turns.sum() == 24 * 2
    assert set(turns[[0, 1, 2, 4, 5]]) == {9, 10}


def test_without_starts_islands_begin_anywhere():
    state = run(problem())
    assert state.fitness.shape == (ISLANDS + 1,), "and one about the best of a crowd"
    np.testing.assert_allclose(np.abs(state.best.x), 0.5, atol=1e-2)
    assert state.best.fitness < 0.01


@pytest.mark.fast
def test_a_run_that_is_too_short_for_the_islands_says_how_long_it_must_be():
    least = PARTS * 6
    with pytest.raises(InputError, match=f"too few for 6 islands .*at least {least} iterations"):
        js.minimize(problem(CORNERS), "routed", iterations=least - 1, population=CROWD)


def test_ways_that_other_searches_miss_are_found(scenarios):
    """Scenario 4: best round the outside (96.16), where the shortest route does not go."""
    found = js.minimize(
        js.Problem.from_scenario(scenarios[3], dtype=np.float32), "routed", runs=3,
        iterations=400, population=90,
    )  # fmt: skip
    assert found.fitness.max() < 1.005 * 96.1629
