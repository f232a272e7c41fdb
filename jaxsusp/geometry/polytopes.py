"""Convex polytopes on the host: hulls of points, with few faces, and what grows around them.

What stands for a mesh is one `Polytope`, the same in the fitness, in the free space, in a
certificate and in pictures. It holds all of the hull; where the hull has more than `FACES` faces it
is a little larger, cut by those of its planes that cut most.
"""

from itertools import product
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection

from jaxsusp._types import Float

FACES = 64
"""Most faces of what stands for a hull. A ball has a twentieth more volume then."""

THIN = 1e-4
"""Least extent of a body as a share of its largest: what is flat gets that thick."""

_EXACT = 1e-7  # share of the size; faces that stand out less are left away
_NEAR = np.cos(np.deg2rad(15))  # … of what is as good as another normal: 4 % of what it grows by
_SIGNS = np.array([*product((-1.0, 1.0), repeat=3)])


class Polytope(NamedTuple):
    """A convex body by its corners and its faces, {p : normals · p <= offsets} (m)."""

    corners: Float[np.ndarray, "corners xyz"]
    normals: Float[np.ndarray, "faces xyz"]
    offsets: Float[np.ndarray, "faces"]
    grown: Float[np.ndarray, "more xyz"]
    """Normals of its faces and, behind them, of those that a sum of it and an upright box has
    besides, but where another is near: moved out by what something reaches along each, planes with
    these normals hold the sum of both, and bevel its sharp edges."""

    def scaled(self, factor: float) -> "Polytope":
        """The same body larger or smaller about the origin."""
        return Polytope(factor * self.corners, self.normals, factor * self.offsets, self.grown)

    def support(self, normals: Float[np.ndarray, "rows xyz"]) -> Float[np.ndarray, "rows"]:
        """Greatest normal · point over the body (m)."""
        return (normals @ self.corners.T).max(axis=1)

    def placed(self, center: Any, yaw_deg: float) -> "Polytope":
        """The same body turned about the vertical axis, and then moved (m)."""
        cos, sin = np.cos(np.deg2rad(yaw_deg)), np.sin(np.deg2rad(yaw_deg))
        turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        normals = self.normals @ turn
        offsets = self.offsets + normals @ np.asarray(center, np.float64)
        return Polytope(self.corners @ turn + center, normals, offsets, self.grown @ turn)

    def larger(self, by: float) -> "Polytope":
        """The body with all its faces, those of `grown` among them, moved out (m)."""
        return self.within(self.support(self.grown) + by)

    def within(self, offsets: Float[np.ndarray, "more"]) -> "Polytope":
        """The body within planes with the normals of `grown` (m)."""
        found = _corners(self.grown, offsets, self.corners.mean(axis=0))
        return Polytope(found, self.grown, offsets, self.grown)

    @property
    def inertia(self) -> Float[np.ndarray, "xyz xyz"]:
        """Moments of inertia per mass about the centroid of a uniform body (m²)."""
        hull = ConvexHull(self.corners)
        corners = self.corners - self.corners[hull.vertices].mean(axis=0)
        sides = corners[hull.simplices]  # with the middle, tetrahedra that fill the body
        volumes = np.abs(np.linalg.det(sides)) / 6
        sums = sides.sum(axis=1)
        centroid = (volumes @ sums) / 4 / volumes.sum()
        second = np.einsum("t,tia,tib->ab", volumes, sides, sides)
        second += np.einsum("t,ta,tb->ab", volumes, sums, sums)
        second = second / 20 / volumes.sum() - np.outer(centroid, centroid)
        return np.trace(second) * np.eye(3) - second

    @property
    def volume(self) -> float:
        """Its volume (m³)."""
        return float(ConvexHull(self.corners).volume)


def hull_of(points: Float[np.ndarray, "points xyz"], faces: int = FACES) -> Polytope:
    """The convex hull of points, or a body around it with so many faces at most.

    Planes of the hull are taken in turn, beginning with the six sides of its bounding box, each
    time the one beyond which the body so far stands out most.

    Args:
        points: any (m); flat ones get a thickness of `THIN` times their extent.
        faces: greatest number of faces, seven or more.
    """
    size = float(np.ptp(points, axis=0).max()) or 1.0
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    unit = _thick((points - middle) / size)
    hull = ConvexHull(unit)
    candidates = np.unique(hull.equations[:, :3].round(12), axis=0)  # of faces, not of triangles
    candidates /= np.linalg.norm(candidates, axis=1, keepdims=True)
    unit = unit[hull.vertices]
    offsets = (candidates @ unit.T).max(axis=1)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    normals, limits = axes, (axes @ unit.T).max(axis=1)
    inside = unit.mean(axis=0)
    while True:
        corners = _corners(normals, limits, inside)
        beyond = (candidates @ corners.T).max(axis=1) - offsets
        worst = int(beyond.argmax())
        if beyond[worst] <= _EXACT or len(normals) >= faces:
            break
        normals = np.concatenate([normals, candidates[worst : worst + 1]])
        limits = np.append(limits, offsets[worst])
    needed = (np.abs(normals @ corners.T - limits[:, None]) <= 1e-9).sum(axis=1) >= 3
    normals, limits = normals[needed], limits[needed]
    limits = np.maximum(limits, (normals @ corners.T).max(axis=1))  # faces hold every corner
    grown = _grown_normals(corners, normals)
    return Polytope(middle + size * corners, normals, size * limits + normals @ middle, grown)


def _grown_normals(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
    grown = (corners[:, None] + 0.25 * _SIGNS).reshape(-1, 3)
    kept = [*normals]
    for normal in np.unique(ConvexHull(grown).equations[:, :3].round(9), axis=0):
        if (np.array(kept) @ normal).max() < _NEAR:
            kept.append(normal / np.linalg.norm(normal))
    return np.array(kept)


def _thick(points: np.ndarray) -> np.ndarray:
    """Points, doubled across the directions in which they have no extent."""
    values, directions = np.linalg.eigh(np.cov(points.T, bias=True) + 0.0)
    order = np.argsort(values)
    for i in order[:2]:
        along = directions[:, i]
        extent = np.ptp(points @ along)
        if extent < THIN:
            step = 0.5 * (THIN - extent) * along
            points = np.concatenate([points + step, points - step])
    return points


def _corners(normals: np.ndarray, limits: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Corners of a body within planes, each once."""
    found = HalfspaceIntersection(np.column_stack([normals, -limits]), inside).intersections
    return np.unique(found.round(12), axis=0)
