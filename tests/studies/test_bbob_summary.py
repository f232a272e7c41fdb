"""Tables and pictures of runs on COCO's suite."""

import importlib.util
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from jaxsusp.report.render import to_markdown
from jaxsusp.studies.bbob import pictures, published, summary
from jaxsusp.studies.bbob.results import TARGETS, Result
from jaxsusp.studies.bbob.runs import Course
from jaxsusp.studies.bbob.suite import FUNCTIONS

COURSE = Course(2, (1, 2), 20_000)


@pytest.fixture(scope="module")
def found() -> list[Result]:
    """One run solves everything after 200 evaluations, the other reaches 1 after 20."""
    reached = np.full((2, len(TARGETS)), np.nan)
    reached[0], reached[1, :11] = 200, 20
    ends, distance = np.array([200, 20_000]), np.array([1e-9, 1.0])
    return [
        Result("pso", number, COURSE, ends, distance, reached, 0.0)
        for number in range(1, len(FUNCTIONS) + 1)
    ]


def test_running_times_count_what_was_spent_in_vain(found):
    table = summary.running_times(found).set_index(["function", "target"])
    assert len(table) == 24 * len(summary.CHOSEN)
    assert tuple(table.loc[3, 10.0][["reached", "evaluations"]]) == (2, 220)
    assert tuple(table.loc[3, 1e-8][["reached", "evaluations"]]) == (1, 20_200)


def test_distributions_count_runs_and_targets_alike(found):
    shares = summary.distributions(found).set_index("group")
    assert set(shares.index) == {*summary.PARTS, summary.SOLVED}
    few, all_of_one = 11 / 102, (51 + 11) / 102
    row = shares.loc[summary.ALL]
    np.testing.assert_allclose(row[["0.9", "1", "1.9", "2"]].to_numpy(float),
                               [0, few, few, all_of_one], atol=1e-4)  # fmt: skip
    assert shares.loc[summary.SOLVED, ["1.9", "2"]].tolist() == [0, 0.5]
    assert summary.distributions(found[:-1])["group"].tolist() == [*summary.GROUPS][:-1]


def known() -> published.Published:
    solved = np.array([100.0, np.nan])
    return {
        ("CMA", 2, number): published.Times(solved, np.array([110.0, 500.0]))
        for number in range(1, 25)
    }


def test_published_times_stand_beside_ours(found):
    times = summary.running_times(found)
    table = published.beside(times, known(), 2)
    assert table.loc[6].tolist() == ["f7 step ellipsoid", 10_100, 300]
    shares = published.solved(times, known(), 40)
    assert shares["D = 2"].tolist() == [0.5, 0]
    assert "| CMA\\* | 0 % |" in to_markdown(shares) or "| CMA* | 0 % |" in to_markdown(shares)


@pytest.mark.fast
def test_without_coco_there_are_no_published_times(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert published.published() == {}


def test_pictures_have_a_line_per_algorithm(found):
    shares = summary.distributions(found)
    panels = pictures.curves(shares, 2, "title").axes
    assert [len(panel.lines) for panel in panels] == [1] * 6
    (panel,) = pictures.beside_published(shares, known(), "title", "note").axes
    assert len(panel.lines) == 2
    assert panel.lines[1].get_ydata()[-1] == 0.5


def test_the_summary_that_is_kept_can_be_drawn():
    """What `python experiments/bbob.py --draw` draws without any run."""
    folder = Path(__file__).parents[2] / "experiments/data"
    times, shares = (pd.read_csv(folder / name) for name in ("bbob.csv", "bbob-curves.csv"))
    assert set(times["target"]) == set(summary.CHOSEN)
    assert (times.groupby(["algorithm", "dimension"])["function"].nunique() == 24).all()
    assert (times["reached"] <= times["runs"]).all()
    steps = shares[[f"{step:g}" for step in summary.STEPS]].to_numpy()
    assert (np.diff(steps, axis=1) >= 0).all()


def test_the_page_says_what_the_summary_that_is_kept_says():
    root = Path(__file__).parents[2]
    times = pd.read_csv(root / "experiments/data/bbob.csv")
    dimensions = sorted({*times["dimension"]})
    page = (root / "docs/howto/bbob.md").read_text(encoding="utf-8")
    for line in to_markdown(published.solved(times, {}, 10_000)).splitlines()[2:11]:
        assert line in page
    assert f"| | {' | '.join(f'D = {dim}' for dim in dimensions)} |" in page
