"""Convex bodies that know how far they reach in a direction, and how to become a MuJoCo geom.

A capsule against a box goes to a routine of MuJoCo that makes contacts and gives no distance in
general, so boxes are convex meshes of eight vertices here; mesh vertices are single precision,
which moves a face by up to 1e-7 m.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.verify.engine import mujoco

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
THIN = 1e-4  # m, least half-extent of a box: MuJoCo refuses flatter meshes


class BoxShape(NamedTuple):
    """An upright box turned about the vertical axis (m, rad)."""

    center: np.ndarray
    half: np.ndarray
    yaw: float

    def support(self, normals):
        """Greatest normal · point over the body (m)."""
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        x, y, z = normals.T
        own = np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)
        return normals @ self.center + np.abs(own) @ self.half

    def add(self, spec, name):
        """A convex mesh, see the module's documentation."""
        spec.add_mesh(name=name, uservert=(_CORNERS * self.half).ravel())
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=name,
            pos=self.center,
            quat=[np.cos(self.yaw / 2), 0, 0, np.sin(self.yaw / 2)],
        )


class HullShape(NamedTuple):
    """The convex hull of corners (m)."""

    corners: np.ndarray

    def support(self, normals):
        """Greatest normal · point over the body (m)."""
        return (normals @ self.corners.T).max(axis=1)

    def add(self, spec, name):
        """A convex mesh about the middle of its corners, where single precision is finest."""
        middle = self.corners.mean(axis=0)
        spec.add_mesh(name=name, uservert=(self.corners - middle).ravel())
        spec.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, pos=middle
        )


class CylinderShape(NamedTuple):
    """A vertical cylinder (m)."""

    center: np.ndarray
    radius: float
    half_height: float

    def support(self, normals):
        """Greatest normal · point over the body (m)."""
        level = np.hypot(normals[:, 0], normals[:, 1])
        return (
            normals @ self.center + self.radius * level + self.half_height * np.abs(normals[:, 2])
        )

    def add(self, spec, name):
        """A cylinder."""
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            pos=self.center,
            size=[self.radius, self.half_height, 0],
        )


class CapsuleShape(NamedTuple):
    """A segment with a radius (m); a sphere where its ends coincide."""

    start: np.ndarray
    stop: np.ndarray
    radius: float

    def support(self, normals):
        """Greatest normal · point over the body (m)."""
        return np.maximum(normals @ self.start, normals @ self.stop) + self.radius

    def add(self, spec, name):
        """A capsule, or a sphere."""
        if np.allclose(self.start, self.stop, rtol=0, atol=1e-9):
            kind = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "pos": self.start}
            spec.worldbody.add_geom(name=name, size=[self.radius, 0, 0], **kind)
            return
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*self.start, *self.stop],
            size=[self.radius, 0, 0],
        )


class GroundShape(NamedTuple):
    """All that is below a height (m)."""

    height: float

    def support(self, normals):
        """Greatest normal · point over the body (m); infinite but straight up."""
        level = np.hypot(normals[:, 0], normals[:, 1])
        up = (level <= 1e-12) & (normals[:, 2] > 0)
        return np.where(up, self.height * normals[:, 2], np.inf)

    def add(self, spec, name):
        """A plane."""
        spec.worldbody.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_PLANE, pos=[0, 0, self.height], size=[1, 1, 1]
        )


Shape = BoxShape | HullShape | CylinderShape | CapsuleShape
"""Convex bodies that know how far they reach in a direction, and how to become a geom."""


def named_shapes(obstacle: Any, name: str) -> Iterator[tuple[str, Shape]]:
    """The exact bodies of an obstacle with their names: one, or the pieces of a mesh."""
    if obstacle.kind == "mesh" and obstacle.shape != "box":
        bodies = obstacle.bodies
        for number, body in enumerate(bodies, start=1):
            corners = body.placed(obstacle.center, obstacle.yaw_deg).corners
            yield f"{name}, piece {number}" if len(bodies) > 1 else name, HullShape(corners)
    else:
        yield name, obstacle_shape(obstacle)


def obstacle_shape(obstacle: Any) -> Shape:
    """The exact body of an obstacle that is one; a mesh gives way to its bounding box."""
    center = np.asarray(obstacle.center, np.float64)
    match obstacle.kind:
        case "box" | "mesh":
            half = np.asarray(obstacle.size) / 2
            return BoxShape(center, np.maximum(half, THIN), np.deg2rad(obstacle.yaw_deg).item())
        case "cylinder":
            return CylinderShape(center, obstacle.radius, obstacle.height / 2)
        case "sphere":
            return CapsuleShape(center, center, obstacle.radius)
    raise ValueError(f"an obstacle of unknown kind {obstacle.kind!r}")


class Body(NamedTuple):
    """One body: an obstacle, the load, a segment with a radius, or a single point."""

    name: str
    first: int = 0  # points that span it, twice the same if it is one; 0: none
    second: int = 0
    radius: float = 0.0  # m
    half_height: float | None = None  # m, of the load
    obstacle: Shape | GroundShape | None = None
    load: HullShape | None = None  # about its point, of a load with faces

    @property
    def below(self) -> float:
        """How far the body goes below the lowest of its points (m)."""
        return self.radius if self.half_height is None else self.half_height

    def reach(self, normals: Float[np.ndarray, "rows xyz"]) -> Float[np.ndarray, "rows"]:
        """How far the body goes beyond its points in given directions (m)."""
        if self.obstacle is not None:
            return self.obstacle.support(normals)
        if self.load is not None:
            return self.load.support(normals)
        if self.half_height is None:
            return np.full(len(normals), self.radius)
        level = np.hypot(normals[:, 0], normals[:, 1])
        return self.radius * level + self.half_height * np.abs(normals[:, 2])
