"""A smooth curve along a way, clear by construction: Bézier pieces that stay in their regions.

A Bézier curve lies in the convex hull of its control points. One piece per region of the way, with
all its control points in that region, is therefore clear wherever the region is, between the
samples too (as in Marcucci et al. 2023, Motion planning around obstacles with convex optimization).
Pieces join with equal first and second derivatives. Of all such curves the one is taken that is
short and bends little: a quadratic programme.
"""

from collections.abc import Iterator
from functools import cache
from math import comb
from typing import Any, NamedTuple

import clarabel
import numpy as np
from scipy import sparse

from jaxsusp._types import Float
from jaxsusp.freespace.polyhedra import HalfSpaces, Point, Points
from jaxsusp.freespace.polylines import along
from jaxsusp.freespace.space import FreeSpace

solver: Any = clarabel  # a compiled module, whose stubs name nothing

DEGREE = 5

ROUNDING = 0.08
"""Share of a way's length over which its corners are rounded."""

WAYS = 4
"""Taut ways of a free space that are rounded."""

ROOMIER = (0.0, 0.01)
"""Shares of a way's length that its curve keeps from the faces of its regions, in turn."""

LEAST_STAY = 0.02
"""Share of a way that is counted as spent in a region at least."""

FINE = 400
"""Points at which it is looked up which regions hold a way."""

TOUCH = 1e-6
"""m beyond its faces that a region holds a way: taut ways go along them."""


def rounded_ways(space: FreeSpace, samples: int) -> Iterator[Float[np.ndarray, "samples 3"]]:
    """Rounded curves along the ways that a free space knows of its task, the tightest first."""
    for route in space.routes[:WAYS]:
        for share in ROOMIER:
            curve = rounded(space, route.polyline, samples, share * route.length)
            if curve is not None:
                yield curve


