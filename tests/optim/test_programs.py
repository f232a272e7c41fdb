"""A program that was kept is the one that would be compiled, and no other is taken for it."""

import pickle
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial, wraps
from types import ModuleType

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.tree_util import Partial

import jaxsusp as js
from jaxsusp.optim import programs
from jaxsusp.optim.algorithms import pso
from jaxsusp.optim.base import Best
from jaxsusp.optim.batch import compile_batch
from jaxsusp.optim.programs import at_hand, described
from jaxsusp.problem.problem import stack_problems

RUNS, ITERATIONS = 3, 5


@pytest.fixture
def kept(tmp_path, monkeypatch):
    """A folder in which programs are kept, and a process that has met none of them."""
    monkeypatch.setattr(programs, "kept_in", lambda: tmp_path)
    programs._place_of.cache_clear()
    yield lambda: sorted(tmp_path.glob("*.program"))
    programs._place_of.cache_clear()


def double(best: Best) -> Best:
    return Best(2 * best.x, best.fitness + 1)


def called(value=1.0, size=3, program=None):
    """What a compiled program of our types gives."""
    best = Best(jnp.full(size, value), jnp.asarray(value))
    compiled = at_hand(program or jax.jit(double), jax.devices()[:1], best, part="double")
    return jax.tree.map(np.asarray, compiled(best))


class Untraceable:
    """Stands for a program that must not be needed."""

    def lower(self, *_):
        raise AssertionError("traced")

    __call__ = lower


def test_a_program_that_was_kept_is_not_traced_again(kept):
    first = called(2.0)
    assert len(kept()) == 1
    programs._place_of.cache_clear()  # another process
    again = called(3.0, program=Untraceable())
    np.testing.assert_array_equal(first.x, 4)
    np.testing.assert_array_equal(again.x, 6)
    assert type(again) is Best


def test_other_shapes_are_other_programs(kept):
    called(size=3)
    called(size=4)
    assert len(kept()) == 2
    with pytest.raises(AssertionError, match="traced"):
        called(size=5, program=Untraceable())


def test_other_code_is_another_program(kept, monkeypatch):
    called()
    monkeypatch.setattr(programs, "code_digest", lambda room: "changed")
    called()
    assert len(kept()) == 2


@pytest.mark.parametrize("text", [b"", b"cut", pickle.dumps((b"no program", None))])
def test_a_damaged_file_is_made_anew(kept, text):
    called()
    (file,) = kept()
    file.write_bytes(text)
    programs._place_of.cache_clear()
    np.testing.assert_array_equal(called(5.0).x, 10)
    programs._place_of.cache_clear()
    np.testing.assert_array_equal(called(6.0, program=Untraceable()).x, 12)


def test_what_xla_has_only_read_is_not_written_down(kept):
    """A program that JAX's own cache has is compiled again: its copy of a copy would not run."""
    called()
    for file in kept():
        file.unlink()
    programs._place_of.cache_clear()
    jax.clear_caches()
    called()
    programs._place_of.cache_clear()
    np.testing.assert_array_equal(called(4.0, program=Untraceable()).x, 8)


def test_functions_and_types_of_others_are_traced_as_ever(kept):
    mine = jax.jit(lambda point: point + 1)
    assert at_hand(mine, jax.devices(), Partial(double)) is mine  # of the tests, not of the package
    assert at_hand(mine, jax.devices(), object()) is mine
    problem = js.Problem(lambda x: (x**2).sum(), [-1, -1], [1, 1])
    assert at_hand(mine, jax.devices(), problem) is mine
    js.minimize(problem, "pso", runs=RUNS, iterations=ITERATIONS)
    assert kept() == []


def test_a_wrapper_that_has_the_name_of_ours_is_traced_as_ever(kept, monkeypatch):
    """`functools.wraps` makes a stranger look like what it wraps."""

    @wraps(pso._step)
    def watched(*arguments):
        raise NotImplementedError

    mine = jax.jit(lambda point: point + 1)
    monkeypatch.setattr(pso, "_step", watched)
    stranger = Partial(watched, pso.PsoCoefficients())
    assert at_hand(mine, jax.devices(), stranger) is mine
    assert kept() == []


