"""The wheel holds the package with its data and nothing else; built in a second, offline."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "jaxsusp"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> zipfile.ZipFile:
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory"]
    subprocess.run([*command, str(folder)], cwd=ROOT, check=True, capture_output=True)
    (built,) = folder.iterdir()
    return zipfile.ZipFile(built)


def names(wheel: zipfile.ZipFile) -> set[str]:
    return {name for name in wheel.namelist() if ".dist-info/" not in name}


def in_package() -> set[str]:
    """All that people wrote; what Python and systems leave behind is hidden or in a cache."""
    files = (path for path in PACKAGE.rglob("*") if path.is_file())
    return {
        path.relative_to(ROOT).as_posix()
        for path in files
        if "__pycache__" not in path.parts and not path.name.startswith(".")
    }


def test_it_holds_every_file_of_the_package_and_nothing_else(wheel):
    assert names(wheel) == in_package()


def test_data_comes_along(wheel):
    held = names(wheel)
    for there in (
        "jaxsusp/py.typed",
        "jaxsusp/__init__.pyi",
        "jaxsusp/comparison/data/best_known.json",
        "jaxsusp/report/comparison/data/table1.csv",
        "jaxsusp/report/comparison/data/tables2_3.csv",
    ):
        assert there in held
    data = "jaxsusp/scenario/data"
    scenarios = {name for name in held if name.startswith(f"{data}/scenarios/")}
    assert scenarios == {f"{data}/scenarios/scenario-{number}.toml" for number in range(1, 7)}
    assert f"{data}/examples/hybrid.toml" in held
    assert not [name for name in held if "test" in Path(name).parts or "__pycache__" in name]


def test_it_says_what_it_needs_and_what_it_runs(wheel):
    (metadata,) = (name for name in wheel.namelist() if name.endswith("/METADATA"))
    text = wheel.read(metadata).decode()
    assert "Requires-Python: <3.14,>=3.11" in text
    for need in ("jax", "cvxpy", "clarabel", "mujoco", "typer", "xarray"):
        assert f"Requires-Dist: {need}" in text
    for tool in ("pytest", "nbclient", "jupyterlab", "hatchling"):
        assert f"Requires-Dist: {tool}" not in text
    points = wheel.read(metadata.replace("METADATA", "entry_points.txt")).decode()
    assert "jaxsusp = jaxsusp.cli.main:main" in points
