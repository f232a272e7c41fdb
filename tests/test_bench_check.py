"""Two trees in turns: what is compared, how sure a ratio is, and what is kept by release."""

import json
import subprocess
import sys

import numpy as np
import pytest
from scipy.stats import quantile_test

import jaxsusp as js
from benchmarks.check import __main__ as bench
from benchmarks.check import history
from benchmarks.check.canaries import CANARIES
from benchmarks.check.compared import compared, median_interval, table
from benchmarks.check.trees import HERE, Tree, tree
from jaxsusp.errors import InputError

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("count", [6, 9, 20, 41])
def test_the_interval_of_a_median_is_scipys(count):
    values = np.random.default_rng(count).gamma(2.0, size=count)
    theirs = quantile_test(values, p=0.5).confidence_interval(0.95)
    mine = median_interval(values)
    assert mine[:2] == (theirs.low, theirs.high)
    assert mine.level >= 0.95


def test_five_values_have_no_interval_of_95_percent_and_say_so():
    low, high, level = median_interval([3.0, 1.0, 5.0, 2.0, 4.0])
    assert (low, high) == (1.0, 5.0)
    assert level == pytest.approx(1 - 2 / 2**5)


def test_slower_is_what_no_chance_explains():
    first = [1.0, 1.1, 0.9, 1.05, 0.95, 1.0]
    assert compared("a", first, [1.2 * each for each in first]).slower
    assert not compared("a", first, [1.03 * each for each in first]).slower  # tolerated
    once_quick = [1.5, 1.6, 1.4, 1.5, 1.4, 0.8]
    assert not compared("a", first, once_quick).slower
    assert compared("a", first, once_quick).ratio > 1.3
    frame = table([compared("a", first, [2 * each for each in first])], ("old", "new"))
    assert frame["verdict"].tolist() == ["slower"]
    assert frame["ratio"].tolist() == pytest.approx([2.0])


def test_trees_take_turns_and_the_first_round_does_not_count(tmp_path, monkeypatch):
    asked, seconds = [], iter(range(100))

    def timed(self, names):
        asked.append(self.name)
        return dict.fromkeys(names, float(next(seconds)))

    monkeypatch.setattr(Tree, "timed", timed)
    two = [Tree("a", tmp_path, tmp_path), Tree("b", tmp_path, tmp_path)]
    a, b = bench.in_turns(two, ["plan"], 5)
    assert "".join(asked) == "baabbaabbaab"
    assert (a["plan"], b["plan"]) == ([2.0, 5.0, 6.0, 9.0, 10.0], [3.0, 4.0, 7.0, 8.0, 11.0])


def test_a_folder_is_run_as_it_stands_and_its_faults_are_one_message(tmp_path):
    here = tree(str(HERE), tmp_path)
    assert here.timed(["start-up"])["start-up"] > 0
    other = tmp_path / "other" / "jaxsusp"
    other.mkdir(parents=True)
    with pytest.raises(InputError, match="holds no jaxsusp; give a checkout"):
        tree(str(other.parent), tmp_path)
    (other / "__init__.py").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"its canaries do not run \(.*load_scenario"):
        tree(str(other.parent), tmp_path).timed(["plan"])


def test_a_revision_is_unpacked(tmp_path):
    if subprocess.run(["git", "rev-parse"], cwd=HERE, capture_output=True, check=False).returncode:
        pytest.skip("no checkout of git")
    found = tree("HEAD", tmp_path)
    assert (found.folder / "jaxsusp" / "__init__.py").is_file()
    assert found.folder.is_relative_to(tmp_path)
    with pytest.raises(InputError, match=r"tree = no-such: is neither a folder nor a revision"):
        tree("no-such", tmp_path)


def test_a_canary_of_another_package_than_the_trees_is_refused(tmp_path):
    """An installed one would answer in its place."""
    (tmp_path / "kept").mkdir()
    with pytest.raises(InputError, match="the package comes from"):
        Tree("a", HERE, tmp_path / "kept")._replace(folder=tmp_path).timed(["start-up"])


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ([], "against: give a folder or a revision"),
        (["--against", "main", "--turns", "4"], "turns = 4: give a whole number of at least 5"),
        (["--against", "main", "--canaries", "plam"], 'did you mean "plan"?'),
    ],
)
def test_what_cannot_be_is_one_message(monkeypatch, asked, told):
    monkeypatch.setattr(sys, "argv", ["check", *asked])
    with pytest.raises(InputError) as refused:
        bench.main()
    assert told in str(refused.value)


def test_a_release_is_kept_with_what_it_was_measured_on(tmp_path):
    seconds = {name: [0.3, 0.1, 0.2, 0.2, 0.15] for name in CANARIES}
    path = history.keep(history.entry(seconds, 0.2), tmp_path)
    assert path.name == f"{js.__version__}.json"
    found = json.loads(path.read_text(encoding="utf-8"))
    assert found["seconds"]["plan"] == {"median": 0.2, "from": 0.1, "to": 0.3}
    later = {**found, "release": "0.10.0"}
    history.keep(later, tmp_path)
    assert [each["release"] for each in history.entries(tmp_path)] == [js.__version__, "0.10.0"]
    assert history.table(history.entries(tmp_path))["plan"].tolist() == [0.2, 0.2]


def test_what_is_kept_tells_machine_versions_and_command():
    for each in history.entries():
        assert each["turns"] >= 5
        assert each["machine"]["processor"]
        assert each["machine"]["cores"] >= 1
        assert {"jax", "jaxlib", "numpy", "python"} <= each["versions"].keys()
        assert each["command"] == history.COMMAND
        for name, times in each["seconds"].items():
            assert name in CANARIES
            assert 0 < times["from"] <= times["median"] <= times["to"]
