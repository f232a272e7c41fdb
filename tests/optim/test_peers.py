"""Algorithms of other libraries by name: what is said of them, with none of them installed.

`tests/reference/test_peers.py` holds those that are against their own libraries.
"""

import sys
from pathlib import Path
from types import ModuleType

import pytest
from walking import SIZES, paraboloid, walk

import jaxsusp as js
from jaxsusp.optim import choices
from jaxsusp.optim.registry import algorithm, algorithms, describe, peers

pytestmark = pytest.mark.fast


@pytest.fixture
def none(monkeypatch):
    monkeypatch.setattr(choices, "find_spec", lambda _: None)


@pytest.fixture
def one(monkeypatch):
    """A library in place of pymoo, with one algorithm."""
    adapter = ModuleType("adapter")
    adapter.names = lambda: ["GA"]
    adapter.make = lambda name: walk(name=f"pymoo:{name}")
    adapter.describe = lambda name: f"{name} in one line"
    monkeypatch.setitem(sys.modules, "jaxsusp.optim.peers.pymoo", adapter)
    monkeypatch.setattr(choices, "find_spec", lambda library: library == "pymoo" or None)


@pytest.mark.parametrize("name", ["evosax:CMA_ES", "pymoo:GA", "pymoo:no such"])
def test_a_library_that_is_not_there_is_named_with_the_command_that_brings_it(none, name):
    library = name.partition(":")[0]
    message = rf'"{name}": {library} is not installed; pip install "\.\[peers\]" in a copy'
    with pytest.raises(js.InputError, match=message):
        algorithm(name)
    assert peers() == []


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("evosacks:PSO", 'evosacks.* is not known; did you mean "evosax"'),
        ("pyswarms:PSO", "choose from evosax, pymoo"),
        ("evosax", 'is a library; name one of its algorithms, such as "evosax:CMA_ES"'),
        ("psoo", 'did you mean "pso"'),
        ("SDBO", 'did you mean "sdbo"'),
    ],
)
def test_a_mistyped_name_is_told(one, name, message):
    with pytest.raises(js.InputError, match=message):
        algorithm(name)


def test_what_is_installed_is_found_by_name(one):
    assert peers() == ["pymoo:GA"]
    assert describe("pymoo:GA") == "GA in one line"
    assert [each.name for each in algorithms(["pso", "pymoo:GA"])] == ["pso", "pymoo:GA"]
    assert "pymoo:GA" not in [each.name for each in algorithms("all")]
    problem = js.Problem(paraboloid, [-2.0] * 3, [2.0] * 3)
    assert js.minimize(problem, "pymoo:GA", runs=1, **SIZES).evaluations == 9 + 12 * 6


def test_every_library_has_an_adapter():
    folder = Path(choices.__file__).parent / "peers"
    assert {path.stem for path in folder.glob("[!_]*.py")} == choices.PEERS.keys()
