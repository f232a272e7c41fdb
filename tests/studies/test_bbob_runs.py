"""Runs on COCO's suite: what is on record of them, and the files and tables that come of it."""

import jax
import numpy as np
import pytest

from jaxsusp.errors import InputError
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.loop import count_evaluations
from jaxsusp.optim.registry import algorithm
from jaxsusp.problem.problem import stack_problems
from jaxsusp.studies.bbob import cocofiles, results, runs, suite
from jaxsusp.studies.bbob.record import Record, series
from jaxsusp.studies.bbob.runs import Course, run_function
from jaxsusp.studies.bbob.suite import landscape, problem_of

COURSE = Course(dim=3, instances=(1, 2, 4), budget=500, population=11)


@pytest.fixture
def one_function(monkeypatch):
    """Programs of one branch compile in a moment."""
    monkeypatch.setattr(suite, "FUNCTIONS", suite.FUNCTIONS[:1])
    yield
    runs._programs.cache_clear()


@pytest.mark.parametrize("name", ["pso", "dbo"])
def test_runs_are_those_of_the_package_and_do_not_depend_on_their_company(one_function, name):
    """Run i of function f is run 1000 f + i of `run_batch`, with all that it evaluates."""
    optimizer, number = algorithm(name), 2
    records = run_function(optimizer, 1, COURSE).records
    problem = problem_of(landscape(1, COURSE.dim, number), COURSE.dim)
    counted = count_evaluations(optimizer, problem, COURSE.population)
    iterations = -(-(COURSE.budget - counted.initial) // counted.per_step)
    history = run_batch(
        stack_problems([problem]), optimizer, 0, [1000 + number], iterations, COURSE.population
    ).history[0, 0]
    spent, distance = np.concatenate(records[1]._steps, axis=1)
    ends = counted.initial + counted.per_step * np.arange(1, iterations)
    known = [distance[spent <= end][-1] for end in ends] + np.float64(records[1].least)
    np.testing.assert_allclose(known, history[:-1], rtol=1e-9)
    assert [record.evaluations for record in records] == [500] * 3


def told(values, budget=100, portion=100) -> Record:
    record = Record(2, 10.0, budget)
    x = np.arange(2.0 * len(values)).reshape(-1, 2)
    for first in range(0, len(values), portion):
        record.add(x[first : first + portion], np.array(values[first : first + portion]))
    return record


VALUES = [13.0, 14.0, 12.9, 12.0, 12.0, 11.99, 10.5, 11.0, 10.001, 10.001, 10.0009]


@pytest.mark.fast
@pytest.mark.parametrize("portion", [1, 4, 100])
def test_a_record_does_not_depend_on_the_portions_that_it_is_told(portion):
    record = told(VALUES, portion=portion)
    # The classes end at 10^(k/20), so 1.99 is in the one below 2, and 0.0009 in that of 0.001;
    # the second improvement is always logged, and so is the end.
    assert record.by_target().evaluation.tolist() == [1, 3, 4, 6, 7, 9, 11]
    assert record.by_number().evaluation.tolist() == [*range(1, 9), 10, 11]
    np.testing.assert_array_equal(record.reached(np.array([5, 2, 0.5, 1e-3, 1e-8])),
                                  [1, 4, 7, 9, np.nan])  # fmt: skip
    assert record.best_x.tolist() == [20.0, 21.0]


@pytest.mark.fast
def test_a_nan_never_wins():
    record = told([np.nan, 12.0, np.nan])
    assert (record.best, record.evaluations) == (12.0, 3)
    assert record.by_number().best[-1] == 12.0


@pytest.mark.fast
def test_a_run_ends_where_it_is_solved_or_its_budget_is_spent():
    solved = told([11.0, 10 + 0.5e-8, 10.0, 9.0], portion=2)
    assert (solved.evaluations, solved.ended) == (2, True)
    spent = told([11.0] * 30, budget=20, portion=7)
    assert (spent.evaluations, spent.ended) == (20, True)
    assert not told([11.0] * 3).ended


@pytest.mark.fast
def test_numbers_that_are_logged():
    assert series(3, 60).tolist() == [
        *(1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 14, 15, 17, 19, 22, 25, 28, 30, 31, 35, 39, 44),
        *(50, 56, 60),
    ]  # fmt: skip


DAT = """\
% f evaluations | g evaluations | best noise-free fitness - Fopt (1.000000000000e+01) + sum g_i+ \
| measured fitness | best measured fitness or single-digit g-values | x1 | x2...
1 0 +3.000000000e+00 +1.300000000e+01 +1.300000000e+01 +0.0000e+00 +1.0000e+00
2 0 +5.000000000e-01 +1.050000000e+01 +1.050000000e+01 +2.0000e+00 +3.0000e+00
3 0 +5.000000000e-01 +1.050000000e+01 +1.050000000e+01 +2.0000e+00 +3.0000e+00
"""

INFO = """\
suite = 'bbob', funcId = 7, DIM = 2, Precision = 1.000e-08, algId = 'pso', \
coco_version = '2.8.2', logger = 'bbob', data_format = 'bbob-new2', settings = ''
% \n\
data_f7/bbobexp_f7_DIM2.dat, 4:3|5.0e-01"""


def test_files_are_in_the_layout_of_coco(tmp_path):
    """`tests/reference/test_bbob.py` compares whole runs with COCO's observer."""
    record = told([13.0, 10.5, 12.0])
    cocofiles.write_data(tmp_path, 7, 2, [record])
    told_of = cocofiles.paragraph("pso", 7, 2, [4], [record])
    cocofiles.write_info(tmp_path, [told_of])
    assert (tmp_path / "data_f7/bbobexp_f7_DIM2.dat").read_text() == DAT
    assert (tmp_path / "bbobexp_f7.info").read_text() == INFO
    lines = (tmp_path / "data_f7/bbobexp_f7_DIM2.tdat").read_text().splitlines()
    assert [line.split()[3] for line in lines[1:]] == [
        *("+1.300000000e+01", "+1.050000000e+01", "+1.200000000e+01"),
    ]


def test_results_come_back_and_other_settings_are_refused(tmp_path):
    course = Course(2, (1, 2), 100)
    kept = results.result("pso", 7, course, [told(VALUES), told([11.0])], 1.5)
    results.save(kept, tmp_path)
    (back,) = results.load_all(tmp_path)
    jax.tree.map(np.testing.assert_array_equal, back._asdict(), kept._asdict())
    path = results.file_of(tmp_path, "pso", 2, 7)
    results.require_same(path, course)
    with pytest.raises(InputError, match=r"budget = 200: .* was made with 100"):
        results.require_same(path, course._replace(budget=200))
