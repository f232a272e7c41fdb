"""The suite bbob against COCO itself: functions, observer, postprocessing.

Functions agree to 1e-9 of |f| or |f - f_opt|, whichever is more: f_opt cancels against the rest
where f is near 0, and a share of nothing says nothing. No function needs an exception at random
points. Where two values differ by a step of f7 or f23, as they do within rounding of an edge of it,
none is the wrong one; random points do not come that near.
"""

import os
import warnings

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxsusp.studies.bbob import cocofiles, summary
from jaxsusp.studies.bbob.record import Record
from jaxsusp.studies.bbob.suite import FUNCTIONS, Landscape, landscape

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it looks for data archives, and says so where there is no web
    import cocoex
    import cocopp

DIMS, INSTANCES = (5, 10, 20), (1, 2, 15, 71)
NUMBERS = range(1, len(FUNCTIONS) + 1)
EVALUATIONS = 2000


@pytest.fixture(scope="module")
def value():
    return jax.jit(Landscape.population)


def points(rng: np.random.Generator, optimum: np.ndarray) -> np.ndarray:
    """In the box, about it, and near the optimum."""
    dim = len(optimum)
    near = optimum + rng.normal(size=(20, dim)) * 10 ** rng.uniform(-4, 0, (20, 1))
    return np.concatenate([rng.uniform(-5, 5, (60, dim)), rng.uniform(-9, 9, (40, dim)), near])


@pytest.mark.parametrize("dim", DIMS)
@pytest.mark.parametrize("number", NUMBERS)
def test_functions_are_cocos(value, number, dim):
    rng = np.random.default_rng([number, dim])
    for each in INSTANCES:
        ours, theirs = landscape(number, dim, each), cocoex.BareProblem("bbob", number, dim, each)
        x = points(rng, ours.at.optimum)
        known = np.array([theirs(point) for point in x])
        scale = np.maximum(np.abs(known), np.abs(known - ours.at.offset))
        error = np.abs(value(ours, jnp.asarray(x)) - known) / scale
        assert error.max() < 1e-9, (each, int(error.argmax()), error.max())


def approach(problem, optimum: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Points that come nearer and nearer to the optimum by chance, and what COCO makes of them."""
    rng = np.random.default_rng([problem.id_function, problem.id_instance])
    reach = 10.0 ** np.linspace(1, -11, EVALUATIONS)[:, None]
    x = optimum + reach * rng.uniform(-0.5, 0.5, (EVALUATIONS, len(optimum)))
    bare = cocoex.BareProblem("bbob", problem.id_function, len(optimum), problem.id_instance)
    return x, np.array([bare(point) for point in x])


@pytest.fixture(scope="module")
def replayed(tmp_path_factory):
    """The same evaluations on record of ours and under COCO's observer: both folders."""
    folder = tmp_path_factory.mktemp("bbob")
    before = os.getcwd()
    os.chdir(folder)  # the observer writes below the working folder
    suite = cocoex.Suite("bbob", "instances: 1-3", "dimensions: 5,10,20")
    observer = cocoex.Observer("bbob", "result_folder: theirs algorithm_name: replayed")
    told: dict[tuple[int, int], list[Record]] = {}
    least = jax.jit(lambda fitness: fitness(fitness.at.optimum))
    for problem in suite:
        dim, number = problem.dimension, problem.id_function
        fitness = landscape(number, dim, problem.id_instance)
        record = Record(dim, float(least(fitness)), EVALUATIONS)
        x, values = approach(problem, fitness.at.optimum, record.least)
        for first in range(0, EVALUATIONS, 97):
            record.add(x[first : first + 97], values[first : first + 97])
        problem.observe_with(observer)
        for point in x[: record.evaluations]:
            problem(point)
        assert problem.final_target_hit == (record.evaluations < EVALUATIONS)
        told.setdefault((number, dim), []).append(record)
    problem.free()
    ours, paragraphs = folder / "ours", []
    for (number, dim), records in told.items():
        cocofiles.write_data(ours, number, dim, records)
        paragraphs.append(cocofiles.paragraph("replayed", number, dim, (1, 2, 3), records))
    cocofiles.write_info(ours, paragraphs)
    os.chdir(before)
    return ours, folder / "exdata" / "theirs", told


def test_files_are_those_of_the_observer(replayed):
    """Byte for byte, every line of .info, .dat and .tdat."""
    ours, theirs, _ = replayed
    names = [path.relative_to(ours) for path in sorted(ours.rglob("*.*"))]
    assert len(names) == 24 + 2 * 24 * 3
    for name in names:
        assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name
    left_out = {path.suffix for path in theirs.rglob("*.*")} - {path.suffix for path in names}
    assert left_out == {".rdat", ".mdat"}  # restarts and recommendations: we have none


def test_the_postprocessing_reads_ours_and_finds_our_running_times(replayed):
    ours, _, told = replayed
    with warnings.catch_warnings():
        for three_instances in (".*less than 15 instances", ".*was not consistent"):
            warnings.filterwarnings("ignore", three_instances)
        # of COCO's own files it says the same
        warnings.filterwarnings("ignore", "settings is an additional attribute")
        read = cocopp.load(str(ours))
    assert len(read) == 24 * 3
    for each in read:
        for target in summary.CHOSEN:
            expected = running_time(told[each.funcId, each.dim], target)
            assert each.detERT([target])[0] == expected


def running_time(records: list[Record], target: float) -> float:
    """Expected running time; cocopp takes 1.0000e-8 for 1e-8, as f_opt leaves few digits."""
    spent = np.array([record.reached(np.array([target + 1e-12])).item() for record in records])
    there = np.isfinite(spent)
    ends = np.array([record.evaluations for record in records])
    return np.where(there, spent, ends).sum() / there.sum() if there.any() else np.inf
