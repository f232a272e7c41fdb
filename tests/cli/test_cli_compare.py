"""`jaxsusp compare` and `report` as a person or a script meets them."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import jaxsusp as js
from jaxsusp.comparison import compare as comparison
from jaxsusp.comparison import workunit
from jaxsusp.comparison.kept.store import FILE, PARTS
from jaxsusp.report.browser import results as webpage
from jaxsusp.report.comparison import folder
from jaxsusp.report.comparison.folder import write_report
from jaxsusp.report.drawing import scene as scene3d

# The comparison of `tests/comparison`, whose programs need not be compiled again.
SMALL = ["--scenarios", "scenario-1,scenario-3", "--algorithms", "ga,sdbo"]
SMALL += ["--runs", "4", "--iterations", "40", "--population", "30"]
PROGRAM = [str(Path(sys.executable).with_name("jaxsusp"))]
ENVIRONMENT = {
    **os.environ,
    "JAX_NUM_CPU_DEVICES": "2",  # as in the tests' own process, whose programs are at hand
    "JAX_LOGGING_LEVEL": "CRITICAL",  # loading one of them logs what is no error
    "COLUMNS": "80",
}


@pytest.fixture(scope="module")
def uninterrupted() -> xr.Dataset:
    """What the small comparison finds."""
    return js.compare(("scenario-1", "scenario-3"), ("ga", "sdbo"), 4, 40, 30)


@pytest.fixture(scope="module")
def saved(uninterrupted, tmp_path_factory) -> Path:
    """The small comparison as a file."""
    path = tmp_path_factory.mktemp("saved") / FILE
    js.save_results(uninterrupted, path)
    return path


@pytest.fixture
def quick_pictures(monkeypatch):
    """Pictures that take no time."""
    monkeypatch.setattr(scene3d, "scene", lambda *_: None)
    monkeypatch.setattr(folder, "save", lambda figure, path: path.write_text("picture"))


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# Good input


@pytest.mark.usefixtures("quick_pictures")
def test_an_interrupt_keeps_what_is_finished_and_resume_completes_it(tmp_path, run, uninterrupted):
    command = [*PROGRAM, "compare", *SMALL, "--output", str(tmp_path)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT
    ) as process:
        watchdog = threading.Timer(100, process.kill)
        watchdog.start()
        first = process.stderr.readline()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
        watchdog.cancel()
    assert first.startswith("ga finished: 2")
    assert process.returncode == 130
    assert out == ""
    assert err == (
        f"Interrupted: finished and kept in {tmp_path}: ga. The same command with --resume goes "
        "on.\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == [PARTS]

    code, out, err = run("compare", *SMALL, "--output", tmp_path, "--resume")
    assert code == 0
    assert err.startswith("ga was there already: 2")
    assert "Comparison of the algorithms" in out
    times = ["seconds_run", "seconds_compile"]
    found = js.load_results(tmp_path / FILE)
    xr.testing.assert_equal(found.drop_vars(times), uninterrupted.drop_vars(times))
    assert not (tmp_path / PARTS).exists()


@pytest.mark.usefixtures("quick_pictures")
def test_json_holds_the_tables_and_no_nan(run, tmp_path):
    code, out, err = run("compare", *SMALL, "--output", tmp_path, "--json")
    assert code == 0
    printed = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert {"comparison", "stability", "files"} <= printed.keys()
    assert "ratios" not in printed  # there is no dbo
    assert [row["algorithm"] for row in printed["comparison"]] == ["ga", "sdbo"] * 2
    assert printed["stability"][0]["acted"] is not None
    assert all(Path(file).is_file() for file in printed["files"])
    lines = err.splitlines()
    assert [line.split(":")[0] for line in lines[:2]] == ["ga finished", "sdbo finished"]
    assert lines[2:] == [f"{len(printed['files'])} tables and figures are in {tmp_path}"]


def test_report_writes_the_same_files_again(run, saved, tmp_path):
    path = tmp_path / "half.nc"
    js.save_results(js.load_results(saved).sel(scenario=["scenario-3"]), path)
    first = run("report", path, "--output", tmp_path / "one")
    second = run("report", path, "--output", tmp_path / "two")
    assert first[0] == second[0] == 0
    assert first[1] == second[1]
    one, two = contents(tmp_path / "one"), contents(tmp_path / "two")
    assert [path.name for path in one] == [path.name for path in two]
    assert list(one.values()) == list(two.values())
    names = {path.name for path in one}
    assert {"comparison.csv", "comparison.md", "convergence.png", "scenario-3.png"} <= names


def test_a_report_as_one_page(run, saved, tmp_path, monkeypatch):
    monkeypatch.setattr(webpage, "figures_of", lambda _: [])
    monkeypatch.setattr(webpage, "scenes_of", lambda *_: [])
    code, out, err = run("report", saved, "--html", "--output", tmp_path)
    assert code == 0
    assert "Comparison of the algorithms" in out
    assert err.splitlines()[-1] == f"wrote {tmp_path / 'report.html'}"
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.usefixtures("quick_pictures")
def test_tables_fit_eighty_columns(run, saved, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = run("report", saved, "--output", tmp_path)
    assert max(map(len, out.splitlines())) <= 80
    assert "…" not in out


@pytest.mark.usefixtures("quick_pictures")
def test_distances_from_the_best_known_are_printed_when_asked_for(run, saved, tmp_path):
    code, out, err = run("report", saved, "--output", tmp_path, "--gap")
    assert code == 0
    assert "gap" in out.splitlines()[1]
    assert out.index("Over all scenarios:") < out.index("By scenario:")
    assert 'Budget: 40 iterations (budget = "iterations")' in " ".join(out.split())
    assert "better than the best known" not in err
    written = {path.name for path in tmp_path.iterdir()}
    assert {"gap.csv", "gap.md", "gap-summary.csv", "gap-summary.md", "ecdf.png"} <= written


@pytest.mark.usefixtures("quick_pictures")
def test_what_is_better_than_the_best_known_is_told_with_how_to_keep_it(
    run, uninterrupted, tmp_path
):
    file = tmp_path / FILE
    js.save_results(uninterrupted.assign(best_known=("scenario", [1e6, np.nan])), file)
    *_, told = run("report", file, "--output", tmp_path)[2].splitlines()[:-1]
    assert told.startswith("scenario-1: run ")
    assert told.endswith(f"; `python experiments/best_known.py --results {file}` keeps it")


@pytest.mark.parametrize("named", [[], ["scenario-3"]])
def test_random_scenes_are_compared_alone_or_beside_others(
    run, tmp_path, monkeypatch, scenarios, named
):
    def draw(seed, obstacles):
        return scenarios[0].model_copy(update={"name": f"random-{seed}-{obstacles}"})

    def compared(chosen, *_, **__):
        seen.extend(getattr(each, "name", each) for each in chosen)
        raise KeyboardInterrupt

    seen: list[str] = []
    monkeypatch.setattr("jaxsusp.studies.random_scenario.random_scenario", draw)
    monkeypatch.setattr(comparison, "compare", compared)
    options = ["--scenarios", ",".join(named)] if named else []
    code, out, err = run("compare", "--random", "2", *options, "--output", tmp_path / "new")
    assert (code, out) == (130, "")
    assert seen == [*named, "random-0-5", "random-1-5"]
    assert err.splitlines()[:2] == ["drawing random-0-5", "drawing random-1-5"]


def test_random_scenes_of_a_comparison_that_goes_on_are_not_drawn_again(
    run, saved, tmp_path, monkeypatch, scenarios
):
    def draw(seed, obstacles):
        return scenarios[0].model_copy(update={"name": f"random-{seed}-{obstacles}"})

    def compared(chosen, *_, **__):
        seen.append(chosen)
        raise KeyboardInterrupt

    seen: list = []
    monkeypatch.setattr("jaxsusp.studies.random_scenario.random_scenario", draw)
    monkeypatch.setattr(comparison, "compare", compared)
    files = {"random-0-5": scenarios[2].model_copy(update={"name": "random-0-5"}).to_toml()}
    kept = js.load_results(saved).assign_attrs(scenario_files=json.dumps(files))
    js.save_results(kept, tmp_path / FILE)
    told = run("compare", "--random", "2", "--output", tmp_path, "--resume")[2]
    assert told.splitlines()[0] == "drawing random-1-5"
    assert [len(each.obstacles) for each in seen[0]] == [
        len(scenarios[2].obstacles), len(scenarios[0].obstacles),
    ]  # fmt: skip
    assert seen[0][0].digest == js.Scenario.from_toml(files["random-0-5"]).digest
    told = run("compare", "--random", "2", "--output", tmp_path)[2]
    assert told.splitlines()[0] == "drawing random-0-5"


@pytest.mark.usefixtures("quick_pictures")
def test_polishing_is_asked_for_on_the_command_line(run, tmp_path, monkeypatch):
    polished = []

    def polish_batch(problems, outcome):
        polished.append(outcome.x.shape)
        return outcome

    monkeypatch.setattr(workunit, "polish_batch", polish_batch)
    tiny = ["--runs", "1", "--iterations", "2", "--population", "4", "--search", "box"]
    options = ["--scenarios", "scenario-1", "--algorithms", "pso", *tiny, "--output", tmp_path]
    code, _, _ = run("compare", *options, "--polish")
    assert code == 0
    assert polished == [(1, 1, 15)]
    assert (js.load_results(tmp_path / FILE)["evaluations_polish"] > 0).all()
    code, _, err = run("compare", *options, "--resume")
    assert code == 2
    assert "polish (True and False)" in err


@pytest.mark.usefixtures("quick_pictures")
def test_the_papers_ratios_are_shown_only_beside_ours(run, saved, uninterrupted, tmp_path):
    _, out, _ = run("report", saved, "--output", tmp_path / "one")
    assert "SDBO / DBO" not in out
    assert not (tmp_path / "one" / "ratios.md").exists()
    both = tmp_path / "both.nc"
    js.save_results(uninterrupted.assign_coords(algorithm=["dbo", "sdbo"]), both)
    _, out, _ = run("report", both, "--output", tmp_path / "two")
    assert "SDBO / DBO" in out


# Bad input


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "--runs", "0"], "runs = 0: give a whole number of at least 1"),
        (["compare", "--random", "0"], "random = 0: give a whole number of at least 1"),
        (["compare", "--runs", "-1"], "runs = -1: give a whole number of at least 1"),
        (["compare", "--runs", "x"], "'--runs': 'x'; give a whole number"),
        (["compare", "--seed", "1.5"], "'--seed': '1.5'; give a whole number"),
        (["compare", "--iterations", ""], "'--iterations': ''; give a whole number"),
        (["compare", "--population", "2", "--algorithms", "dbo"], "population"),
        (["compare", "--scenarios", "scenario-7"], "scenario-7: is neither a file nor"),
        (["compare", "--scenarios", ""], "scenarios: none given"),
        (["compare", "--scenarios", "a,,b"], "scenarios = 'a,,b': one of the names is empty"),
        (["compare", "--algorithms", "ga,"], "algorithms = 'ga,': one of the names is empty"),
        (["compare", "--scenarios", "missing.toml"], "missing.toml: is neither a file"),
        (["compare", "--scenarios", "broken.toml"], "broken.toml: is not valid TOML"),
        (["compare", "--scenarios", "key.toml"], "key.toml: payload.mas = 9.0 is not a known key"),
        (["compare", "--scenarios", "inf.toml"], "inf.toml: payload.mass = inf must be finite"),
        (["compare", "--algorithms", "sdob"], 'did you mean "sdbo"'),
        (["compare", "--algorithms", ""], "algorithms: none given"),
        (["compare", "--algorithms", "ga,ga"], "'ga' is repeated"),
        (["compare", "--search", "foo"], "search = 'foo' is not known"),
        (["compare", "--budget", "times"], "budget = 'times' is not known"),
        (["compare", "--output", "broken.toml"], "output = broken.toml: is a file, not a folder"),
        (["compare", "--output", "old", "--resume"], "cannot be resumed, it differs in"),
        (["compare", "--colour"], "No such option: --colour"),
        (["report", "missing.nc"], "missing.nc: no such file"),
        (["report", "broken.toml"], "broken.toml: cannot be read as NetCDF-4"),
        (
            ["report", "old/compare.nc", "--output", "broken.toml"],
            "output = broken.toml: is a file",
        ),
        (["report", "old"], "old: is a folder, not a file; give old/compare.nc"),
        (["report", "."], ".: is a folder, not a file; give a compare.nc that `jaxsusp compare`"),
        (["compair"], "Did you mean 'compare'"),
    ],
)
def test_bad_input_is_one_message_and_status_2(
    run, saved, tmp_path, monkeypatch, arguments, message
):
    monkeypatch.chdir(tmp_path)
    text = js.load_scenario("scenario-1").to_toml()
    mass = next(line for line in text.splitlines() if line.startswith("mass"))
    Path("broken.toml").write_text("name = ")
    Path("key.toml").write_text(text.replace(mass, "mas = 9.0\n" + mass))
    Path("inf.toml").write_text(text.replace(mass, "mass = inf"))
    Path("old").mkdir()
    Path("old", FILE).write_bytes(saved.read_bytes())
    before = contents(tmp_path)
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert message in " ".join(err.split())
    assert "Traceback" not in err
    assert contents(tmp_path) == before


def test_bad_input_from_a_shell(tmp_path):
    done = subprocess.run(
        [*PROGRAM, "compare", "--algorithms", "sdob"],
        capture_output=True, text=True, cwd=tmp_path, env=ENVIRONMENT, timeout=100, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("algorithm = 'sdob' is not known; did you mean \"sdbo\"?")
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_fills_up_is_one_message(run, tmp_path, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    code, out, err = run("compare", *SMALL, "--output", tmp_path)
    assert (code, out) == (2, "")
    assert "cannot be written (No space left on device)" in err
    assert contents(tmp_path) == {}


# Interrupts at other times


def test_an_interrupt_before_anything_is_finished_says_so(run, tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(comparison, "_compute_missing", interrupted)
    code, out, err = run("compare", *SMALL, "--output", tmp_path / "new")
    assert (code, out) == (130, "")
    assert err == "Interrupted: no algorithm had finished; nothing was written.\n"
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_in_a_callback_that_swallows_it_is_not_lost(run, tmp_path, monkeypatch):
    def _xla_gc_callback():  # as JAX's is named
        signal.raise_signal(signal.SIGINT)
        return [None for _ in range(100)]

    def long_comparison(*_, **__):
        _xla_gc_callback()
        time.sleep(20)
        pytest.fail("the interrupt was lost")

    monkeypatch.setattr(comparison, "compare", long_comparison)
    before = signal.getsignal(signal.SIGINT)
    code, out, err = run("compare", "--output", tmp_path)
    assert (code, out) == (130, "")
    assert err.startswith("Interrupted: ")
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupt_while_drawing_says_that_the_comparison_is_complete(
    run, tmp_path, monkeypatch
):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("jaxsusp.report.comparison.folder.write_report", interrupted)
    code, _, err = run("compare", *SMALL, "--output", tmp_path)
    assert code == 130
    assert f"`jaxsusp report {tmp_path / FILE}` writes its report" in err
    assert js.load_results(tmp_path / FILE).sizes["algorithm"] == 2


# Progress and pictures


@pytest.mark.usefixtures("quick_pictures")
def test_pictures_have_plain_names_of_their_own(uninterrupted, tmp_path):
    text = js.load_scenario("scenario-1").to_toml()
    names = ["../up/α β", "Fitness"]
    odd = uninterrupted.assign_coords(scenario=names).assign_attrs(
        scenario_files=json.dumps(dict.fromkeys(names, text))
    )
    (tmp_path / "out").mkdir()
    files = {file.name for file in write_report(odd, tmp_path / "out")}
    assert {"up-α-β.png", "Fitness-2.png", "fitness.png"} <= files
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.usefixtures("quick_pictures")
def test_a_scenario_that_cannot_be_drawn_is_told_and_the_rest_written(uninterrupted, tmp_path):
    told = []
    text = js.load_scenario("scenario-1").to_toml()
    partly = uninterrupted.assign_attrs(scenario_files=json.dumps({"scenario-1": text}))
    files = write_report(partly, tmp_path, told.append)
    assert told == ["no picture of scenario-3: the dataset does not hold this scenario"]
    assert tmp_path / "scenario-1.png" in files
    assert np.isfinite(uninterrupted["fitness"]).all()


def test_report_puts_files_of_equal_settings_together(run, tmp_path):
    """`tests/files` holds a comparison that is written; its halves are reported as one."""
    import jaxsusp as js

    whole = js.load_results("tests/files/compare-0.1.0.nc")
    paths = [str(tmp_path / f"{name}.nc") for name in ("one", "other")]
    for path, place in zip(paths, (slice(1), slice(1, None)), strict=True):
        js.save_results(whole.isel(algorithm=place), path)
    code, out, _ = run("report", *paths, "--output", str(tmp_path / "report"))
    assert code == 0
    for name in whole["algorithm"].values.tolist():
        assert name in out
    ds = js.load_results(paths[1])
    ds.attrs["settings"] = ds.attrs["settings"].replace('"seed": 0', '"seed": 7')
    js.save_results(ds, paths[1])
    code, _, err = run("report", *paths, "--output", str(tmp_path / "report"))
    assert code == 2
    assert "differ in seed (0 and 7)" in err
    assert paths[1] in err
