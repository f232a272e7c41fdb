"""Samples of a curve moved a little, so that the smooth path through them bends least.

A natural quintic spline is the curve of least ∫ |p'''|² du through its points. Letting every point
move within some room and minimising the same integral over where they go therefore gives the
calmest curve of all that pass through these rooms, and it is again a natural quintic spline through
its points: a `SmoothPath`. Along a path driven at even speed p''' is the jerk, which peaks where
Makima's pieces meet and has no reason to.
"""

from typing import Any, NamedTuple

import clarabel
import numpy as np
import scipy.sparse as sp

from jaxsusp._types import Float, Int
from jaxsusp.trajectory.smoothpath import SmoothPath, natural_quintic

solver: Any = clarabel  # a compiled module, whose stubs name nothing

_PROXIMAL = 1e-9
"""Share of the energy's scale with which a point is drawn to where it is: of curves that bend
equally little (along a straight line there are many) the nearest is taken."""


class Planes(NamedTuple):
    """Where points may not go: n · shift of the point >= least, one row per half-space."""

    point: Int[np.ndarray, "rows"]
    normal: Float[np.ndarray, "rows xyz"]
    least: Float[np.ndarray, "rows"]  # m; at most zero, the point may stay


NOWHERE = Planes(np.zeros(0, int), np.zeros((0, 3)), np.zeros(0))


def smoothed(
    points: Float[np.ndarray, "samples xyz"], radius: float, planes: Planes = NOWHERE
) -> Float[np.ndarray, "samples xyz"]:
    """Points through which the smooth path bends least, near given ones; the ends stay.

    Args:
        points: positions (m), in order. Those that coincide move together.
        radius: how far a point may move along every axis (m).
        planes: half-spaces in which points stay besides.

    Returns:
        The moved points; the given ones where there is nothing to gain.
    """
    u, distinct = SmoothPath(points).marks
    if len(distinct) < 4 or radius <= 0:
        return points
    group = np.searchsorted(u[distinct], u, side="right") - 1  # which distinct point each one is
    inner = slice(1, len(distinct) - 1)
    energy = third_derivative_energy(u[distinct])
    shift = np.zeros((len(distinct), 3))
    shift[inner] = _least_energy(
        energy[inner, inner], energy[inner] @ points[distinct], radius, planes, group - 1
    )
    return points + shift[group]


def third_derivative_energy(u: Float[np.ndarray, "knots"]) -> Float[np.ndarray, "knots knots"]:
    """Matrix K with vᵀ K v = ∫ s'''(u)² du of the natural quintic spline through values v."""
    third = natural_quintic(u, np.eye(len(u))).derivative(3)
    nodes, weights = np.polynomial.legendre.leggauss(3)  # exact: s''' is quadratic on a span
    middle, half = (u[1:] + u[:-1]) / 2, np.diff(u) / 2
    rows = third((middle[:, None] + half[:, None] * nodes).ravel())
    return rows.T @ ((half[:, None] * weights).ravel()[:, None] * rows)


def _least_energy(energy, slope, radius: float, planes: Planes, of: np.ndarray) -> np.ndarray:
    """Shifts (inner points, xyz) of least energy within their room.

    Entries of the energy differ by ten orders where samples crowd; every shift is counted in what
    makes its own entry one.
    """
    count, scale = len(energy), 1 / np.sqrt(np.diag(energy))
    matrix = energy * scale * scale[:, None] + _PROXIMAL * np.eye(count)
    quadratic = sp.block_diag([sp.csc_matrix(np.triu(matrix))] * 3, format="csc")
    linear = (scale[:, None] * slope).T.ravel()
    inside = (of[planes.point] >= 0) & (of[planes.point] < count)
    point, normal = of[planes.point][inside], planes.normal[inside]
    rows = np.repeat(np.arange(len(point)), 3)
    columns = (point[:, None] + count * np.arange(3)).ravel()
    values = (-normal * scale[point][:, None]).ravel()
    faces = sp.csc_matrix((values, (rows, columns)), shape=(len(point), 3 * count))
    box = sp.identity(3 * count, format="csc")
    room = np.tile(radius / scale, 3)
    low = np.minimum(planes.least[inside], 0.0)
    settings = solver.DefaultSettings()
    settings.verbose = False
    found = solver.DefaultSolver(
        quadratic, linear, sp.vstack([box, -box, faces], format="csc"),
        np.concatenate([room, room, -low]),
        [solver.NonnegativeConeT(6 * count + len(point))], settings,
    ).solve()  # fmt: skip
    if str(found.status) not in ("Solved", "AlmostSolved"):
        return np.zeros((count, 3))
    return np.array(found.x).reshape(3, count).T * scale[:, None]
