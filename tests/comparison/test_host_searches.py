"""Searches on the host in comparisons: counted, numbered and resumed like all others."""

import dataclasses

import numpy as np
import pytest
from small import SMALL, again
from walking import shared, walk

import jaxsusp as js


@pytest.fixture(scope="module")
def two():
    """Two runs of two searches, one of them with the generator that all share."""
    return js.compare("scenario-1", [walk(), shared()], **SMALL)


def test_what_it_found_is_evaluated_again_and_what_it_asked_for_is_counted(two):
    assert (two["evaluations"] == (8 + 3) + 6 * 8).all()
    assert (two["evaluations_initial"] == 8 + 3).all()
    assert (two["history"].diff("iteration") <= 0).all()
    np.testing.assert_allclose(two["history"][..., -1], two["fitness"], rtol=1e-4)
    assert (two["seconds_run"] > 0).all()


def test_further_runs_are_the_only_ones_made_and_the_same_as_ever(two, tmp_path):
    settings = {**SMALL, "output": tmp_path}
    js.compare("scenario-1", [walk(), shared()], **{**settings, "runs": 1})
    events = []
    ds = js.compare(
        "scenario-1", [walk(), shared()], **settings, resume=True, progress=events.append
    )
    np.testing.assert_array_equal(ds["x"], two["x"])
    np.testing.assert_array_equal(ds["history"], two["history"])
    first = next(event for event in events if event.phase == "compiling")
    assert first.done * 2 == first.total


def test_a_budget_of_evaluations_counts_what_is_asked_for(fake):
    ds = js.compare("scenario-1", [walk(), js.pso()], **SMALL, budget="evaluations")
    assert ds["iterations"].values.tolist() == [5, 6]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"origin": "library 2"}, r"what walk is from \(library 1 and library 2\)"),
        ({"begin": walk(0.1).begin}, "the coefficients of walk"),
    ],
)
def test_another_version_of_its_library_is_not_resumed(fake, tmp_path, changed, message):
    search = dataclasses.replace(walk(), origin="library 1")
    again(tmp_path, [search], resume=False)
    again(tmp_path, [search])
    with pytest.raises(js.InputError, match=f"cannot be resumed.*{message}"):
        again(tmp_path, [dataclasses.replace(search, **changed)])
