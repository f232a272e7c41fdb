"""Variants of SDBO: none of its improvements is DBO, all are SDBO, and one program serves all."""

import inspect
from dataclasses import replace

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.problem.problem import stack_problems
from jaxsusp.studies.ablation import VARIANTS, Switches, switched

SIZES = {"iterations": 20, "population": 30}


@pytest.fixture(scope="module")
def problems() -> js.Problem:
    return stack_problems([js.Problem.from_scenario("scenario-1", dtype=np.float32)])


def found(problems, optimizer):
    """What two runs find whose luck is that of runs of SDBO."""
    return run_batch(problems, replace(optimizer, name="sdbo"), 0, range(2), **SIZES)


def left_out(names: str) -> js.Optimizer:
    return js.sdbo(**dict.fromkeys(names.split(), False))


NONE = "opposition sine_cosine pull stability"


def test_without_any_improvement_it_is_dbo_bit_for_bit(problems):
    dbo, none = found(problems, js.dbo()), found(problems, left_out(NONE))
    np.testing.assert_array_equal(none.history, dbo.history)
    np.testing.assert_array_equal(none.x, dbo.x)


def test_with_all_of_them_it_is_sdbo_bit_for_bit(problems):
    sdbo, given = found(problems, js.sdbo()), found(problems, js.sdbo(**Switches()._asdict()))
    np.testing.assert_array_equal(given.x, sdbo.x)
    assert jax.tree.structure(js.sdbo(**Switches()._asdict())) == jax.tree.structure(js.sdbo())


@pytest.mark.parametrize("made", [VARIANTS[0], VARIANTS[-1]])
def test_the_one_program_finds_what_programs_of_their_own_find(problems, made):
    """The others are compared where the study is tested."""
    own, one = (found(problems, each) for each in (js.sdbo(**made._asdict()), switched(made)))
    np.testing.assert_allclose(one.history, own.history, rtol=1e-5)


@pytest.mark.fast
def test_variants_are_named_by_what_is_left_out():
    assert js.sdbo().name == "sdbo"
    assert left_out("pull").name == "sdbo-without-pull"
    name = js.sdbo(frame="task", opposition=False, stability=False).name
    assert name == "sdbo-task-without-opposition-stability"
    assert len({js.sdbo(**made._asdict()).name for made in VARIANTS}) == 16


@pytest.mark.fast
def test_what_is_left_out_costs_nothing(problems):
    problem = jax.tree.map(lambda leaf: leaf[0], problems)

    def cost(names: str) -> tuple[int, int]:
        return tuple(count_evaluations(left_out(names), problem, 30))

    assert cost("") == (60, 90)
    assert cost("opposition") == (30, 90)
    assert cost("sine_cosine") == (60, 90)
    assert cost("pull") == cost("stability") == (60, 60)
    assert cost(NONE) == (30, 30)


@pytest.mark.fast
def test_variants_count_in_binary():
    assert not any(VARIANTS[0])
    assert all(VARIANTS[-1])
    assert VARIANTS[1] == Switches(False, False, False, True)
    assert VARIANTS[8] == Switches(True, False, False, False)


@pytest.mark.fast
@pytest.mark.parametrize("bad", ["no", None, 2, np.array([False])])
def test_an_improvement_is_made_or_not(bad):
    with pytest.raises(js.InputError, match="pull = "):
        inspect.unwrap(js.sdbo)(pull=bad)  # without the tests' own check of annotations
