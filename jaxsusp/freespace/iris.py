"""IRIS: grow a convex region between convex bodies (Deits & Tedrake 2015; Eq. 23).

Alternates (i) planes that separate the bodies from the current ellipsoid, nearest body first in
the ellipsoid's own metric, and (ii) the largest ellipsoid inside the polytope of these planes.
Orders, drops and stops as Drake's `Iris` does, so that regions can be compared.

No tolerance of a solver can let a body into a region: every plane is moved back to the nearest
corner of its body, and a body that gets no plane of its own is left out only on proof.
"""

import heapq
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from jaxsusp.errors import InputError
from jaxsusp.freespace.ellipsoid import SOLVER, Ellipsoid, largest_ellipsoid
from jaxsusp.freespace.polyhedra import Body, HalfSpaces, Point, Points, nearest_point

FIRST_RADIUS = 0.01
"""Radius (m) of the ball about the seed that the search begins with."""

LEAST_GROWTH, LEAST_RELATIVE_GROWTH = 0.02, 1e-3
"""Growth of the ellipsoid's volume per iteration, in m³ and relative, that is still worth one."""

GAP = 1e-9
"""m between a separating plane and the body it keeps out."""

MANY = 400
"""Bodies up to which each is looked at for every plane and every ellipsoid; of more, those that
are far away are told by balls around them."""


class Region(NamedTuple):
    """A polytope that meets no body, and the largest ellipsoid in it."""

    polytope: HalfSpaces
    ellipsoid: Ellipsoid


class Bodies:
    """Convex bodies, their corners in one array so that a plane is tested against all at once."""

    def __init__(self, bodies: Sequence[Body]):
        self.bodies = tuple(bodies)
        self.corners: Points = np.concatenate([np.empty((0, 3)), *(b.corners for b in bodies)])
        counts = [len(body.corners) for body in bodies]
        self._first = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(int) if counts else []
        self._stop = np.cumsum(counts, dtype=int)
        self.many = len(self.bodies) > MANY
        if self.many:  # balls around them
            pairs = [(b.corners.min(axis=0), b.corners.max(axis=0)) for b in self.bodies]
            self._middle = np.array([(low + high) / 2 for low, high in pairs])
            self._radius = np.array(
                [
                    np.linalg.norm(b.corners - middle, axis=1).max() + GAP
                    for b, middle in zip(self.bodies, self._middle, strict=True)
                ]
            )

    def __len__(self) -> int:
        return len(self.bodies)

    def least(self, values: Float[np.ndarray, " corners"]) -> Float[np.ndarray, " bodies"]:
        """The least of one value per corner, per body."""
        return np.minimum.reduceat(values, self._first) if len(self) else np.empty(0)

    def beyond(
        self, normal: Point, offset: float, known: Bool[np.ndarray, " bodies"] | None = None
    ) -> Bool[np.ndarray, " bodies"]:
        """Which bodies lie wholly beyond the plane normal · x = offset, or are known to do so.

        Where they are many, balls around them decide for most.
        """
        known = np.zeros(len(self), bool) if known is None else known
        if not self.many:
            return known | (self.least(self.corners @ normal) > offset)
        height = self._middle @ normal
        found = known | (height - self._radius > offset)
        open_ = np.flatnonzero(~found & (height + self._radius > offset))
        if len(open_):
            first, count = self._first[open_], self._stop[open_] - self._first[open_]
            begin = np.cumsum(count) - count
            rows = np.arange(count.sum()) + np.repeat(first - begin, count)
            found[open_] = np.minimum.reduceat(self.corners[rows] @ normal, begin) > offset
        return found

    def bounds(self, center: Point, to_ball: np.ndarray) -> Float[np.ndarray, " bodies"]:
        """Lower bounds on the distances from a place in a metric, by balls around the bodies."""
        stretch = float(np.linalg.norm(to_ball, 2))
        away = np.linalg.norm((self._middle - center) @ to_ball.T, axis=1)
        return np.maximum(away - stretch * self._radius, 0)

    def around(self, point: Point) -> Sequence[Body]:
        """Those that may hold a point."""
        if not self.many:
            return self.bodies
        near = ((self._middle - point) ** 2).sum(axis=1) <= (self._radius + GAP) ** 2
        return [self.bodies[i] for i in np.flatnonzero(near)]

    def holding(self, points: Float[np.ndarray, "*batch 3"]) -> Bool[np.ndarray, "*batch"]:
        """Which points lie in any body."""
        inside = np.zeros(points.shape[:-1], bool)
        for body in self.bodies:
            lower, upper = body.corners.min(axis=0), body.corners.max(axis=0)
            near = ~inside & (points >= lower).all(axis=-1) & (points <= upper).all(axis=-1)
            inside[near] = body.faces.excess(points[near]) <= GAP
        return inside


def iris(
    bodies: Bodies,
    domain: HalfSpaces,
    seed: Point,
    keep_seed: bool = True,
    solver: str = SOLVER,
    limit: int = 100,
) -> Region | None:
    """Grow a region about a seed.

    Args:
        bodies: what to stay clear of.
        domain: a bounded polytope that the region lies in.
        seed: a point of the domain outside all bodies (m).
        keep_seed: stop before the region loses its seed.
        solver: of the cone programs of Eq. 23.
        limit: greatest number of iterations.

    Returns:
        The region; None where the room about the seed is too tight for an ellipsoid.

    Raises:
        InputError: the seed is in a body, touches one, or is outside the domain.
    """
    seed = np.asarray(seed, np.float64)
    _require_free(bodies, domain, seed)
    ellipsoid, region = Ellipsoid.ball(seed, FIRST_RADIUS), None
    for _ in range(limit):
        polytope = separate(bodies, domain, ellipsoid)
        if keep_seed and polytope.excess(seed) > GAP:
            break
        found = largest_ellipsoid(polytope, solver)
        if found is None:
            break
        growth, ellipsoid = found.volume - ellipsoid.volume, found
        region = Region(polytope, ellipsoid)
        before = ellipsoid.volume - growth
        if growth <= LEAST_GROWTH or growth <= LEAST_RELATIVE_GROWTH * before:
            break
    return region


