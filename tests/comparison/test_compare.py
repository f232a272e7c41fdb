"""A comparison: its dataset, its numbers, and what is refused before any."""

import json

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from small import SCENARIOS, SMALL, assert_same_numbers, contents, interrupt_after, thrifty

import jaxsusp as js
from jaxsusp.comparison import dataset as results
from jaxsusp.comparison import workunit
from jaxsusp.comparison.kept.store import FILE, PARTS

ALGORITHMS = ("ga", "sdbo")
REAL = {"runs": 4, "iterations": 40, "population": 30}  # some other tests share these programs


@pytest.fixture(scope="session")
def two() -> xr.Dataset:
    """Two algorithms, really run."""
    return js.compare(SCENARIOS, ALGORITHMS, **REAL)


# What a comparison returns


def test_dataset_has_the_documented_layout(two):
    assert dict(two.sizes) == {
        "scenario": 2, "algorithm": 2, "run": 4, "iteration": 40, "step": 40, "variable": 15,
        "sample": 40,
        "term": 6, "axis": 3,
    }  # fmt: skip
    assert two["scenario"].values.tolist() == list(SCENARIOS)
    assert two["algorithm"].values.tolist() == list(ALGORITHMS)
    assert two["run"].values.tolist() == [0, 1, 2, 3]
    assert two["iteration"].values.tolist() == list(range(1, 41))
    assert two["term"].values.tolist() == list(results.TERMS)
    assert two["axis"].values.tolist() == ["x", "y", "z"]
    assert set(two.data_vars) == set(results.VARIABLES)
    assert two["best_known"].values.tolist() == [js.best_known(name) for name in SCENARIOS]
    for name, variable in results.VARIABLES.items():
        assert two[name].dims == variable.dims
        assert two[name].dtype == variable.dtype
        assert two[name].attrs == {"long_name": variable.meaning, "units": variable.units}


def test_attributes_tell_where_the_numbers_come_from(two, scenarios):
    settings = json.loads(two.attrs["settings"])
    digests = {each.name: each.digest for each in scenarios if each.name in SCENARIOS}
    assert settings == {
        "iterations": 40, "population": 30, "seed": 0, "waypoints": 5, "samples": 40,
        "search": "free-space", "budget": "iterations", "polish": False, "scenarios": digests,
    }  # fmt: skip
    assert two.attrs["seed"] == 0
    assert json.loads(two.attrs["versions"]).keys() == {"python", *results.PACKAGES}
    assert {"platform", "cores", "devices"} <= json.loads(two.attrs["machine"]).keys()
    assert list(json.loads(two.attrs["coefficients"])) == list(ALGORITHMS)
    files = json.loads(two.attrs["scenario_files"])
    assert {name: js.Scenario.from_toml(text).digest for name, text in files.items()} == digests


def test_numbers_are_those_of_the_problem_in_float64(two):
    problem = js.Problem.from_scenario(
        js.load_scenario("scenario-3"), dtype=np.float64, search="box"
    )
    cell = two.sel(scenario="scenario-3").stack(candidate=("algorithm", "run"))
    terms = jax.jit(jax.vmap(problem.terms))(jnp.asarray(cell["x"].values.T))
    np.testing.assert_allclose(cell["fitness"], terms.total, rtol=1e-12)
    np.testing.assert_array_equal(cell["collisions"], terms.collisions)
    np.testing.assert_array_equal(cell["violations"], terms.violations)
    for name in results.TERMS:
        ours = getattr(terms, name)
        np.testing.assert_allclose(cell["terms"].sel(term=name), ours, rtol=1e-9, atol=1e-12)


def test_position_is_the_best_runs(two):
    best = two["x"].isel(run=two["fitness"].argmin("run"))
    for name in SCENARIOS:
        task = js.load_scenario(name).task
        for algorithm in two["algorithm"].values:
            where = {"scenario": name, "algorithm": algorithm}
            path = two["position"].sel(where).values
            np.testing.assert_allclose(path[[0, -1]], [task.start, task.goal], atol=1e-12)
            waypoints = best.sel(where).values.reshape(-1, 3)
            nearest = np.linalg.norm(path[None] - waypoints[:, None], axis=-1).min(axis=1)
            assert nearest.max() < 0.5  # samples lie close to the waypoints, not on them
            length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
            run = two["fitness"].sel(where).argmin("run")
            assert length == pytest.approx(
                two["terms"].sel({**where, "term": "length"})[run].item()
            )


def test_history_falls_to_the_fitness(two):
    history = two["history"].values
    assert (np.diff(history, axis=-1) <= 0).all()
    np.testing.assert_allclose(history[..., -1], two["fitness"], rtol=1e-3)


def test_only_sdbo_tells_of_its_stability_move(two):
    told = two["stability_acted"].notnull().all(("scenario", "run"))
    assert told["algorithm"].values[told].tolist() == ["sdbo"]
    assert (two["stability_kept"].sel(algorithm="sdbo") <= two["stability_acted"].max()).all()


