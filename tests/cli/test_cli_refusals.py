"""What cannot be is told before any work, in the same words by every command and by the library."""

import os
from pathlib import Path

import pytest

import jaxsusp as js
from jaxsusp._files import require_folder
from jaxsusp.errors import InputError
from jaxsusp.suspension.workspace import workspace

pytestmark = pytest.mark.fast

WRITING = [
    ["compare", "--output"],
    ["report", "compare.nc", "--output"],
    ["plan", "scenario-1", "--output"],
    ["freespace", "scenario-1", "--output"],
    ["workspace", "scenario-1", "--output"],
    ["verify", "plan.json", "--images"],
]


@pytest.mark.parametrize("command", WRITING, ids=lambda command: command[0])
def test_a_folder_that_cannot_be_is_refused_first(run, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    Path("afile").touch()
    name = command[-1].removeprefix("--")
    for folder, wrong in (
        ("afile", "is a file, not a folder"),
        ("afile/x", "afile is a file, not a folder"),
        ("/proc/x", "cannot be written (No such file or directory)"),
        ("x" * 300, "cannot be written (File name too long)"),
    ):
        status, said, told = run(*command, folder)
        assert (status, said) == (2, "")
        assert told == f"{name} = {folder}: {wrong}; choose another folder\n"
    assert os.listdir() == ["afile"]


@pytest.mark.parametrize(
    ("option", "given", "wrong"),
    [
        ("--video", "p.txt", "give a file name that ends in .mp4"),
        ("--video", "p", "give a file name that ends in .mp4"),
        ("--model", "m.json", "give a file name that ends in .xml"),
        ("--model", "folder.xml", "is a folder, not a file; choose another name"),
        ("--model", "afile/m.xml", "its folder is a file, not a folder; choose another folder"),
        ("--video", "/proc/x/p.mp4", "its folder cannot be written (No such file or directory); "
            "choose another folder"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_is_refused_first(run, tmp_path, monkeypatch, option, given, wrong):
    monkeypatch.chdir(tmp_path)
    Path("afile").touch()
    Path("folder.xml").mkdir()
    status, said, told = run("verify", "plan.json", option, given)
    assert (status, said) == (2, "")
    assert told == f"{option.removeprefix('--')} = {given}: {wrong}\n"


@pytest.mark.parametrize(
    ("command", "setting", "value"),
    [
        ("compare", "runs", 0),
        ("compare", "iterations", 0),
        ("compare", "population", 0),
        ("compare", "seed", -3),
        ("compare", "waypoints", 0),
        ("compare", "samples", 2),
        ("plan", "runs", 0),
        ("plan", "iterations", -1),
        ("plan", "population", 0),
        ("plan", "seed", 2**32),
        ("plan", "retries", -1),
        ("plan", "waypoints", 0),
        ("plan", "samples", 2),
        ("freespace", "limit", 0),
        ("freespace", "limit", 1),
        ("freespace", "seed", -3),
        ("freespace", "coverage", 2.0),
        ("freespace", "coverage", 0.0),
        ("workspace", "spacing", -1.0),
        ("workspace", "spacing", float("nan")),
        ("workspace", "spacing", 1000.0),
    ],
)
def test_numbers_out_of_range_are_told_in_the_words_of_the_library(
    run, tmp_path, command, setting, value
):
    scenario = js.load_scenario("scenario-1")
    library = {
        "compare": lambda: js.compare("scenario-1", "pso", search="box", **{setting: value}),
        "plan": lambda: js.plan(scenario, **{setting: value}),
        "freespace": lambda: js.free_space(scenario, **{setting: value}),
        "workspace": lambda: workspace(scenario, **{setting: value}),
    }
    with pytest.raises(InputError) as refused:
        library[command]()
    where = [] if command == "compare" else ["scenario-1"]
    output = tmp_path / "out"
    status, said, told = run(command, *where, f"--{setting}", value, "--output", output)
    assert (status, said) == (2, "")
    assert told == f"{refused.value}\n"
    assert told.startswith(setting)
    assert not output.exists()


def test_the_least_values_are_taken(run):
    """Options are read in turn: the last one alone is wrong."""
    least = ["--runs", 1, "--iterations", 1, "--population", 1, "--waypoints", 1, "--samples", 3]
    _, _, told = run("plan", "scenario-1", *least, "--retries", 0, "--seed", 0, "--ends", "here")
    assert told.startswith("ends = 'here'")
    _, _, told = run("freespace", "scenario-1", "--limit", 2, "--coverage", 0.1, "--solver", "x")
    assert told.startswith("solver = 'x'")


def test_the_remedy_for_a_coarse_grid_is_one():
    scenario = js.load_scenario("scenario-1")
    with pytest.raises(InputError, match="fewer than 3 cells along an axis; give") as refused:
        workspace(scenario, 5.0)
    remedy = float(str(refused.value).split()[-3])
    assert min(workspace(scenario, remedy).clear.shape) == 3


def test_a_folder_of_folders_that_are_not_there_is_taken_and_not_made(tmp_path):
    require_folder("output", tmp_path / "a" / "b")
    require_folder("output", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match=r"cannot be written \(Permission denied\)"):
        require_folder("output", tmp_path / "a")
