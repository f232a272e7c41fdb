"""A comparison: its dataset, its counting, and going on after an interrupt."""

import json
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from jax.tree_util import Partial

import jaxsusp as js
from jaxsusp.comparison import dataset as results
from jaxsusp.comparison import workunit
from jaxsusp.comparison.store import FILE, PARTS
from jaxsusp.optim.base import Best, NoInfo
from jaxsusp.optim.batch import Outcome
from jaxsusp.optim.polish import EVALUATIONS

SCENARIOS = ("scenario-1", "scenario-3")
ALGORITHMS = ("ga", "sdbo")
REAL = {"runs": 4, "iterations": 40, "population": 30}  # some other tests share these programs
SMALL = {"runs": 2, "iterations": 6, "population": 8, "search": "box"}
TIMES = ["seconds_run", "seconds_compile"]


@pytest.fixture(scope="session")
def two() -> xr.Dataset:
    """Two algorithms, really run."""
    return js.compare(SCENARIOS, ALGORITHMS, **REAL)


@pytest.fixture
def fake(monkeypatch):
    """Replace the search by one that costs nothing; lists (algorithm, runs) of every batch."""
    batches = []

    def run_batch(problems, optimizer, seed, runs, iterations, population, report):
        batches.append((optimizer.name, list(runs)))
        shape = (len(problems.lower), len(runs))
        rng = [np.random.default_rng([seed, len(optimizer.name), run]) for run in runs]
        unit = np.stack([each.random(problems.lower.shape) for each in rng], axis=1)
        lower, upper = problems.lower[:, None], problems.upper[:, None]
        report(iterations)
        return Outcome(
            (lower + (upper - lower) * unit).astype(np.float32),
            np.full(shape, 1.0, np.float32),
            np.tile(np.arange(iterations, 0, -1, np.float32), (*shape, 1)),
            NoInfo(),
            1.0,
            2.0,
        )

    monkeypatch.setattr(workunit, "run_batch", run_batch)
    return batches


def assert_same_numbers(ds, other):
    xr.testing.assert_identical(
        ds.drop_vars(TIMES).drop_attrs(), other.drop_vars(TIMES).drop_attrs()
    )


def contents(folder):
    return {
        path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def interrupt_after(algorithm):
    def told(event):
        if event.phase == "finished" and event.algorithm == algorithm:
            raise KeyboardInterrupt

    return told


# What a comparison returns


def test_dataset_has_the_documented_layout(two):
    assert dict(two.sizes) == {
        "scenario": 2, "algorithm": 2, "run": 4, "iteration": 40, "variable": 15, "sample": 40,
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


def test_evaluations_are_counted(fake):
    n, t = SMALL["population"], SMALL["iterations"]
    expected = {"pso": n * (t + 1), "ga": n * (t + 1), "dbo": n * (t + 1), "sdbo": n * (3 * t + 2)}
    ds = js.compare("scenario-1", **SMALL)
    assert dict(zip(ds["algorithm"].values, ds["evaluations"].values[0], strict=True)) == expected
    assert ds["evaluations_initial"].values.tolist() == [[n, n, n, 2 * n]]
    assert (ds["iterations"] == t).all()


def test_only_sdbo_tells_of_its_stability_move(two):
    told = two["stability_acted"].notnull().all(("scenario", "run"))
    assert told["algorithm"].values[told].tolist() == ["sdbo"]
    assert (two["stability_kept"].sel(algorithm="sdbo") <= two["stability_acted"].max()).all()


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


class Holding(NamedTuple):
    """State of an optimiser that hardly does anything."""

    best: Best


def thrifty(name="thrifty", evaluations=2, factor=1.0):
    """An optimiser that spends few evaluations per iteration and keeps its first candidate."""

    def init(factor, key, problem, population, iterations):
        x = problem.sample(key, population)
        return Holding(Best(x[0], problem.evaluate(x)[0]))

    def step(factor, key, problem, state):
        problem.evaluate(problem.sample(key, evaluations))
        return state, NoInfo()

    return js.Optimizer(name, Partial(init, factor), Partial(step, factor))


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


# Going on


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


@pytest.fixture
def folder(tmp_path, fake):
    """Results of pso and ga, two runs each."""
    js.compare("scenario-1", ("pso", "ga"), **SMALL, output=tmp_path)
    fake.clear()
    return tmp_path


def again(folder, algorithms=("pso", "ga"), **changed):
    scenarios = changed.pop("scenarios", "scenario-1")
    settings = {**SMALL, "output": folder, "resume": True, **changed}
    return js.compare(scenarios, algorithms, **settings)


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
