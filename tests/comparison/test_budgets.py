"""What algorithms get equally much of, and how it is counted."""

import json

import numpy as np
import pytest
import xarray as xr
from small import SMALL, again, interrupt_after, thrifty

import jaxsusp as js
from jaxsusp.comparison import dataset as results
from jaxsusp.comparison import workunit
from jaxsusp.comparison.kept.store import FILE
from jaxsusp.optim.polish import EVALUATIONS


def test_evaluations_are_counted(fake):
    n, t = SMALL["population"], SMALL["iterations"]
    expected = {"pso": n * (t + 1), "ga": n * (t + 1), "dbo": n * (t + 1), "sdbo": n * (3 * t + 2)}
    ds = js.compare("scenario-1", **SMALL)
    assert dict(zip(ds["algorithm"].values, ds["evaluations"].values[0], strict=True)) == expected
    assert ds["evaluations_initial"].values.tolist() == [[n, n, n, 2 * n]]
    assert (ds["iterations"] == t).all()


def test_a_budget_of_evaluations_is_exceeded_by_nobody(fake):
    ds = js.compare("scenario-1", ("pso", "sdbo"), **SMALL, budget="evaluations")
    assert ds["iterations"].values.tolist() == [6, 1]
    assert (ds["evaluations"] <= 8 * 7).all()
    ended = ds["history"].sel(algorithm="sdbo").isnull()
    assert ended.all(("scenario", "run")).values.tolist() == [False, *[True] * 5]
    assert ds["history"].sel(algorithm="pso").notnull().all()


def test_a_budget_that_does_not_last_one_iteration_is_refused(fake):
    with pytest.raises(js.InputError, match=r"iterations = 1: sdbo needs 40 .* the budget is 16"):
        js.compare("scenario-1", "sdbo", 2, 1, 8, budget="evaluations")


@pytest.mark.parametrize("budget", ["iterations", "time"])
def test_too_few_iterations_for_any_algorithm_are_refused_before_the_first_runs(paces, budget):
    with pytest.raises(js.InputError, match="iterations = 6: too few for 9 islands of routed"):
        js.compare("scenario-1", ("pso", "routed"), **SMALL, budget=budget)
    assert paces[1] == []


def test_a_time_that_was_measured_before_can_be_too_little(paces, fake, tmp_path):
    settings = {**SMALL, "iterations": 27, "budget": "time", "output": tmp_path}
    js.compare("scenario-1", "pso", **settings)
    fake.clear()
    paces[0]["routed"] = 1.0
    with pytest.raises(js.InputError, match="iterations = 2: too few for 9 islands of routed"):
        js.compare("scenario-1", ("ga", "routed"), **settings, resume=True)
    assert fake == []


def test_an_algorithm_may_iterate_more_often_than_asked_for_its_budget(fake):
    ds = js.compare("scenario-1", [thrifty(), js.pso()], **SMALL, budget="evaluations")
    assert ds["iterations"].values.tolist() == [24, 6]
    assert ds["history"].sel(algorithm="thrifty").notnull().all()
    assert ds["history"].sel(algorithm="pso").notnull().sum("iteration").values.tolist() == [[6, 6]]


@pytest.fixture
def paces(monkeypatch, fake):
    """Seconds of an iteration by algorithm, instead of a clock; lists who was timed."""
    seconds, timed = {"ga": 0.2, "pso": 0.1, "thrifty": 0.3}, []

    def time_iteration(problems, optimizer, *_):
        timed.append(optimizer.name)
        return seconds[optimizer.name]

    monkeypatch.setattr(workunit, "time_iteration", time_iteration)
    return seconds, timed


def test_a_budget_of_time_is_that_of_the_slowest(paces):
    events = []
    settings = {**SMALL, "budget": "time", "progress": events.append}
    ds = js.compare("scenario-1", ("pso", "ga"), **settings)
    assert ds["iterations"].values.tolist() == [12, 6]
    assert ds["evaluations"].values.tolist() == [[8 * 13, 8 * 7]]
    assert ds["history"].notnull().sum("iteration").values.tolist() == [[[12, 12], [6, 6]]]
    assert [event.algorithm for event in events if event.phase == "timing"] == ["pso", "ga"]
    assert results.time_allotted(ds)["seconds"] == pytest.approx(6 * 0.2 / 2)  # of two runs


