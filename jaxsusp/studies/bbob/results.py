"""What is kept of all runs of one function: when targets were reached. One small file each."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from jaxsusp._files import atomic_path
from jaxsusp._types import Float
from jaxsusp.errors import require
from jaxsusp.optim.choices import ALGORITHMS
from jaxsusp.studies.bbob.cocofiles import Paragraph
from jaxsusp.studies.bbob.record import Record
from jaxsusp.studies.bbob.runs import Course

TARGETS = 10.0 ** np.round(np.linspace(2, -8, 51), 1)
"""Distances to f_opt, 100 to 1e-8, five per decade: those of COCO's curves."""

LAST = -1
"""The place of 1e-8 among them."""


class Result(NamedTuple):
    """The runs of an algorithm on one function in one dimension."""

    algorithm: str
    function: int
    course: Course
    evaluations: np.ndarray  # (instances,), until the function was solved, or the budget
    distance: Float[np.ndarray, "instances"]  # best f - f_opt
    reached: Float[np.ndarray, "instances targets"]  # evaluations until `TARGETS`; NaN: never
    seconds: float

    @property
    def paragraph(self) -> Paragraph:
        """What COCO's .info file says of it."""
        ends = zip(self.course.instances, self.evaluations.tolist(), self.distance, strict=True)
        dim = self.course.dim
        return Paragraph(self.algorithm, self.function, dim, tuple(ends))


def result(
    algorithm: str, function: int, course: Course, records: list[Record], seconds: float
) -> Result:
    """What is kept of the records of all instances."""
    return Result(
        algorithm,
        function,
        course,
        np.array([record.evaluations for record in records]),
        np.array([record.best - record.least for record in records]),
        np.stack([record.reached(TARGETS) for record in records]),
        seconds,
    )


def file_of(folder: Path, algorithm: str, dim: int, function: int) -> Path:
    """Where a result is kept."""
    return folder / "runs" / f"{algorithm}-d{dim:02}-f{function:02}.npz"


def save(found: Result, folder: Path) -> None:
    """Keep a result, atomically: where the file is, the function is done."""
    path = file_of(folder, found.algorithm, found.course.dim, found.function)
    path.parent.mkdir(parents=True, exist_ok=True)
    of = {"algorithm": found.algorithm, "function": found.function, **found.course._asdict()}
    arrays = {name: getattr(found, name) for name in ("evaluations", "distance", "reached")}
    with atomic_path(path) as scratch:
        np.savez_compressed(scratch, of=json.dumps(of), seconds=found.seconds, **arrays)


def load(path: Path) -> Result:
    """A result that was kept."""
    with np.load(path) as kept:
        of = json.loads(str(kept["of"]))
        evaluations, distance, reached = kept["evaluations"], kept["distance"], kept["reached"]
        seconds = float(kept["seconds"])
    algorithm, function = of.pop("algorithm"), of.pop("function")
    course = Course(**{**of, "instances": tuple(of["instances"])})
    return Result(algorithm, function, course, evaluations, distance, reached, seconds)


def load_all(folder: Path) -> list[Result]:
    """All that is kept in a folder: by dimension, algorithms in the package's order, function."""
    order = {name: place for place, name in enumerate(ALGORITHMS)}
    found = [load(path) for path in (folder / "runs").glob("*.npz")]
    return sorted(found, key=lambda each: (each.course.dim, order[each.algorithm], each.function))


def require_one_course(found: Sequence[Result]) -> None:
    """Refuse results that do not belong into one table.

    Raises:
        InputError: two differ in the budget per dimension, the instances, population or seed.
    """
    courses = [
        each.course._replace(dim=1, budget=each.course.budget // each.course.dim) for each in found
    ]
    for course in courses:
        for name in course._fields:
            one, other = getattr(courses[0], name), getattr(course, name)
            told = "budget per dimension" if name == "budget" else name
            require(
                one == other,
                f"{told}: some runs were made with {one}, some with {other}; give each a folder "
                "of its own",
            )


def require_same(path: Path, course: Course) -> None:
    """Refuse to go on with other settings than those that a result was made with.

    Raises:
        InputError: a setting differs; the message names it.
    """
    kept = load(path).course
    for name in course._fields:
        there, asked = getattr(kept, name), getattr(course, name)
        require(
            there == asked,
            f"{name} = {asked}: {path} was made with {there}; repeat it, or choose another folder",
        )
