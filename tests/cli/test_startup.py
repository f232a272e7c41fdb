"""Help and mistakes are answered at once: nothing heavy is imported for them."""

import os
import subprocess
import sys

import pytest

import jaxsusp as js

HEAVY = "jax numpy scipy pandas xarray cvxpy mujoco matplotlib trimesh"
RUN = f"""
import sys
from jaxsusp.cli.main import main
sys.argv[0] = "jaxsusp"
try:
    main()
except SystemExit as ended:
    print("status", ended.code or 0)
print("loaded", *sorted(set({HEAVY.split()}) & sys.modules.keys()))
"""


def answer(*arguments: str) -> tuple[str, str]:
    ended = subprocess.run(
        [sys.executable, "-c", RUN, *arguments], capture_output=True, text=True, check=True
    )
    return ended.stdout, ended.stderr


COMMANDS = [
    *("new", "check", "plan", "verify", "freespace", "workspace", "compare", "report", "show"),
    *("scenarios", "algorithms", "cache"),
]


@pytest.mark.fast
@pytest.mark.parametrize("command", ["", *COMMANDS])
def test_help_loads_nothing_heavy(command):
    said, _ = answer(*command.split(), "--help")
    assert "Usage: jaxsusp" in said
    assert said.endswith("status 0\nloaded\n")


@pytest.mark.fast
def test_the_version_is_that_of_the_package():
    said, _ = answer("--version")
    assert said == f"jaxsusp {js.__version__}\nstatus 0\nloaded\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("check scenaro-1", 'did you mean "scenario-1"'),
        ("new my.txt", "give a file name that ends in .toml"),
        ("new my.toml --robots 2", "give a whole number from 3 to 12"),
        ("plan scenaro-1", 'did you mean "scenario-1"'),
        ("freespace scenario-7", "neither a file nor a built-in scenario"),
        ("workspace missing.toml", "neither a file nor a built-in scenario"),
        ("compare --scenarios scenario-1,scenario-9", "scenario-9: is neither"),
        ("compare --algorithms pso,sdob", 'did you mean "sdbo"'),
        ("compare --algorithms evosacks:PSO", 'did you mean "evosax"'),
        ("compare --algorithms pymoo", 'such as "pymoo:GA"'),
        ("compare --search boxx", 'did you mean "box"'),
        ("compare --budget times", "choose from evaluations, iterations, time"),
        ("plan scenario-1 --algorithm psoo", 'did you mean "pso"'),
        ("plan scenario-1 --ends place", 'did you mean "placed"'),
        ("plan scenario-1 --coordination jonit", 'did you mean "joint"'),
        ("compare --itertions 5", "No such option"),
        ("compere", "No such command"),
        ("compare --runs x", "give a whole number"),
        ("compare --runs 0", "runs = 0: give a whole number of at least 1"),
        ("plan scenario-1 --retries -1", "retries = -1: give a whole number of at least 0"),
        ("freespace scenario-1 --coverage 2", "coverage = 2.0: give a share"),
        ("freespace scenario-1 --solver HIGHS", "choose from CLARABEL"),
        ("workspace scenario-1 --spacing -1", "spacing = -1.0: give a length above 0 m"),
        ("plan scenario-1 --output pyproject.toml", "is a file, not a folder"),
        ("show scenaro-1", 'did you mean "scenario-1"'),
        ("show scenario-1 --output page.txt", "give a file name that ends in .html"),
        ("verify plan.json --video p.txt", "give a file name that ends in .mp4"),
        ("compare --algorithms pso,,ga", "one of the names is empty"),
    ],
)
def test_a_mistake_is_told_before_anything_heavy_is_loaded(arguments, message):
    said, told = answer(*arguments.split())
    assert message in told
    assert said == "status 2\nloaded\n"


@pytest.mark.fast
def test_importing_the_package_loads_nothing_and_all_names_are_there():
    code = f"""
import sys, jaxsusp as js
assert not set({HEAVY.split()}) & sys.modules.keys()
assert {{"plan", "compare", "Problem", "sdbo"}} <= set(dir(js)) == set(js.__all__)
missing = [name for name in js.__all__ if not hasattr(js, name)]
assert missing == [], missing
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_terminal_that_cannot_write_all_signs_ends_no_command():
    """Whatever the locale: what cannot be written is replaced."""
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    command = [sys.executable, "-m", "jaxsusp", "check", "no-such-scenario-ü…"]
    ended = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert (ended.returncode, ended.stdout) == (2, "")
    assert "no-such-scenario-??" in ended.stderr
    assert "Traceback" not in ended.stderr
