"""Obstacles as convex bodies that can be drawn, and a parallel camera that looks at them.

Matplotlib's own 3-D axes sort whole artists by depth and draw lines behind all bodies, so a curve
that winds between obstacles comes out wrong. Here every body is convex, which makes "what hides
what" a short exact computation.
"""

import functools
from collections.abc import Iterable
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from jaxsusp.geometry.polytopes import Polytope

Point = Float[np.ndarray, "xyz"]
Points = Float[np.ndarray, "*batch xyz"]


class Solid(NamedTuple):
    """A convex body {p : normals · p <= offsets} and its faces, corner by corner (m)."""

    faces: tuple[Float[np.ndarray, "_ xyz"], ...]
    normals: Float[np.ndarray, "faces xyz"]
    offsets: Float[np.ndarray, " faces"]
    smooth: bool  # the faces stand for a curved surface: draw no edges between them

    @classmethod
    def of_faces(cls, faces: list, smooth: bool = False) -> "Solid":
        """A body from planar faces, each with its corners in order, seen from anywhere."""
        faces = [np.asarray(face, np.float64) for face in faces]
        inside = np.mean([face.mean(axis=0) for face in faces], axis=0)
        corner, after, before = (np.array([face[i] for face in faces]) for i in (0, 1, -1))
        normals = np.cross(after - corner, before - corner)
        sizes = np.linalg.norm(normals, axis=1, keepdims=True)
        normals /= np.where(sizes == 0, 1, sizes)
        outwards = np.einsum("fi,fi->f", normals, corner - inside)
        normals *= np.where(outwards < 0, -1.0, 1.0)[:, None]
        return cls(tuple(faces), normals, np.einsum("fi,fi->f", normals, corner), smooth)

    @property
    def corners(self) -> Float[np.ndarray, "corners xyz"]:
        """All corners of all faces."""
        return np.concatenate(self.faces)

    def hides(self, points: Points, towards: Point) -> Bool[np.ndarray, "*batch"]:
        """Which points have this body between themselves and a viewer in direction `towards`.

        The ray p + s·towards, s > 0, is clipped by all face planes at once. A point on the side
        of the body that faces the viewer is not hidden; a point inside is.
        """
        slope = self.normals @ towards
        gap = self.offsets - points @ self.normals.T  # negative: outside that plane
        s = gap / np.where(np.abs(slope) < 1e-12, np.nan, slope)
        enter = np.max(np.where(slope < -1e-12, s, 0.0), axis=-1)
        leave = np.min(np.where(slope > 1e-12, s, np.inf), axis=-1)
        beside = ((np.abs(slope) < 1e-12) & (gap < 0)).any(axis=-1)
        touch = 1e-9 + 4 * np.spacing(np.abs(self.offsets).max())  # what rounding far away adds
        return (leave > enter + touch) & ~beside


class Camera(NamedTuple):
    """A parallel projection: azimuth and elevation of the viewer (rad)."""

    azimuth: float
    elevation: float

    @classmethod
    def above(cls) -> "Camera":
        """The top view: x to the right, y up."""
        return cls(-np.pi / 2, np.pi / 2)

    @property
    def towards(self) -> Point:
        """Unit vector from the scene to the viewer."""
        level = np.cos(self.elevation)
        return np.array(
            [level * np.cos(self.azimuth), level * np.sin(self.azimuth), np.sin(self.elevation)]
        )

    @property
    def frame(self) -> Float[np.ndarray, "picture=2 xyz"]:
        """Unit vectors to the right and up in the picture."""
        return _frame_of(self)

    def project(self, points: Points) -> Float[np.ndarray, "*batch picture=2"]:
        """World → picture (m, true to scale across the viewing direction)."""
        return points @ self.frame.T

    def spread(self, points: Points) -> Float[np.ndarray, "ends=2 picture=2"]:
        """Corners of what points take of the picture (m)."""
        flat = self.project(points).reshape(-1, 2)
        return np.stack([flat.min(axis=0), flat.max(axis=0)])

    @staticmethod
    def overlap(
        one: Float[np.ndarray, "ends=2 picture=2"], other: Float[np.ndarray, "ends=2 picture=2"]
    ) -> bool:
        """Whether two bodies can hide parts of each other: rounding far away does not part them."""
        touch = 1e-9 * (1 + np.abs(one).max())
        return bool((one[0] <= other[1] + touch).all() and (other[0] <= one[1] + touch).all())

    def back_to_front(self, solids: list[Solid]) -> list[int]:
        """Indices of the bodies in the order in which to paint them."""
        depth = [solid.corners.mean(axis=0) @ self.towards for solid in solids]
        order = TopologicalSorter({i: set() for i in np.argsort(depth).tolist()})
        surfaces = list(map(_surface, solids))
        spreads = [self.spread(solid.corners) for solid in solids]
        for i, back in enumerate(solids):
            for j, front in enumerate(solids):
                if i == j or not self.overlap(spreads[i], spreads[j]):
                    continue
                # The second is for small bodies, which cover none of the points of a large one.
                if (
                    front.hides(surfaces[i], self.towards).any()
                    or back.hides(surfaces[j], -self.towards).any()
                ):
                    order.add(j, i)
        try:
            return list(order.static_order())
        except CycleError:  # bodies that run into each other have no order
            return np.argsort(depth).tolist()


