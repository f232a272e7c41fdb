"""Runs × scenarios in one program: what shares the batch does not matter, and it compiles once."""

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.comparison.workunit import stack_scenarios
from jaxsusp.optim import batch, programs
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import run_key
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import stack_problems

# Candidates keep their arithmetic whatever the shape of the batch; only XLA's choice of fused
# multiply-adds may differ between programs, which is a few units in the last place of float32.
TOLERANCE = 1e-5


# Sizes and scenarios of the comparison in `tests/comparison`, whose programs are used here too.
SIZES = {"iterations": 40, "population": 30}


def stacked(scenarios, search="free-space"):
    (group,) = stack_scenarios(scenarios, 5, 40, search)
    return group.problems


@pytest.fixture
def traced(monkeypatch):
    """Programs are traced and compiled by this process, and counted by JAX."""
    monkeypatch.setattr(programs, "kept_in", lambda: None)


@pytest.mark.parametrize("name", ["pso", "sdbo"])
def test_a_run_does_not_depend_on_what_shares_the_batch(scenarios, name):
    """Fewer runs, another order, one device instead of two, one scenario instead of two."""
    optimizer = algorithm(name)
    both = run_batch(stacked([scenarios[0], scenarios[2]]), optimizer, 0, range(4), **SIZES)
    fewer = [3, 0] if name == "pso" else [3, 0, 1]  # two lanes are another program than four
    few = run_batch(stacked([scenarios[0], scenarios[2]]), optimizer, 0, fewer, **SIZES)
    alone = run_batch(stacked([scenarios[2]]), optimizer, 0, [3], **SIZES)
    np.testing.assert_allclose(few.history, both.history[:, fewer], rtol=TOLERANCE)
    np.testing.assert_allclose(alone.history[0], both.history[1, [3]], rtol=TOLERANCE)
    assert np.isfinite(both.history).all()


def test_runs_of_different_lengths_share_a_program_with_room_for_both(scenarios, traced):
    """A shorter run is one that stops; what it finds is what it finds in a program of its own."""
    problems = stacked([scenarios[0], scenarios[2]])
    whole = run_batch(problems, algorithm("pso"), 0, range(4), **SIZES)
    short = run_batch(problems, algorithm("pso"), 0, range(4), 10, 30, room=40)
    assert short.history.shape == (2, 4, 10)
    _, _, go = batch._programs(tuple(jax.devices()[:2]), 30, 10, 40, False)
    assert go._cache_size() == 1
    clocked = run_batch(problems, algorithm("pso"), 0, range(4), 10, 30)
    np.testing.assert_array_equal(short.history, clocked.history)
    assert (short.history[..., 0] == whole.history[..., 0]).all(), "inertia begins alike"


@pytest.mark.parametrize("name", ["pso", "sdbo"])
def test_a_batch_of_many_candidates_has_another_program_and_the_same_numbers(
    name, scenarios, traced, monkeypatch
):
    problems = stacked([scenarios[0], scenarios[2]])
    few = run_batch(problems, algorithm(name), 0, range(4), **SIZES)
    monkeypatch.setattr(batch, "MANY", 1)
    many = run_batch(problems, algorithm(name), 0, range(4), **SIZES)
    np.testing.assert_allclose(many.history, few.history, rtol=TOLERANCE)
    _, _, go = batch._programs(tuple(jax.devices()[:2]), 30, 40, 40, True)
    assert go._cache_size() >= 1


def test_one_compilation_serves_all_six_scenarios(scenarios, traced):
    """Stacked or one after the other, scenarios of one shape never compile twice."""
    traces = []

    def counted_step(key, problem, state):
        traces.append(None)
        return js.pso().step(key, problem, state)

    optimizer = js.Optimizer("counted", js.pso().init, counted_step)
    six = stacked(scenarios, "box")
    outcome = run_batch(six, optimizer, 0, range(2), 4, 6)
    assert outcome.fitness.shape == (6, 2)
    once = len(traces)
    moved = jax.tree.map(lambda leaf: leaf[::-1].copy(), six)
    again = run_batch(moved, optimizer, 1, range(2), 4, 6)
    assert len(traces) == once
    assert again.seconds_compile < outcome.seconds_compile
    _, start, go = batch._programs(tuple(jax.devices()[:2]), 6, 4, 4, False)
    assert start._cache_size() == go._cache_size() == 1


def test_the_search_is_in_single_precision_whatever_the_global_setting(scenarios):
    problems = stacked([scenarios[2]])
    assert jax.config.jax_enable_x64
    inside = run_batch(problems, js.pso(), 0, [3], **SIZES)
    with jax.enable_x64(False):
        outside = run_batch(problems, js.pso(), 0, [3], **SIZES)
    assert inside.x.dtype == outside.x.dtype == np.float32
    np.testing.assert_array_equal(inside.history, outside.history)


@pytest.mark.fast
def test_keys_are_those_of_the_specification():
    """fold_in(fold_in(key, fixed hash of the name), i)."""
    import zlib

    expected = jax.random.fold_in(
        jax.random.fold_in(jax.random.key(7), zlib.crc32(b"sdbo-task")), 3
    )
    assert run_key(7, "sdbo-task", 3) == expected


def test_an_iteration_takes_some_time():
    """How much, the machine decides; that it is measured does not depend on it."""
    problem = js.Problem(fitness=lambda x: (x**2).sum(axis=0), lower=[-1.0], upper=[1.0])
    seconds = batch.time_iteration(stack_problems([problem]), js.pso(), 0, [0], 40, 30)
    assert 0 < seconds < np.inf
