"""What `make bench-peers` measured and the page of it; how others' evaluations are counted."""

import json

import numpy as np
import pytest
from walking import paraboloid

import jaxsusp as js
from benchmarks.peers import __main__ as bench
from benchmarks.peers import tables
from benchmarks.peers.libraries import scipy
from benchmarks.peers.task import Objective, Task

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def kept():
    return json.loads(tables.KEPT.read_text(encoding="utf-8"))


def test_the_page_has_the_kept_numbers(kept):
    """`python -m benchmarks.peers --page` writes it anew."""
    text = tables.PAGE.read_text(encoding="utf-8")
    assert tables.page(kept, text) == text
    assert tables.page(kept, text.replace("×", "x")) == text


def test_every_library_was_measured_beside_ours(kept):
    for rows in kept["scenarios"].values():
        assert {row["library"] for row in rows} == set(bench.LIBRARIES)
        assert {row["beside"] for row in rows} == {"pso", "ga", "jde", "cmaes"}
        for row in rows:
            assert row["version"] == kept["versions"][row["library"]]
            assert row["ratio_least"] <= row["ratio"] <= row["ratio_most"]
            work = row["ours"]["evaluations"] / row["peer"]["evaluations"]
            assert row["ratio_per_evaluation"] == pytest.approx(row["ratio"] * work)
            for each in (row["ours"], row["peer"]):
                assert each["best"] <= each["mean"]
                assert 0 <= each["clear"] <= kept["settings"]["runs"]


def test_a_table_has_ours_above_its_peers(kept):
    for frame in tables.frames(kept):
        ours = frame["ratio"].isna()
        assert frame["optimiser"][ours].tolist() == ["pso", "ga", "jde", "cmaes"]
        assert not frame["per"][~ours].isna().any()
        assert frame["optimiser"].str.endswith(tables.SINGLE).any()


def test_a_library_that_is_not_there_is_one_line_and_the_rest_goes_on(monkeypatch, capsys):
    def without_pymoo(name):
        if name.endswith("pymoo"):
            raise ModuleNotFoundError("No module named 'pymoo'")
        return scipy

    monkeypatch.setattr(bench, "import_module", without_pymoo)
    found = bench.chosen(["pymoo:GA", "scipy"])
    assert [peer.library for peer in found] == ["scipy"]
    assert capsys.readouterr().out == "pymoo is left out: No module named 'pymoo'\n"
    assert bench.chosen(["scipy:other"]) == []


@pytest.fixture(scope="module")
def problem():
    return js.Problem(paraboloid, np.full(3, -2, np.float32), np.full(3, 2, np.float32))


def test_others_are_counted_by_what_they_ask_for(problem):
    task = Task(problem, runs=2, iterations=4, population=6)
    found = scipy.PEERS[0].go(task)
    assert found.evaluations == 2 * 6 * (4 + 1)
    assert found.x.shape == (2, 3)
    assert not np.array_equal(*found.x)


def test_an_objective_remembers_the_best_of_what_it_was_asked(problem):
    objective = Objective(problem)
    x = np.array([[9.0, 0.7, 0.7], [0.7, 0.7, 0.6], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(objective.many(x), [1.69, 0.01, 1.47], rtol=1e-5)
    assert objective.one(np.array([2.0, 2.0, 2.0])) == pytest.approx(5.07)
    assert objective.evaluations == 4
    np.testing.assert_array_equal(objective.x, x[1])