def test_a_measured_time_holds_when_a_comparison_goes_on(paces, fake, tmp_path):
    seconds, timed = paces
    settings = {**SMALL, "budget": "time", "output": tmp_path}
    with pytest.raises(KeyboardInterrupt):
        js.compare("scenario-1", ("pso", "ga"), **settings, progress=interrupt_after("pso"))
    seconds |= {"pso": 7.0, "ga": 7.0}  # the machine is busy now
    ds = js.compare("scenario-1", ("pso", "ga", thrifty()), **settings, resume=True)
    assert timed == ["pso", "ga", "thrifty"]
    assert ds["iterations"].values.tolist() == [12, 6, 4]
    assert fake == [("pso", [0, 1]), ("ga", [0, 1]), ("thrifty", [0, 1])]
    assert js.compare("scenario-1", "ga", **settings, resume=True).attrs == ds.attrs
    anew = js.compare("scenario-1", "ga", **{**settings, "output": None})
    with pytest.raises(
        js.InputError, match=r"differ in the time measured for a run \(0.6 s and 21"
    ):
        js.append_results(ds, anew)


def test_parts_of_another_measurement_are_not_put_into_an_old_file(paces, fake, tmp_path):
    settings = {**SMALL, "budget": "time", "output": tmp_path}
    js.compare("scenario-1", ("pso", "ga"), **settings)
    paces[0]["ga"] = 0.4
    with pytest.raises(KeyboardInterrupt):
        js.compare("scenario-1", ("pso", "ga"), **settings, progress=interrupt_after("pso"))
    ds = js.compare("scenario-1", ("pso", "ga"), **settings, resume=True)
    assert ds["iterations"].values.tolist() == [24, 6]


@pytest.fixture
def polishing(monkeypatch, fake):
    """Polishing that takes five seconds and moves every point a little; lists its batches."""
    batches = []

    def polish_batch(problems, outcome):
        batches.append(outcome.x.shape)
        seconds = outcome.seconds_run + 5
        return outcome._replace(x=outcome.x + np.float32(1e-3), seconds_run=seconds)

    monkeypatch.setattr(workunit, "polish_batch", polish_batch)
    return batches


@pytest.mark.parametrize("budget", ["iterations", "evaluations"])
def test_polishing_is_counted_and_comes_on_top_of_a_budget(polishing, budget):
    events, settings = [], {**SMALL, "budget": budget}
    plain = js.compare("scenario-1", ("pso", "ga"), **settings)
    assert polishing == []
    assert not plain["evaluations_polish"].any()
    ds = js.compare("scenario-1", ("pso", "ga"), **settings, polish=True, progress=events.append)
    assert polishing == [(1, 2, 15)] * 2
    assert (ds["evaluations_polish"] == EVALUATIONS).all()
    assert (ds["evaluations"] == plain["evaluations"] + EVALUATIONS).all()
    assert (ds["seconds_run"] == plain["seconds_run"] + 5).all()
    assert events[-1].total == events[-1].done == 2 * ds["evaluations"].sum()
    for name in ("history", "iterations", "evaluations_initial"):
        xr.testing.assert_identical(ds[name], plain[name])
    np.testing.assert_allclose(ds["x"], plain["x"] + 1e-3, atol=1e-6)
    assert (ds["fitness"] != plain["fitness"]).all(), "evaluated anew where it was moved to"


def test_a_file_from_before_polishing_goes_on_without_it(folder, fake, polishing):
    ds = js.load_results(folder / FILE)
    settings = json.loads(ds.attrs["settings"])
    del settings["polish"]
    old = ds.drop_vars("evaluations_polish").assign_attrs(settings=json.dumps(settings))
    old.to_netcdf(folder / FILE, engine="h5netcdf")
    assert not js.load_results(folder / FILE)["evaluations_polish"].any()
    with pytest.raises(js.InputError, match=r"polish \(False and True\)"):
        again(folder, polish=True)
    assert not fake
    assert again(folder, runs=3)["fitness"].notnull().all()
    assert polishing == []
    more = js.compare("scenario-1", "dbo", **SMALL)
    assert js.append_results(js.load_results(folder / FILE), more).sizes["algorithm"] == 3
