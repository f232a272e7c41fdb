"""The ellipsoid of largest volume inside a polytope (Eq. 23), stated once in cvxpy, re-solved."""

import functools
import warnings
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from jaxtyping import Float

from jaxsusp.errors import InputError, require, require_known
from jaxsusp.freespace.choices import SOLVER, solvers
from jaxsusp.freespace.polyhedra import HalfSpaces, Point

if TYPE_CHECKING:  # it takes long to import, and most free spaces come from a cache
    import cvxpy as cp


class Ellipsoid(NamedTuple):
    """{C u + d : ‖u‖ <= 1}, as in Eq. 23."""

    C: Float[np.ndarray, "3 3"]
    d: Point

    @classmethod
    def ball(cls, center: Point, radius: float) -> "Ellipsoid":
        """A sphere."""
        return cls(radius * np.eye(3), np.asarray(center, np.float64))

    @property
    def volume(self) -> float:
        """m³."""
        return 4 / 3 * np.pi * abs(float(np.linalg.det(self.C)))


class _Program(NamedTuple):
    """Eq. 23 for some number of half-spaces."""

    problem: "cp.Problem"
    A: "cp.Parameter"
    b: "cp.Parameter"
    C: "cp.Expression"
    d: "cp.Variable"


def largest_ellipsoid(halves: HalfSpaces, solver: str = SOLVER) -> Ellipsoid | None:
    """The inscribed ellipsoid of largest volume (Eq. 23).

    C is lower triangular with a positive diagonal, which loses nothing, since C and C U describe
    the same ellipsoid for any rotation U. Then det C is the product of the diagonal, Eq. 23 is a
    second-order cone program, and its parameters enter linearly, so that cvxpy compiles it once.

    Args:
        halves: a bounded polytope.
        solver: a solver of second-order cone programs that cvxpy knows.

    Returns:
        The ellipsoid, drawn in where the solver's tolerance let it stick out; None where there is
        no room for one.
    """
    import cvxpy as cp

    count = 8 * -(-len(halves.b) // 8)  # programs of a few sizes serve all polytopes
    program = _program(count)
    program.A.value = np.zeros((count, 3))
    program.b.value = np.ones(count)  # 0 x <= 1 fills up
    program.A.value[: len(halves.b)] = halves.A
    program.b.value[: len(halves.b)] = halves.b
    try:
        with warnings.catch_warnings():  # an inaccurate solution is drawn in like any other
            warnings.simplefilter("ignore", UserWarning)
            # A warm start would let a region depend on those grown before it.
            program.problem.solve(solver=solver, warm_start=False)
    except cp.SolverError:
        return None
    if program.d.value is None:
        return None
    C, d = np.asarray(program.C.value, np.float64), np.asarray(program.d.value, np.float64)
    if not (np.isfinite(C).all() and np.isfinite(d).all()):
        return None
    reach, room = np.linalg.norm(halves.A @ C, axis=1), halves.b - halves.A @ d
    if reach.min() <= 0 or room.min() <= 0:
        return None
    return Ellipsoid(min(1.0, (room / reach).min()) * C, d)


@functools.cache
def require_solver(name: str) -> None:
    """Refuse a solver that is not installed, has no licence, or solves no cone programs."""
    require_known("solver", name, solvers())
    cube = HalfSpaces.box(np.full(3, -1.0), np.full(3, 1.0))
    try:
        found = largest_ellipsoid(cube, name)
    except Exception as error:  # each solver fails in its own way
        raise InputError(f"solver = {name!r} cannot be used ({error}); choose another") from error
    wrong = f"solver = {name!r} does not solve Eq. 23; choose a cone solver such as {SOLVER}"
    require(found is not None, wrong)


@functools.cache
def _program(count: int) -> _Program:
    import cvxpy as cp

    A, b = cp.Parameter((count, 3)), cp.Parameter(count)
    entries, d = cp.Variable(6), cp.Variable(3)
    C = cp.reshape(_LOWER @ entries, (3, 3), order="F")
    inside = cp.SOC(b - A @ d, (A @ C).T)  # ‖Cᵀ a_i‖ + a_i·d <= b_i for every row i
    return _Program(cp.Problem(cp.Maximize(cp.geo_mean(entries[:3])), [inside]), A, b, C, d)


_PLACES = ((0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1))
_LOWER = np.zeros((9, 6))  # entries → columns of C, one below the other; the diagonal comes first
for _entry, (_row, _column) in enumerate(_PLACES):
    _LOWER[3 * _column + _row, _entry] = 1
