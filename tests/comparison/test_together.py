"""Several files of one comparison."""

import json

import pytest
from small import assert_same_numbers

import jaxsusp as js
from jaxsusp.comparison.kept.together import load_together
from jaxsusp.errors import InputError

WRITTEN = "tests/files/compare-0.1.0.nc"


@pytest.fixture
def halves(tmp_path):
    """One algorithm each of a comparison that is written."""
    whole = js.load_results(WRITTEN)
    paths = []
    for name in whole["algorithm"].values.tolist()[:2]:
        part = whole.sel(algorithm=[name])
        paths.append(tmp_path / f"{name}.nc")
        js.save_results(part, paths[-1])
    return paths


def test_algorithms_from_two_files_stand_beside_each_other(halves):
    whole = js.load_results(WRITTEN)
    names = whole["algorithm"].values.tolist()[:2]
    assert_same_numbers(load_together(halves), whole.sel(algorithm=names))
    assert_same_numbers(load_together(halves[:1]), whole.sel(algorithm=names[:1]))


def test_what_differs_is_named_with_both_files(halves):
    one, other = halves
    for key, attribute, change in (
        ("seed", "settings", {"seed": 9}),
        ("the version of jax", "versions", {"jax": "0.0.1"}),
    ):
        ds = js.load_results(other)
        ds.attrs[attribute] = json.dumps(json.loads(ds.attrs[attribute]) | change)
        strange = other.with_name("strange.nc")
        js.save_results(ds, strange)
        with pytest.raises(InputError) as refused:
            load_together([one, strange])
        assert key in str(refused.value)
        assert str(one) in str(refused.value)
        assert str(strange) in str(refused.value)


def test_scenarios_that_only_some_algorithms_have_are_refused(halves):
    one, other = halves
    whole = js.load_results(other)
    elsewhere = other.with_name("elsewhere.nc")
    scenarios = [f"{each}-b" for each in whole["scenario"].values.tolist()]
    js.save_results(whole.assign_coords(scenario=scenarios), elsewhere)
    with pytest.raises(InputError, match=f"none of them has .* on {scenarios[0]}") as refused:
        load_together([one, elsewhere])
    assert str(elsewhere) in str(refused.value)
    assert load_together([other, elsewhere])["scenario"].size == 2 * len(scenarios)


def test_the_same_run_twice_is_refused(halves):
    with pytest.raises(InputError, match="is there twice"):
        load_together([halves[0], halves[0]])
