"""Numbers and lists in sentences."""

import pytest

from experiments.words import between, counted, listed, signed, winners

pytestmark = pytest.mark.fast


def test_lists_read_as_people_write_them():
    assert listed([]) == "none"
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"


def test_numbers_have_their_sign_and_rounding_has_none():
    assert signed(12.34) == "+12"
    assert signed(-0.1234) == "−0.12"
    assert signed(-2.3e-16) == "0"
    assert between(-1.5, 20.0) == "−1.5 to +20"
    assert counted(1, "pair") == "1 pair"
    assert counted(0, "pair") == "no pairs"


def test_winners_of_a_tie_stand_in_the_given_order():
    names = ["sdbo", "pso", "dbo", "pso", "ga"]
    for some in (names, names[::-1]):
        told = winners(some, "the least", ["pso", "ga", "dbo", "sdbo"])
        assert told == "PSO has the least in 2, GA in 1, DBO in 1, SDBO in 1"
