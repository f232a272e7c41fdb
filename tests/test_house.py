"""The rules of the house: which room may import which, and how large rooms and files may get."""

import statistics
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[1] / "docs"))
import house

pytestmark = pytest.mark.fast

MODULES, IMPORTS = house.modules(), house.imports()


def test_every_room_is_in_the_list_and_says_what_it_is():
    folders = {path.parent.name for path in house.PACKAGE.glob("*/__init__.py")}
    assert folders == house.ROOMS.keys()
    for name, path in MODULES.items():
        assert house.sentence(path), f"{name} has no documentation"


def test_a_room_imports_only_rooms_before_it():
    """Also under TYPE_CHECKING and inside functions; there are no exceptions."""
    order = [*house.ROOT, *house.ROOMS]
    wrong = []
    for module, used in IMPORTS.items():
        room = house.room_of(module)
        if room in ("__init__", "__main__"):
            continue
        allowed = set(order[: order.index(room) + 1])
        if room in house.ROOT:
            allowed = set(house.ROOT)
        if room == "cli":  # for the version
            allowed.add("__init__")
        wrong += [f"{module} imports {each}" for each in used if house.room_of(each) not in allowed]
    assert wrong == []


def test_nothing_opens_a_door_to_all_rooms():
    """`import jaxsusp` lends every public name; a room's own `__init__` would lend a circle."""
    assert [name for name, path in MODULES.items() if house.opens_everything(path)] == []
    rooms = [name for name, path in MODULES.items() if path.name == "__init__.py"]
    assert [room for room in rooms if room != "__init__" and IMPORTS[room]] == []
    stubs = [*house.PACKAGE.rglob("*.pyi")]
    assert stubs == [house.PACKAGE / "__init__.pyi"]


def test_no_modules_import_one_another_in_a_circle():
    graph = {module: used - {"__init__"} for module, used in IMPORTS.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(reversed(error.args[1])))


def test_the_page_lists_todays_files():
    """`python docs/house.py` writes it anew."""
    page = (house.DOCS / "architecture.md").read_text(encoding="utf-8")
    assert house.listing() in page


EVERY_KIND = """
from typing import TYPE_CHECKING
import jaxsusp.vec3
from jaxsusp import errors
from . import segments
from ..mechanics import arm
from ..problem.fitness import curvature
if TYPE_CHECKING:
    from jaxsusp.cli.commands.plan import plan
def function(name):
    from jaxsusp.verify import constraints
    importlib.import_module("jaxsusp.planning.planner")
    __import__(f"jaxsusp.optim.algorithms.{name}")
"""


def test_imports_are_found_wherever_they_stand(monkeypatch):
    """The contract can fail: what it reads holds every kind of import."""
    monkeypatch.setattr(Path, "read_text", lambda *_, **__: EVERY_KIND)
    path = house.PACKAGE / "geometry" / "module.py"
    assert set(house._imported(path, MODULES)) == {
        "vec3", "errors", "geometry.segments", "mechanics.arm", "problem.fitness",
        "cli.commands.plan", "verify.constraints", "planning.planner", "optim.algorithms",
    }  # fmt: skip
    assert house.opens_everything(path)


def test_rooms_and_files_are_of_a_size_that_is_read_with_pleasure():
    lines = {
        name: len(path.read_text(encoding="utf-8").splitlines()) for name, path in MODULES.items()
    }
    assert {name for name in lines if "." not in name} - house.ROOMS.keys() == {
        *house.ROOT, "__init__", "__main__",
    }  # fmt: skip
    folders = [path.parent for path in MODULES.values()]
    assert max(folders.count(folder) for folder in folders) <= 14
    assert max(lines.values()) <= 350, max(lines, key=lines.__getitem__)
    assert statistics.median(lines.values()) <= 150
