"""What a shell is told while a command is typed, and what `jaxsusp` alone says."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import jaxsusp as js
from jaxsusp.cli.commandgroup import FIRST_STEPS
from jaxsusp.cli.completion import algorithm_names, one_of, scenario_names, some_of
from jaxsusp.optim import choices

COMPLETE = """
import sys
from jaxsusp.cli.main import main
sys.argv = ["jaxsusp"]
try:
    main()
finally:
    print("loaded", *sorted({"jax", "numpy", "matplotlib"} & sys.modules.keys()))
"""


def completed(line: str, folder=None) -> list[str]:
    """The words that bash is offered at the end of a line, by Typer's own protocol."""
    words = line.split(" ")
    asked = {
        "_JAXSUSP_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1),
    }  # fmt: skip
    ended = subprocess.run(
        [sys.executable, "-c", COMPLETE], capture_output=True, text=True, check=True, cwd=folder,
        env={**os.environ, "PYTHONPATH": str(Path(js.__file__).parents[1]), **asked},
    )  # fmt: skip
    *offered, loaded = ended.stdout.splitlines()
    assert loaded == "loaded"
    return offered


@pytest.mark.fast
def test_commands_are_completed():
    assert completed("jaxsusp wor") == ["workspace"]
    assert {"new", "check", "plan"} <= {*completed("jaxsusp ")}


@pytest.mark.fast
def test_names_and_files_of_scenarios_are_completed(tmp_path):
    (tmp_path / "scenic.toml").touch()
    (tmp_path / "scenic.txt").touch()
    assert completed("jaxsusp plan scen", tmp_path) == [*js.scenarios(), "scenic.toml"]


@pytest.mark.fast
def test_algorithms_are_completed_and_the_libraries_that_are_there(monkeypatch):
    monkeypatch.setattr(choices, "find_spec", lambda library: library == "pymoo" or None)
    assert algorithm_names("p") == ["pso", "pymoo:"]
    assert some_of(algorithm_names)("pso,p") == ["pso,pymoo:"]
    assert algorithm_names("evo") == []


@pytest.mark.fast
def test_files_in_folders_and_lists_of_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "yard.toml").touch()
    (tmp_path / "mine" / ".hidden.toml").touch()
    assert scenario_names("mi") == ["mine/"]
    assert scenario_names("mine/") == ["mine/yard.toml"]
    assert scenario_names("missing/") == []
    algorithms = some_of(one_of(["pso", "ga"]))
    assert algorithms("pso,g") == ["pso,ga"]
    assert algorithms("pso,") == ["pso,ga"]


@pytest.mark.fast
def test_help_names_how_completion_is_installed_and_nothing_more_of_it(run):
    _, out, _ = run("--help")
    assert "--install-completion" in out
    assert "--show-completion" not in out
    names = [line.split()[1] for line in out.splitlines() if line.startswith("│ ")]
    assert [name for name in names if name in ("new", "check", "plan", "report", "algorithms")] == [
        "new", "check", "plan", "report", "algorithms",
    ]  # fmt: skip


@pytest.mark.fast
def test_without_arguments_it_tells_what_to_do_next(run):
    status, out, err = run()
    assert (status, out, err) == (0, f"{FIRST_STEPS}\n", "")
    commands = [line.split()[1] for line in out.splitlines() if line.startswith("  jaxsusp ")]
    assert len(commands) == 5
    for command in set(commands):
        assert run(command, "--help")[0] == 0
