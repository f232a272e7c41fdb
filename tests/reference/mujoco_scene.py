"""Obstacles, payload and cables as MuJoCo geoms, and MuJoCo's distances between them.

A capsule against a box goes to a routine of MuJoCo that makes contacts and gives no distance in
general (it reports separation for some segments that pierce the box). Boxes are therefore convex
meshes of eight vertices, for which MuJoCo runs its general convex algorithm. Mesh vertices are
float32: half-extents that are not float32 numbers are off by up to 1e-7 m.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from jaxsusp.geometry.obstacles import Obstacles, pack

KINDS = ("box", "cylinder", "sphere")

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_FAR = 1e3  # m, beyond every distance asked for


class Scene:
    """Fixed obstacles, one movable capsule and, if asked for, one movable upright cylinder."""

    def __init__(
        self,
        obstacles: Sequence,
        capsule_radius: float,
        payload_radius: float = 1.0,
        payload_height: float = 1.0,
    ):
        spec = mujoco.MjSpec()
        spec.option.ccd_tolerance = 1e-12
        spec.option.ccd_iterations = 500
        for index, obstacle in enumerate(obstacles):
            _add(spec, f"obstacle {index}", obstacle)
        spec.worldbody.add_geom(
            name="capsule", type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[capsule_radius, 1, 0]
        )
        spec.worldbody.add_geom(
            name="payload",
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[payload_radius, payload_height / 2, 0],
        )
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.count = len(obstacles)
        self._capsule = self.model.geom("capsule").id
        self._payload = self.model.geom("payload").id
        self._unused = np.zeros(6)

    def place_capsule(self, a: np.ndarray, b: np.ndarray) -> None:
        """Stretch the capsule's axis from a to b, which may coincide."""
        along = b - a
        length = np.sqrt(along @ along)
        x, y, z = along / length if length > 0 else (0.0, 0.0, 1.0)
        if abs(z) < 0.9:
            across = np.array([-y, x, 0.0]) / np.sqrt(x * x + y * y)
        else:
            across = np.array([z, 0.0, -x]) / np.sqrt(z * z + x * x)
        frame = self.data.geom_xmat[self._capsule].reshape(3, 3)
        frame[:, 0] = across
        frame[:, 1] = (
            y * across[2] - z * across[1],
            z * across[0] - x * across[2],
            x * across[1] - y * across[0],
        )
        frame[:, 2] = x, y, z
        self.data.geom_xpos[self._capsule] = 0.5 * (a + b)
        self.model.geom_size[self._capsule, 1] = 0.5 * length

    def place_payload(self, center: np.ndarray) -> None:
        """Put the centre of the upright cylinder somewhere."""
        self.data.geom_xpos[self._payload] = center

    def capsule_distance(self, obstacle: int, limit: float = _FAR) -> float:
        """Signed distance of the capsule to an obstacle, at most `limit` (m)."""
        return self._distance(obstacle, self._capsule, limit)

    def payload_distance(self, obstacle: int, limit: float = _FAR) -> float:
        """Signed distance of the cylinder to an obstacle, at most `limit` (m)."""
        return self._distance(obstacle, self._payload, limit)

    def _distance(self, obstacle: int, geom: int, limit: float) -> float:
        return mujoco.mj_geomDistance(self.model, self.data, obstacle, geom, limit, self._unused)


def _add(spec, name: str, obstacle) -> None:
    """One obstacle of a scenario as a geom of the world, in order."""
    match obstacle.kind:
        case "box":
            spec.add_mesh(name=name, uservert=(0.5 * _CORNERS * obstacle.size).ravel())
            half_yaw = np.deg2rad(obstacle.yaw_deg) / 2
            spec.worldbody.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_MESH,
                meshname=name,
                pos=obstacle.center,
                quat=[np.cos(half_yaw), 0, 0, np.sin(half_yaw)],
            )
        case "cylinder":
            spec.worldbody.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_CYLINDER,
                pos=obstacle.center,
                size=[obstacle.radius, obstacle.height / 2, 0],
            )
        case "sphere":
            spec.worldbody.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_SPHERE,
                pos=obstacle.center,
                size=[obstacle.radius, 0, 0],
            )


def extent(obstacle) -> np.ndarray:
    """Half-extents of the obstacle in its own frame (m)."""
    match obstacle.kind:
        case "box":
            return np.array(obstacle.size) / 2
        case "cylinder":
            return np.array([obstacle.radius, obstacle.radius, obstacle.height / 2])
        case "sphere":
            return np.full(3, obstacle.radius)


def packed(kind: str, obstacles: Sequence) -> Obstacles:
    """Obstacles of one kind as the library's arrays."""
    match kind:
        case "box":
            rows = [(*o.center, *extent(o), np.deg2rad(o.yaw_deg)) for o in obstacles]
        case "cylinder":
            rows = [(*o.center, o.radius, o.height / 2) for o in obstacles]
        case "sphere":
            rows = [(*o.center, o.radius) for o in obstacles]
    of_kind = [np.array(rows) if each == kind else np.empty(0) for each in KINDS]
    return pack(*of_kind, counts=tuple(len(obstacles) if each == kind else 0 for each in KINDS))