def rounded(
    space: FreeSpace, line: Points, samples: int, margin: float = 0.0
) -> Float[np.ndarray, "samples 3"] | None:
    """Points on the rounded curve along a way, evenly spaced in length (m).

    Args:
        space: the regions.
        line: a polyline through them (m).
        samples: number n of points, both ends included.
        margin: m that control points between start and goal keep from the faces of their regions.

    Returns:
        The points; None where the regions leave no room for such a curve.
    """
    stretches = _stretches(space, line)
    if not stretches:
        return None
    regions, stay = zip(*stretches, strict=True)
    pieces, size = len(regions), DEGREE + 1
    short, bend = _energy(1), _energy(2)
    cost = sparse.block_diag([short / t + ROUNDING**2 * bend / t**3 for t in stay], format="csc")
    ends = line[0], line[-1]
    equal, value = _joints(stay, ends)
    inside, limit = [], []
    for i, region in enumerate(regions):
        for j in range(size):
            fixed = (i, j) in ((0, 0), (pieces - 1, DEGREE))
            if not fixed:
                unit = sparse.csc_array(([1.0], ([0], [i * size + j])), (1, pieces * size))
                inside.append(sparse.kron(unit, region.A))
                limit.append(region.b - margin)
    each = sparse.eye_array(3)  # coordinate
    found = _least_square(
        sparse.kron(cost, each), (sparse.kron(equal, each), value.reshape(-1)),
        (sparse.vstack(inside), np.concatenate(limit)),
    )  # fmt: skip
    if found is None:
        return None
    control = found.reshape(pieces, size, 3)
    fine = np.concatenate([_curve(FINE // pieces + 2) @ piece for piece in control])
    return along(fine, np.linspace(0, 1, samples))


def _least_square(cost: Any, equal: tuple, atmost: tuple) -> np.ndarray | None:
    """The x of least ½ xᵀ cost x with rows that equal, and rows that are at most, given values."""
    (equal_rows, equal_values), (rows, values) = equal, atmost
    cones = [
        solver.ZeroConeT(len(equal_values)),
        solver.NonnegativeConeT(len(values)),
    ]
    settings = solver.DefaultSettings()
    settings.verbose = False
    solution = solver.DefaultSolver(
        sparse.triu(cost, format="csc"), np.zeros(cost.shape[0]),
        sparse.vstack([equal_rows, rows], format="csc"), np.append(equal_values, values),
        cones, settings,
    ).solve()  # fmt: skip
    fine = solution.status in (solver.SolverStatus.Solved, solver.SolverStatus.AlmostSolved)
    return np.array(solution.x) if fine else None


class _Stretch(NamedTuple):
    """A region and the share of a way that is spent in it."""

    region: HalfSpaces
    share: float


def _stretches(space: FreeSpace, line: Points) -> list[_Stretch]:
    """The fewest regions that hold a way, in order; where two overlap they share it evenly."""
    regions = [region.polytope for region in space.regions]
    points = along(line, np.linspace(0, 1, FINE))
    held = np.array([region.excess(points) <= TOUCH for region in regions])
    # Where a region that holds a point began to hold the way, and where it ends to.
    steps = np.arange(FINE)
    began = np.maximum.accumulate(np.where(held, 0, steps + 1), axis=1)
    until = np.minimum.accumulate(np.where(held, FINE, steps)[:, ::-1], axis=1)[:, ::-1]
    chosen, borders, at = [], [0.0], 0
    while at < FINE:
        best = int(until[:, at].argmax())
        if until[best, at] <= at:
            return []
        if chosen:
            borders.append((began[best, at] + at) / 2 / FINE)
        chosen.append(best)
        at = int(until[best, at])
    shares = np.maximum(np.diff([*borders, 1.0]), LEAST_STAY)
    return [
        _Stretch(regions[i], float(share))
        for i, share in zip(chosen, shares / shares.sum(), strict=True)
    ]


def _joints(stay, ends) -> tuple[Any, np.ndarray]:
    """Where the curve begins and ends, and that it joins smoothly: rows of a coordinate, values."""
    size, pieces = DEGREE + 1, len(stay)
    rows, values = [], []

    def row(entries: dict[int, float], value: Point | None = None) -> None:
        columns = list(entries)
        rows.append(
            sparse.csc_array(
                (list(entries.values()), ([0] * len(columns), columns)), (1, pieces * size)
            )
        )
        values.append(np.zeros(3) if value is None else value)

    row({0: 1.0}, ends[0])
    row({pieces * size - 1: 1.0}, ends[1])
    for i in range(pieces - 1):
        last, first = i * size + DEGREE, (i + 1) * size
        before, after = stay[i], stay[i + 1]
        row({last: 1.0, first: -1.0})
        row({last: 1 / before, last - 1: -1 / before, first + 1: -1 / after, first: 1 / after})
        two, other = 1 / before**2, 1 / after**2
        row({
            last: two, last - 1: -2 * two, last - 2: two,
            first: -other, first + 1: 2 * other, first + 2: -other,
        })  # fmt: skip
    return sparse.vstack(rows, format="csc"), np.array(values)


@cache
def _energy(order: int) -> Float[np.ndarray, "points points"]:
    """Matrix of ∫ |dʲp/duʲ|² over the unit interval in the control points of one coordinate."""
    degree = DEGREE - order
    factor = np.prod(np.arange(DEGREE, degree, -1)).astype(float)
    differences = factor * np.diff(np.eye(DEGREE + 1), order, axis=0)
    index = range(degree + 1)
    gram = np.array(
        [
            [comb(degree, i) * comb(degree, j) / comb(2 * degree, i + j) for j in index]
            for i in index
        ]
    ) / (2 * degree + 1)
    return differences.T @ gram @ differences


@cache
def _curve(points: int) -> Float[np.ndarray, "points control"]:
    """Bernstein polynomials at evenly spaced parameters."""
    u = np.linspace(0, 1, points)[:, None]
    k = np.arange(DEGREE + 1)
    binomials = np.array([comb(DEGREE, i) for i in k])
    return binomials * u**k * (1 - u) ** (DEGREE - k)
