"""Convex polyhedra in space: half-spaces {x : A x <= b}, their nearest point, hulls of points.

One exact primitive serves every question that is asked of them, the nearest point of Lawson and
Hanson's least-distance programming: it projects, decides whether polyhedra meet, and where they do
not it returns multipliers that prove it.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls
from scipy.spatial import ConvexHull, HalfspaceIntersection

Point = Float[np.ndarray, "3"]
Points = Float[np.ndarray, "_ 3"]


class HalfSpaces(NamedTuple):
    """The polyhedron {x : A x <= b}; rows of A have unit length (m)."""

    A: Float[np.ndarray, "faces 3"]
    b: Float[np.ndarray, " faces"]

    @classmethod
    def box(cls, lower: Point, upper: Point) -> "HalfSpaces":
        """All points between two corners."""
        return cls(np.concatenate([np.eye(3), -np.eye(3)]), np.concatenate([upper, -lower]))

    def __and__(self, other: "HalfSpaces") -> "HalfSpaces":
        """The intersection."""
        return HalfSpaces(np.concatenate([self.A, other.A]), np.concatenate([self.b, other.b]))

    def excess(self, points: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch"]:
        """How far points lie beyond the face they violate most (m); negative inside."""
        return np.asarray((points @ self.A.T - self.b).max(axis=-1))


class Nearest(NamedTuple):
    """The outcome of a search for a nearest point."""

    point: Point | None  # None: the polyhedron is empty …
    multipliers: Float[np.ndarray, " faces"]  # … as these prove: Aᵀu = 0, b·u < 0, u >= 0


def nearest_point(halves: HalfSpaces, to: Point, scale: float = 1.0) -> Nearest:
    """The point of a polyhedron next to a given one, by least-distance programming.

    min ‖x - to‖ subject to A x <= b is a non-negative least squares problem with four rows
    (Lawson & Hanson, Solving Least Squares Problems, 1974, ch. 23).

    Args:
        halves: the polyhedron.
        to: the point to be near to (m).
        scale: a length (m) of about the distance that is expected, for the numbers' sake.
    """
    rows = np.vstack([halves.A.T, (halves.b - halves.A @ to) / scale])
    multipliers, _ = nnls(-rows, _LAST, maxiter=10 * rows.shape[1] + 100)
    residual = -rows @ multipliers - _LAST
    # Where next to nothing is left of many pulls, they balance: the proof that there is no point.
    balanced = np.abs(residual[:3]).max() <= _BALANCE * multipliers.sum()
    if residual[3] > -_EMPTY or (balanced and multipliers.any()):
        return Nearest(None, multipliers)
    return Nearest(to - scale * residual[:3] / residual[3], multipliers)


_LAST = np.array([0.0, 0.0, 0.0, 1.0])
_BALANCE = 1e-12
_EMPTY = 1e-13
"""-residual[3] is 1 / (1 + (distance / scale)²); below this no point is there."""


class Body(NamedTuple):
    """A convex body by its corners and by its faces (m)."""

    name: str
    corners: Points
    faces: HalfSpaces

    @classmethod
    def hull(cls, name: str, points: Points) -> "Body":
        """The convex hull of points that do not all lie in one plane."""
        hull = ConvexHull(points)
        equations = np.unique(hull.equations.round(12), axis=0)  # one per face, not per triangle
        normals, offsets = equations[:, :3], -equations[:, 3]
        # Faces are moved out to the last corner: what they bound holds all of the body.
        offsets = np.maximum(offsets, (points @ normals.T).max(axis=0))
        return cls(name, points[hull.vertices], HalfSpaces(normals, offsets))


def cut(body: Body, plane: HalfSpaces) -> Body:
    """The part of a body on one side of a plane that goes through it."""
    faces = body.faces & plane
    middle = nearest_point(HalfSpaces(faces.A, faces.b - _INSIDE), body.corners.mean(axis=0)).point
    assert middle is not None, f"nothing of {body.name} is left"
    return Body(body.name, corners_of(faces, middle), faces)


_INSIDE = 1e-5  # m from every face


def corners_of(halves: HalfSpaces, inside: Point) -> Points:
    """Corners of a bounded polyhedron with an interior point."""
    return HalfspaceIntersection(_qhull(halves), inside).intersections


def irredundant(halves: HalfSpaces, inside: Point) -> HalfSpaces:
    """The same polyhedron without the half-spaces that add nothing."""
    needed = np.sort(HalfspaceIntersection(_qhull(halves), inside).dual_vertices)
    return HalfSpaces(halves.A[needed], halves.b[needed])


def volume(halves: HalfSpaces, inside: Point) -> float:
    """Volume (m³) of a bounded polyhedron with an interior point."""
    return float(ConvexHull(corners_of(halves, inside)).volume)


def _qhull(halves: HalfSpaces) -> np.ndarray:
    return np.column_stack([halves.A, -halves.b])