def test_a_module_that_is_loaded_anew_has_programs_of_its_own(kept, monkeypatch):
    """Its functions have the names of the earlier ones and are others: JAX tells them apart."""
    module = ModuleType("jaxsusp.anew")
    monkeypatch.setitem(sys.modules, module.__name__, module)
    for _ in range(2):
        exec("def turn(): pass", vars(module))
        argument = Partial(module.turn, jnp.ones(3))
        program = at_hand(jax.jit(lambda each: each.args[0] + 1), jax.devices()[:1], argument)
        np.testing.assert_array_equal(program(argument), 2)
    assert len(kept()) == 1


def test_who_compiles_nothing_keeps_nothing(tmp_path):
    with (
        jax_setting("jax_compilation_cache_dir", str(tmp_path)),
        jax_setting("jax_enable_compilation_cache", True),
    ):
        assert programs.kept_in() == tmp_path
        with jax_setting("jax_disable_jit", True):
            assert programs.kept_in() is None
        with jax_setting("jax_enable_compilation_cache", False):
            assert programs.kept_in() is None
        with jax_setting("jax_compilation_cache_dir", "gs://somewhere/else"):
            assert programs.kept_in() is None


@contextmanager
def jax_setting(name, value):
    before = getattr(jax.config, name)
    jax.config.update(name, value)
    try:
        yield
    finally:
        jax.config.update(name, before)


def test_nothing_is_kept_where_nothing_is_to_be(monkeypatch):
    monkeypatch.setattr(programs, "kept_in", lambda: None)
    program = jax.jit(double)
    assert at_hand(program, jax.devices(), Best(jnp.zeros(2), jnp.zeros(()))) is program


def test_what_is_fixed_is_told_apart():
    assert described(1.0) != described(2.0)
    assert described({"a": 1, "b": (2, None)}) == described({"b": (2, None), "a": 1})
    assert described(js.pso()) != described(js.ga())
    assert described(js.pso()) == described(js.pso())


def test_coefficients_are_arguments_of_one_program(kept, problems):
    """A sweep compiles nothing anew, and every value is its own."""
    found = [
        js.minimize(problems[0], js.pso(cognitive=value), runs=RUNS, iterations=ITERATIONS)
        for value in (1.0, 2.0)
    ]
    assert len(kept()) == 2  # of the beginning, and of what follows
    assert (found[0].fitness != found[1].fitness).all()


def test_a_search_of_a_kept_program_is_the_search(kept, problems):
    search = partial(js.minimize, problems[0], "pso", runs=RUNS, iterations=ITERATIONS)
    fresh = search()
    assert len(kept()) == 2
    programs._place_of.cache_clear()
    again = search()
    np.testing.assert_array_equal(again.fitness, fresh.fitness)
    np.testing.assert_array_equal(again.x, fresh.x)
    np.testing.assert_array_equal(search(seed=1).fitness != fresh.fitness, True)
    assert len(kept()) == 2


def test_what_is_compiled_ahead_is_what_the_search_takes(kept, problems):
    """Many threads that want one program compile it once, and a search finds it."""
    arguments = stack_problems([problems[0]]), js.pso(), 0, range(RUNS), ITERATIONS, 30
    with ThreadPoolExecutor(4) as pool:
        for done in [pool.submit(compile_batch, *arguments) for _ in range(4)]:
            done.result()
    files = {each: each.stat().st_mtime_ns for each in kept()}
    assert len(files) == 2
    found = js.minimize(problems[0], js.pso(), runs=RUNS, iterations=ITERATIONS)
    assert {each: each.stat().st_mtime_ns for each in kept()} == files
    programs._place_of.cache_clear()
    again = js.minimize(problems[0], js.pso(), runs=RUNS, iterations=ITERATIONS)
    np.testing.assert_array_equal(again.fitness, found.fitness)


def test_a_switch_of_one_thread_is_not_lost_on_the_way(kept, problems):
    """What a thread was asked to compute otherwise it computes, at hand or not."""
    search = partial(js.minimize, problems[0], "sdbo", runs=RUNS, iterations=ITERATIONS)
    with jax.threefry_partitionable(False):
        cold, warm = search(), search()
    np.testing.assert_array_equal(cold.fitness, warm.fitness)
    with pytest.MonkeyPatch.context() as patch, jax.threefry_partitionable(False):
        patch.setattr(programs, "kept_in", lambda: None)
        np.testing.assert_array_equal(search().fitness, cold.fitness)
    assert (search().fitness != cold.fitness).any()
