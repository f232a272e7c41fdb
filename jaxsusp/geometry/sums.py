"""Where a load that is no cylinder meets an obstacle: sums of convex bodies.

The load keeps its posture, so the places of its centre at which it meets a convex body are the sum
of the body and of the load seen in a mirror, a polytope again. Round obstacles are circumscribed by
prisms, so that clear is really clear; spheres by those of the cylinders around them, as for an
upright cylinder as load.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from jaxsusp._types import Float
from jaxsusp.geometry.polytopes import Polytope, hull_of

SIDES = 24
"""Sides of the prism around a round obstacle."""

FACES = 48
"""Most faces of a sum, before its edges are bevelled."""

_SIGNS = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), axis=-1).reshape(-1, 3)


def sums(obstacle: Any, load: Polytope) -> Iterator[Polytope]:
    """Places of a load's centre at which it meets an obstacle, one per convex body of it (m)."""
    for corners in _corners(obstacle, inside=False):
        yield hull_of(_summed(corners, load), FACES)


def inner_points(obstacle: Any, load: Polytope) -> Iterator[Float[np.ndarray, "points xyz"]]:
    """Points whose hulls are within those places, one per convex body (m)."""
    for corners in _corners(obstacle, inside=True):
        yield _summed(corners, load)


def _summed(corners: np.ndarray, load: Polytope) -> np.ndarray:
    return (corners[:, None] - load.corners).reshape(-1, 3)


def _corners(obstacle: Any, inside: bool) -> Iterator[np.ndarray]:
    """Corners of polytopes around an obstacle, or within it."""
    center = np.array(obstacle.center, np.float64)
    match obstacle.kind:
        case "mesh" if obstacle.shape != "box":
            for body in obstacle.bodies:
                yield body.placed(center, obstacle.yaw_deg).corners
        case "box" | "mesh":
            yaw = np.deg2rad(obstacle.yaw_deg)
            x, y, z = (_SIGNS * np.array(obstacle.size) / 2).T
            level = np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y
            yield center + np.stack([*level, z], axis=1)
        case "cylinder":
            yield center + _prism(obstacle.radius, obstacle.height / 2, inside)
        case "sphere" if inside:
            tilts = np.deg2rad([-90, -45, 0, 45, 90])
            rings = [np.add(_prism(np.cos(t), 0.0, True), [0, 0, np.sin(t)]) for t in tilts]
            yield center + obstacle.radius * np.concatenate(rings)
        case "sphere":
            yield center + _prism(obstacle.radius, obstacle.radius, inside)
        case _:
            raise ValueError(f"no sum with an obstacle of kind {obstacle.kind!r}")


def _prism(radius: float, half_height: float, inside: bool) -> np.ndarray:
    angle = 2 * np.pi * (np.arange(SIDES) + 0.5) / SIDES
    wide = radius if inside else radius / np.cos(np.pi / SIDES)
    ring = wide * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.concatenate(
        [np.column_stack([ring, np.full(SIDES, z)]) for z in (-half_height, half_height)]
    )