@functools.lru_cache(maxsize=64)
def _frame_of(camera: Camera) -> np.ndarray:
    right = np.array([-np.sin(camera.azimuth), np.cos(camera.azimuth), 0.0])
    frame = np.stack([right, np.cross(camera.towards, right)])
    frame.setflags(write=False)  # shared by all that look the same way
    return frame


def of_obstacles(obstacles: Iterable[Any]) -> list[Solid]:
    """The bodies of obstacles, one after the other; a mesh is drawn as what stands for it."""
    return [solid for obstacle in obstacles for solid in solids_of(obstacle)]


def solids_of(obstacle: Any) -> list[Solid]:
    """The bodies of one obstacle: one, or the pieces of a mesh."""
    if obstacle.kind == "mesh" and obstacle.shape != "box":
        placed = (body.placed(obstacle.center, obstacle.yaw_deg) for body in obstacle.bodies)
        return [of_polytope(body) for body in placed]
    return [of_obstacle(obstacle)]


def of_load(payload: Any, place: Any, turn: Any = None) -> Solid:
    """The load with its centre at a place, level or turned about it by a rotation (3, 3)."""
    body = payload.body
    if body is None:
        return cylinder(place, payload.radius, payload.height, turn)
    turn = np.eye(3) if turn is None else np.asarray(turn, np.float64)
    normals, place = body.normals @ turn.T, np.asarray(place, np.float64)
    return of_polytope(
        body._replace(
            corners=body.corners @ turn.T + place,
            normals=normals,
            offsets=body.offsets + normals @ place,
        )
    )


def of_polytope(body: Polytope) -> Solid:
    """A convex body, its faces with their corners in order."""
    size, faces = np.ptp(body.corners, axis=0).max(), []
    for normal, offset in zip(body.normals, body.offsets, strict=True):
        on = body.corners[body.corners @ normal > offset - 1e-7 * size]
        one = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        across = on - on.mean(axis=0)
        turn = np.argsort(np.arctan2(across @ np.cross(normal, one), across @ one))
        if len(on) >= 3:
            faces.append(on[turn])
    return Solid.of_faces(faces)


def of_obstacle(obstacle: Any) -> Solid:
    """The body of one obstacle of a scenario that is one; a mesh as its bounding box.

    Raises:
        ValueError: an unknown kind of obstacle.
    """
    match obstacle.kind:
        case "box" | "mesh":
            return box(obstacle.center, obstacle.size, obstacle.yaw_deg)
        case "cylinder":
            return cylinder(obstacle.center, obstacle.radius, obstacle.height)
        case "sphere":
            return sphere(obstacle.center, obstacle.radius)
    raise ValueError(f"cannot draw an obstacle of kind {obstacle.kind!r}")


def box(center, size, yaw_deg: float = 0.0) -> Solid:
    """A box of full size (m), turned about the vertical axis; a flat one gets a millimetre."""
    half, yaw = np.maximum(size, 1e-3) / 2, np.deg2rad(yaw_deg)
    ring = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half[:2]
    turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    return _prism(center, ring @ turn, half[2], smooth=False)


def cylinder(center, radius: float, height: float, turn=None, sides: int = 48) -> Solid:
    """A cylinder of full height (m), upright or turned about its centre by a rotation (3, 3)."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return _prism(center, ring, height / 2, smooth=True, turn=turn)


def sphere(center, radius: float, sides: int = 36) -> Solid:
    """A sphere (m) as bands of flat faces and a cap at each pole."""
    azimuth = 2 * np.pi * np.arange(sides) / sides
    polar = np.pi * np.arange(1, sides // 2) / (sides // 2)
    unit = np.stack(
        [
            np.outer(np.sin(polar), np.cos(azimuth)),
            np.outer(np.sin(polar), np.sin(azimuth)),
            np.outer(np.cos(polar), np.ones(sides)),
        ],
        axis=-1,
    )
    rings = np.asarray(center) + radius * unit
    faces = [rings[0], rings[-1]]
    for upper, lower in pairwise(rings):
        for i, j in enumerate(_next(sides)):
            faces.append([upper[i], lower[i], lower[j], upper[j]])
    return Solid.of_faces(faces, smooth=True)


def _prism(center, ring, half_height: float, smooth: bool, turn=None) -> Solid:
    """A prism over a ring of (x, y) corners about its centre, upright or turned about that."""
    turn = np.eye(3) if turn is None else np.asarray(turn, np.float64)
    low, high = (
        np.asarray(center, np.float64) + np.column_stack([ring, np.full(len(ring), z)]) @ turn.T
        for z in (-half_height, half_height)
    )
    walls = [[low[i], low[j], high[j], high[i]] for i, j in enumerate(_next(len(ring)))]
    return Solid.of_faces([*walls, low, high], smooth)


def _next(count: int) -> list[int]:
    """Index of the next corner of a ring, for every corner."""
    return [*range(1, count), 0]


def _surface(solid: Solid) -> Float[np.ndarray, "points xyz"]:
    """Points just inside the surface: corners, edge middles and face centres."""
    middles = [(face + np.roll(face, 1, axis=0)) / 2 for face in solid.faces]
    centres = [face.mean(axis=0, keepdims=True) for face in solid.faces]
    points = np.concatenate([solid.corners, *middles, *centres])
    return points + 1e-3 * (points.mean(axis=0) - points)