def separate(bodies: Bodies, domain: HalfSpaces, ellipsoid: Ellipsoid) -> HalfSpaces:
    """The part of the domain on the ellipsoid's side of planes that keep out every body.

    Nearest body first; a body gets a plane only if the polytope so far still meets it. Distances
    are taken lazily: a body waits in the queue with a lower bound until it is its turn.
    """
    to_ball = np.linalg.inv(ellipsoid.C)  # x → u of Eq. 23, in which the ellipsoid is a ball
    polytope = domain
    cleared = np.zeros(len(bodies), bool)
    for normal, offset in zip(domain.A, domain.b, strict=True):
        cleared = bodies.beyond(normal, offset, cleared)
    if bodies.many:
        bounds, rough = bodies.bounds(ellipsoid.d, to_ball), ~cleared
    else:
        bounds = _least_distances(bodies, (bodies.corners - ellipsoid.d) @ to_ball.T)
        rough = np.zeros(len(bodies), bool)
    queue: list[tuple[float, int, Point | None]] = [
        (bound, i, None) for i, bound in enumerate(bounds.tolist())
    ]
    heapq.heapify(queue)
    while queue:
        bound, i, tangent = heapq.heappop(queue)
        if cleared[i]:
            continue
        if rough[i]:  # a closer bound for this one
            closer = _least_distance((bodies.bodies[i].corners - ellipsoid.d) @ to_ball.T)
            heapq.heappush(queue, (max(bound, closer), i, None))
            rough[i] = False
        elif tangent is None:
            distance, tangent = _tangent(bodies.bodies[i], ellipsoid, to_ball, bound)
            heapq.heappush(queue, (distance, i, tangent))
        elif not proved_apart(polytope, bodies.bodies[i]):
            offset = (bodies.bodies[i].corners @ tangent).min() - GAP
            polytope &= HalfSpaces(tangent[None], np.array([offset]))
            cleared = bodies.beyond(tangent, offset, cleared)
    return polytope


def proved_apart(polytope: HalfSpaces, body: Body) -> bool:
    """Whether a plane, some non-negative combination of the polytope's, has the body beyond it."""
    if ((body.corners @ polytope.A.T).min(axis=0) > polytope.b).any():
        return True
    found = nearest_point(polytope & body.faces, body.corners[0])
    if found.point is not None:
        return False
    weights = found.multipliers[: len(polytope.b)]
    return bool((body.corners @ (weights @ polytope.A)).min() > weights @ polytope.b)


def _least_distances(bodies: Bodies, corners: Points) -> Float[np.ndarray, " bodies"]:
    """Lower bounds on the distance of every body from the origin.

    That of a plane square to the line to the body's nearest corner, and in front of the body.
    """
    if not len(bodies):
        return np.empty(0)
    squares = (corners**2).sum(axis=1)
    counts = [len(body.corners) for body in bodies.bodies]
    owner = np.repeat(np.arange(len(bodies)), counts)
    nearest = np.flatnonzero(squares == bodies.least(squares)[owner])
    line = np.empty((len(bodies), 3))
    line[owner[nearest]] = corners[nearest] / np.sqrt(squares[nearest, None])
    return np.maximum(bodies.least((corners * line[owner]).sum(axis=1)), 0)


def _least_distance(corners: Points) -> float:
    """The same of one body."""
    squares = (corners**2).sum(axis=1)
    nearest = corners[squares.argmin()]
    length = math.sqrt(nearest @ nearest)
    return max(float((corners @ nearest).min()) / length, 0.0) if length > 0 else 0.0


def _tangent(
    body: Body, ellipsoid: Ellipsoid, to_ball: np.ndarray, bound: float
) -> tuple[float, Point]:
    """Distance of a body in the ellipsoid's metric, and the plane's normal at its nearest point."""
    faces = body.faces.A @ ellipsoid.C
    lengths = np.linalg.norm(faces, axis=1)
    room = body.faces.b - body.faces.A @ ellipsoid.d
    halves = HalfSpaces(faces / lengths[:, None], room / lengths)
    nearest = nearest_point(halves, np.zeros(3), scale=max(bound, 1.0)).point
    assert nearest is not None, f"{body.name} is empty"
    normal = to_ball.T @ nearest
    return float(np.linalg.norm(nearest)), normal / np.linalg.norm(normal)


def _require_free(bodies: Bodies, domain: HalfSpaces, seed: Point) -> None:
    """Refuse a seed that is in a body or outside the domain."""
    given = f"seed = {seed.round(6).tolist()}"
    if not np.isfinite(seed).all() or domain.excess(seed) > GAP:
        raise InputError(f"{given} is outside the domain; choose a seed inside")
    for body in bodies.around(seed):
        if body.faces.excess(seed) <= GAP:
            raise InputError(f"{given} is in {body.name}; choose a seed in the free space")