def test_what_is_not_finite_is_never_the_best(fake, monkeypatch):
    run_batch = workunit.run_batch

    def one_bad_run(*arguments):
        outcome = run_batch(*arguments)
        outcome.x[:, 0] = np.nan
        return outcome

    monkeypatch.setattr(workunit, "run_batch", one_bad_run)
    ds = js.compare("scenario-1", "pso", **SMALL)
    assert np.isposinf(ds["fitness"][0, 0, 0])
    assert np.isfinite(ds["fitness"][0, 0, 1])
    assert np.isfinite(ds["position"]).all()


def test_lone_names_stand_for_lists_of_one(fake):
    ds = js.compare("scenario-1", "pso", **SMALL)
    assert ds["scenario"].values.tolist() == ["scenario-1"]
    assert ds["algorithm"].values.tolist() == ["pso"]


def test_an_interrupted_comparison_goes_on_with_the_same_numbers(two, tmp_path):
    settings = {**REAL, "output": tmp_path}
    with pytest.raises(KeyboardInterrupt):
        js.compare(SCENARIOS, ALGORITHMS, **settings, progress=interrupt_after("ga"))
    assert not (tmp_path / FILE).exists()
    assert len(list((tmp_path / PARTS).iterdir())) == 1
    events = []
    ds = js.compare(SCENARIOS, ALGORITHMS, **settings, resume=True, progress=events.append)
    assert_same_numbers(ds, two)
    assert [e.algorithm for e in events if e.phase == "resumed"] == ["ga"]
    assert [(e.algorithm, e.compilations) for e in events if e.phase == "compiling"] == [
        ("sdbo", 1)
    ]
    assert events[-1].done == events[-1].total
    assert [path.name for path in tmp_path.iterdir()] == [FILE]
    xr.testing.assert_identical(js.load_results(tmp_path / FILE), ds)


# Bad input


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"runs": 0}, "runs = 0: give a whole number of at least 1"),
        ({"runs": -1}, "runs = -1"),
        ({"runs": True}, "runs = True"),
        ({"iterations": 0}, "iterations = 0"),
        ({"population": 0}, "population = 0"),
        ({"seed": -1}, "seed = -1: give a whole number from 0 to 4294967295"),
        ({"seed": 2**32}, "seed = 4294967296"),
        ({"waypoints": 0}, "waypoints = 0"),
        ({"samples": 2}, "samples = 2"),
        ({"budget": "evaluation"}, 'did you mean "evaluations"'),
        ({"search": "foo"}, "search = 'foo' is not known"),
        ({"algorithms": "sdob"}, 'did you mean "sdbo"'),
        ({"algorithms": ()}, "algorithms: none given"),
        ({"algorithms": ("pso", "pso")}, "'pso' is repeated"),
        ({"algorithms": ("dbo",), "population": 3}, "population"),
        ({"scenarios": "scenario-7"}, 'did you mean "scenario-'),
        ({"scenarios": ()}, "scenarios: none given"),
        ({"scenarios": ("scenario-1",) * 2}, "scenario-1 and scenario-1 are both named"),
        ({"resume": True, "output": None}, "give the output folder"),
    ],
)
def test_bad_input_is_one_message_and_touches_nothing(tmp_path, arguments, message):
    (tmp_path / FILE).write_text("old")
    (tmp_path / PARTS).mkdir()
    (tmp_path / PARTS / "pso-1.nc").write_text("older")
    before = contents(tmp_path)
    settings = {"scenarios": "scenario-1", "output": tmp_path, **SMALL, **arguments}
    with pytest.raises(js.InputError) as caught:
        js.compare(**settings)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert contents(tmp_path) == before


@pytest.mark.fast
def test_two_files_of_one_scenario_name_are_both_named(tmp_path):
    text = js.load_scenario("scenario-1").to_toml()
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).write_text(text)
    with pytest.raises(js.InputError, match=r"a\.toml and .*b\.toml are both named 'scenario-1'"):
        js.compare([tmp_path / "a.toml", tmp_path / "b.toml"])


@pytest.mark.fast
@pytest.mark.parametrize("name", ["two\nlines", "\0", " "])
def test_names_that_cannot_label_results_are_refused(name):
    odd = js.load_scenario("scenario-1").model_copy(update={"name": name})
    with pytest.raises(js.InputError, match="printable"):
        js.compare([odd])
    with pytest.raises(js.InputError, match="printable"):
        js.compare("scenario-1", [thrifty(name)])


def test_an_output_that_cannot_be_written_is_refused_before_anything_is_computed(tmp_path, fake):
    (tmp_path / "file").write_text("in the way")
    for output in (tmp_path / "file", tmp_path / "file" / "folder"):
        with pytest.raises(js.InputError, match=r"is a file, not a folder; choose another folder"):
            js.compare("scenario-1", "pso", **SMALL, output=output)
    assert not fake
