"""The bodies of a plan and their exact distances: MuJoCo measures, closed forms support.

`mj_geomDistance` (general convex algorithm, `ccd_tolerance` 1e-12) gives the distance of two
bodies and the nearest points. Two things to know about it: a capsule against a box goes to a
routine that makes contacts and gives no distance in general, so boxes are convex meshes of eight
vertices here; and mesh vertices are single precision, which moves a face by up to 1e-7 m.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.geometry.meshes import bounding_box
from jaxsusp.scenario import Scenario
from jaxsusp.verify.engine import mujoco

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


class Fixed(NamedTuple):
    """A body that stands still during the plan."""

    name: str
    shape: Shape
    robot: int = -1  # whose arm it belongs to; -1: an obstacle
    part: int = -1  # 0 column, 1 upper link, 2 lower link


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


def fixed_bodies(
    scenario: Scenario, chains: Float[Array, "cables points=4 xyz"]
) -> tuple[Fixed, ...]:
    """Obstacles and the robots' columns and links.

    Args:
        scenario: obstacles and radii.
        chains: foot, shoulder, elbow and end of every robot (m).
    """
    bodies = [
        Fixed(obstacle.name or f"obstacle {number}", obstacle_shape(obstacle))
        for number, obstacle in enumerate(scenario.obstacles, start=1)
    ]
    for k, (robot, chain) in enumerate(zip(scenario.robots, np.asarray(chains), strict=True)):
        for part, name in enumerate(("column", "upper link", "lower link")):
            radius = robot.link_radius if part else robot.column_radius
            shape = CapsuleShape(chain[part], chain[part + 1], radius)
            bodies.append(Fixed(f"{name} of robot {k + 1}", shape, k, part))
    return tuple(bodies)


class Scene:
    """Fixed bodies, the load and its cables in one MuJoCo model that is never stepped.

    Args:
        scenario: sizes of load and cables.
        bodies: what stands still.
        cables: number K of cables.
    """

    def __init__(self, scenario: Scenario, bodies: Sequence[Fixed], cables: int):
        spec = mujoco.MjSpec()
        spec.option.ccd_tolerance = 1e-12
        spec.option.ccd_iterations = 500
        for index, body in enumerate(bodies):
            body.shape.add(spec, f"{index}")
        payload, radius = scenario.payload, scenario.limits.cable_radius
        spec.worldbody.add_geom(
            name="load",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[payload.radius, payload.height / 2, 0],
        )
        for k in range(cables):
            spec.worldbody.add_geom(
                name=f"cable {k}", type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[radius, 1, 0]
            )
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self.load = len(bodies)
        """Geom of the load; fixed bodies come before it, cables behind it."""
        self._touch = np.zeros(6)

    def place_load(self, center: np.ndarray) -> None:
        """Put the centre of the upright load somewhere (m)."""
        self._data.geom_xpos[self.load] = center

    def place_cable(self, k: int, lower: np.ndarray, upper: np.ndarray) -> None:
        """Stretch cable k between two points (m)."""
        geom = self.load + 1 + k
        along = upper - lower
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
        self._data.geom_xpos[geom] = (lower + upper) / 2
        self._model.geom_size[geom, 1] = length / 2

    def distance(self, one: int, other: int) -> tuple[float, np.ndarray]:
        """Signed distance of two geoms (m) and the unit vector from `one` to `other`.

        Where they touch or overlap the vector is NaN.
        """
        gap = mujoco.mj_geomDistance(self._model, self._data, one, other, _FAR, self._touch)
        if gap <= 0:
            return gap, np.full(3, np.nan)
        span = self._touch[3:] - self._touch[:3]
        return gap, span / np.sqrt(span @ span)
