"""Exact distances between the bodies of a plan, measured by MuJoCo.

`mj_geomDistance` (general convex algorithm, `ccd_tolerance` 1e-12) gives the distance of two
bodies and the nearest points.
"""

from collections.abc import Sequence

import numpy as np

from jaxsusp.verify.bodies import THIN, Body
from jaxsusp.verify.engine import mujoco

_FAR = 1e3  # m, beyond every distance asked for


class Scene:
    """Bodies in one MuJoCo model that is never stepped: placed, and measured pair by pair.

    Args:
        bodies: obstacles stand where they are, all others are placed.
    """

    def __init__(self, bodies: Sequence[Body]):
        spec = mujoco.MjSpec()
        spec.option.ccd_tolerance = 1e-12
        spec.option.ccd_iterations = 500
        kinds = mujoco.mjtGeom
        for index, body in enumerate(bodies):
            name, radius = f"{index}", max(body.radius, THIN)
            if body.obstacle is not None:
                body.obstacle.add(spec, name)
            elif body.load is not None:
                body.load.add(spec, name)
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
        self._middle = self._data.geom_xpos.copy()  # a mesh has its frame in its centre of mass

    def place(self, index: int, first: np.ndarray, second: np.ndarray) -> None:
        """Put a body where its points are (m)."""
        if self._bodies[index].obstacle is not None:
            return
        self._data.geom_xpos[index] = (first + second) / 2
        if self._bodies[index].load is not None:
            self._data.geom_xpos[index] += self._middle[index]
            return
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
