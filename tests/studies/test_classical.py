"""Classical functions: least at their optimum, wherever that is, and moved as is said."""

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.studies.classical import CASES, FUNCTIONS, WITHIN, classical

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("case", CASES)
def test_the_optimum_is_zero_within_the_bounds_and_less_than_what_is_near(name, case):
    problem = classical(name, case, dim=5)
    place = problem.fitness.place
    assert (problem.lower < place).all()
    assert (place < problem.upper).all()
    assert float(problem.fitness(place)) == pytest.approx(0, abs=1e-12)
    near = place + 1e-3 * np.random.default_rng(0).normal(size=(20, 5))
    assert (np.array([problem.fitness(x) for x in near]) > 0).all()


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_moved_with_its_bounds_is_the_same_about_their_middle(name):
    printed, moved = (classical(name, case, dim=5) for case in ("printed", "moved"))
    away = moved.reference - printed.reference
    assert (np.abs(away) > moved.upper - moved.reference).all(), "the origin is outside"
    x = np.random.default_rng(0).uniform(printed.lower, printed.upper)
    assert float(moved.fitness(x + away)) == pytest.approx(float(printed.fitness(x)))


def test_turning_keeps_distances_and_mixes_variables():
    turn = classical("sphere", "turned", dim=6).fitness.turn
    np.testing.assert_allclose(turn @ turn.T, np.eye(6), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1)
    assert (np.abs(turn) > 1e-6).all()


def test_shifted_and_turned_share_their_optimum():
    shifted, turned = (classical("Ackley", case, dim=6) for case in ("shifted", "turned"))
    np.testing.assert_array_equal(shifted.fitness.place, turned.fitness.place)
    assert (np.abs(shifted.fitness.place) <= WITHIN * shifted.upper).all()


def test_what_there_is_not_is_told():
    with pytest.raises(js.InputError, match="function = 'spher' is not known"):
        classical("spher", "printed")
    with pytest.raises(js.InputError, match="case"):
        classical("sphere", "rotated")
