"""Going on after an interrupt, with further runs, and what stands in the way of it."""

import json

import numpy as np
import pytest
import xarray as xr
from small import SCENARIOS, SMALL, again, assert_same_numbers, contents, interrupt_after, thrifty

import jaxsusp as js
from jaxsusp.comparison import dataset as results
from jaxsusp.comparison.kept.store import FILE, PARTS


def test_further_runs_are_the_only_ones_computed(tmp_path):
    """Of an optimiser that compiles quickly: keys and numbering are the same for all of them."""
    two = js.compare(SCENARIOS, [thrifty()], **SMALL, output=tmp_path)
    events = []
    more = {**SMALL, "runs": 4}
    settings = {**more, "output": tmp_path, "resume": True, "progress": events.append}
    ds = js.compare(SCENARIOS, [thrifty()], **settings)
    first = next(event for event in events if event.phase == "compiling")
    assert first.done * 2 == first.total
    assert_same_numbers(ds, js.compare(SCENARIOS, [thrifty()], **more))
    np.testing.assert_array_equal(ds["x"][:, :, :2], two["x"])
    assert len(np.unique(ds["fitness"])) == ds["fitness"].size


def test_what_is_complete_is_not_computed_again(folder, fake):
    before = js.load_results(folder / FILE)
    xr.testing.assert_identical(again(folder), before)
    assert not fake


def test_resume_loses_neither_runs_nor_algorithms(folder, fake):
    ds = again(folder, ("dbo", "ga"), runs=1)
    assert fake == [("dbo", [0])]
    assert ds["algorithm"].values.tolist() == ["dbo", "ga", "pso"]
    ran = ds["fitness"].notnull().sum(("scenario", "run"))
    assert ran.values.tolist() == [1, 2, 2]
    assert list(json.loads(ds.attrs["coefficients"])) == ["dbo", "ga", "pso"]
    again(folder, ("dbo",), runs=3)
    assert fake[1:] == [("dbo", [1, 2])]


def test_times_add_up_when_runs_are_added(folder):
    ds = again(folder, runs=4)
    assert ds["seconds_run"].values.tolist() == [4.0, 4.0]
    assert ds["seconds_compile"].values.tolist() == [2.0, 2.0]


def test_without_resume_old_results_are_replaced(folder, fake):
    ds = again(folder, ("pso",), resume=False, seed=1)
    assert fake == [("pso", [0, 1])]
    xr.testing.assert_identical(js.load_results(folder / FILE), ds)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"seed": 1}, r"seed \(0 and 1\)"),
        ({"iterations": 5}, r"iterations \(6 and 5\)"),
        ({"budget": "evaluations"}, r"budget \('iterations' and 'evaluations'\)"),
        ({"polish": True}, r"polish \(False and True\)"),
        ({"scenarios": ("scenario-1", "scenario-2")}, r"scenarios \(scenario-1 and scenario-1, sc"),
        ({"algorithms": [js.pso(social=1.5)]}, "the coefficients of pso"),
    ],
)
def test_other_settings_are_not_resumed(folder, fake, changed, message):
    before = contents(folder)
    with pytest.raises(js.InputError, match=f"compare.nc: cannot be resumed.*{message}"):
        again(folder, **changed)
    assert contents(folder) == before
    assert not fake


def test_an_edited_scenario_is_not_resumed(folder):
    scenario = js.load_scenario("scenario-1")
    fitness = scenario.fitness.model_copy(update={"kappa": 999.0})
    edited = scenario.model_copy(update={"fitness": fitness})
    with pytest.raises(js.InputError, match=r"the content of scenarios \(scenario-1\)"):
        again(folder, scenarios=[edited])


def test_only_decisive_versions_prevent_resuming(folder, fake, monkeypatch):
    provenance = results.provenance()
    versions = json.loads(provenance["versions"])

    def pretend(package):
        other = {**provenance, "versions": json.dumps({**versions, package: "0.0"})}
        monkeypatch.setattr(results, "provenance", lambda: other)

    for package in ("python", "xarray", "h5netcdf"):
        pretend(package)
        again(folder)
    pretend("jaxlib")
    with pytest.raises(js.InputError, match="the version of jaxlib"):
        again(folder)


def test_a_new_comparison_interrupted_over_an_old_one_can_be_resumed(folder, fake):
    with pytest.raises(KeyboardInterrupt):
        again(folder, resume=False, seed=1, progress=interrupt_after("pso"))
    assert js.load_results(folder / FILE).attrs["seed"] == 0
    fake.clear()
    ds = again(folder, seed=1)
    assert fake == [("ga", [0, 1])]
    assert (ds.attrs["seed"], ds.sizes["run"]) == (1, 2)


def test_parts_of_an_abandoned_comparison_are_dropped_with_the_first_new_one(folder, fake):
    with pytest.raises(KeyboardInterrupt):
        again(folder, resume=False, seed=1, progress=interrupt_after("pso"))
    with pytest.raises(KeyboardInterrupt):
        again(folder, resume=False, seed=2, progress=interrupt_after("pso"))
    (part,) = (folder / PARTS).iterdir()
    assert js.load_results(part).attrs["seed"] == 2


def test_an_interrupt_while_the_parts_are_removed_is_harmless(folder, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr("shutil.rmtree", lambda *_, **__: None)
        ds = again(folder, runs=4)
    assert len(list((folder / PARTS).iterdir())) == 2
    assert_same_numbers(again(folder, runs=4), ds)
    assert not (folder / PARTS).exists()


def test_a_damaged_part_is_named_with_the_remedy(folder):
    with pytest.raises(KeyboardInterrupt):
        again(folder, resume=False, progress=interrupt_after("pso"))
    (part,) = (folder / PARTS).iterdir()
    part.write_bytes(part.read_bytes()[:5000])
    with pytest.raises(js.InputError, match=rf"{part.name}: cannot be read.*delete it"):
        again(folder)
    part.unlink()
    again(folder)


def test_what_a_killed_process_left_half_written_is_passed_over(folder, fake):
    (folder / PARTS).mkdir()
    (folder / PARTS / ".pso-1-abcd.nc").write_bytes(b"half")
    again(folder)
    assert not fake


def test_algorithm_names_may_hold_anything_printable(tmp_path, fake):
    odd = thrifty("../my/[bold] algorithm")
    settings = {**SMALL, "output": tmp_path / "out"}
    with pytest.raises(KeyboardInterrupt):
        js.compare("scenario-1", [odd, js.ga()], **settings, progress=interrupt_after(odd.name))
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    ds = js.compare("scenario-1", [odd, js.ga()], **settings, resume=True)
    assert fake == [(odd.name, [0, 1]), ("ga", [0, 1])]
    assert ds["algorithm"].values.tolist() == [odd.name, "ga"]
