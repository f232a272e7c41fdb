"""The bodies of a plan and their exact distances: MuJoCo measures, closed forms support.

`mj_geomDistance` (general convex algorithm, `ccd_tolerance` 1e-12) gives the distance of two
bodies and the nearest points. Two things to know about it: a capsule against a box goes to a
routine that makes contacts and gives no distance in general, so boxes are convex meshes of eight
vertices here; and mesh vertices are single precision, which moves a face by up to 1e-7 m.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from jaxsusp.geometry.meshes import bounding_box
from jaxsusp.verify.engine import mujoco

if TYPE_CHECKING:
    from jaxsusp.verify.company import Body

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_FAR = 1e3  # m, beyond every distance asked for
_THIN = 1e-4  # m, least half-extent of a box: MuJoCo refuses flatter meshes


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


Shape = BoxShape | CylinderShape | CapsuleShape
"""Convex bodies that know how far they reach in a direction, and how to become a geom."""


def obstacle_shape(obstacle: Any) -> Shape:
    """The exact body of an obstacle; a mesh gives way to its bounding box (spec §5)."""
    center = np.asarray(obstacle.center, np.float64)
    match obstacle.kind:
        case "box":
            half = np.asarray(obstacle.size) / 2
            return BoxShape(center, np.maximum(half, _THIN), np.deg2rad(obstacle.yaw_deg).item())
        case "mesh":
            half = bounding_box(obstacle.path, obstacle.scale) / 2
            return BoxShape(center, np.maximum(half, _THIN), np.deg2rad(obstacle.yaw_deg).item())
        case "cylinder":
            return CylinderShape(center, obstacle.radius, obstacle.height / 2)
        case "sphere":
            return CapsuleShape(center, center, obstacle.radius)
    raise ValueError(f"an obstacle of unknown kind {obstacle.kind!r}")


class Scene:
    """Bodies in one MuJoCo model that is never stepped: placed, and measured pair by pair.

    Args:
        bodies: obstacles stand where they are, all others are placed.
    """

    def __init__(self, bodies: "Sequence[Body]"):
        spec = mujoco.MjSpec()
        spec.option.ccd_tolerance = 1e-12
        spec.option.ccd_iterations = 500
        kinds = mujoco.mjtGeom
        for index, body in enumerate(bodies):
            name, radius = f"{index}", max(body.radius, _THIN)
            if body.obstacle is not None:
                body.obstacle.add(spec, name)
            elif body.half_height is not None:
                size = [radius, body.half_height, 0]
                spec.worldbody.add_geom(name=name, type=kinds.mjGEOM_CYLINDER, size=size)
            else:
                size = [radius, 1, 0]
                spec.worldbody.add_geom(name=name, type=kinds.mjGEOM_CAPSULE, size=size)
        self._bodies = bodies
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._touch = np.zeros(6)

    def place(self, index: int, first: np.ndarray, second: np.ndarray) -> None:
        """Put a body where its points are (m)."""
        if self._bodies[index].obstacle is not None:
            return
        self._data.geom_xpos[index] = (first + second) / 2
        if self._bodies[index].half_height is None:
            self._stretch(index, second - first)

    def _stretch(self, geom: int, along: np.ndarray) -> None:
        """Turn and lengthen a capsule."""
        length = np.sqrt(along @ along)
        x, y, z = along / length if length > 0 else (0.0, 0.0, 1.0)
        level = np.hypot(x, y)
        across = (-y / level, x / level, 0.0) if level > 1e-6 else (1.0, 0.0, 0.0)
        a, b, c = across
        self._data.geom_xmat[geom] = (
            *(a, y * c - z * b, x),
            *(b, z * a - x * c, y),
            *(c, x * b - y * a, z),
        )
        self._model.geom_size[geom, 1] = length / 2

    def distance(self, one: int, other: int) -> tuple[float, np.ndarray]:
        """Signed distance of two bodies (m) and the unit vector from `one` to `other`.

        Where they touch or overlap the vector is NaN.
        """
        gap = mujoco.mj_geomDistance(self._model, self._data, one, other, _FAR, self._touch)
        if gap <= 0:
            return gap, np.full(3, np.nan)
        span = self._touch[3:] - self._touch[:3]
        return gap, span / np.sqrt(span @ span)
