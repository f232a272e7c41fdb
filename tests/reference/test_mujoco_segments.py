"""Segment tests against MuJoCo's distance between a thin capsule and a convex geom.

A capsule of radius ε lies ε closer than its axis, so the axis meets an obstacle iff MuJoCo's
distance plus ε is not positive. Left out and counted are pairs whose distance is below what the
arithmetic resolves, and those for which MuJoCo finds an overlap but no depth: it then returns an
exact zero, about once in 40 000 pairs.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from mujoco_scene import KINDS, Scene, extent, packed

from jaxsusp.geometry.segments import (
    segment_meets_box,
    segment_meets_cylinder,
    segment_meets_sphere,
)
from jaxsusp.scenario.models import Box, Cylinder, Sphere
from jaxsusp.vec3 import Vec3

THIN = 1e-4  # m, radius of the capsule
OBSTACLES = 24  # per kind
SHAPES = 12  # ways to draw a segment, below
PER_SHAPE = 20  # segments of each for every obstacle
GRID = 1 / 64  # sizes are multiples of it and so exact in the float32 of MuJoCo's meshes


class Pairs(NamedTuple):
    """Segments a-b and the obstacle each is held against."""

    a: np.ndarray  # (n, 3), m
    b: np.ndarray
    obstacle: np.ndarray  # (n,), index
    distance: np.ndarray  # (n,), MuJoCo's: not positive where the segment meets it, 0 for no answer


def draw_obstacles(kind: str, rng) -> list:
    def center():
        return tuple(rng.uniform(-2, 2, 3))

    def size(count):
        return [float(GRID * n) for n in rng.integers(12, 128, count)]

    match kind:
        case "box":
            yaws = [0.0, 90.0, *rng.uniform(-180, 180, OBSTACLES - 2)]
            return [Box(center=center(), size=tuple(size(3)), yaw_deg=yaw) for yaw in yaws]
        case "cylinder":
            sizes = [size(2) for _ in range(OBSTACLES)]
            return [Cylinder(center=center(), radius=r / 2, height=h) for r, h in sizes]
        case "sphere":
            return [Sphere(center=center(), radius=size(1)[0] / 2) for _ in range(OBSTACLES)]


def draw_segment(shape: int, half: np.ndarray, kind: str, rng) -> tuple[np.ndarray, np.ndarray]:
    """A segment in the obstacle's own frame."""
    a, b = rng.uniform(-1.8, 1.8, (2, 3)) * half
    match shape:
        case 0:  # of no length
            b = a.copy()
        case 1:  # vertical
            b[:2] = a[:2]
        case 2:  # horizontal
            b[2] = a[2]
        case 3 | 4:  # along a horizontal axis of the obstacle
            axis = shape - 3
            b[np.arange(3) != axis] = a[np.arange(3) != axis]
        case 5:  # as long as a cable
            b = a + 8 * unit(rng)
        case 6:  # as short as a step
            b = a + 10 ** rng.uniform(-6, -1) * unit(rng)
        case 7:  # ends just outside or just inside the surface
            a = surface_point(half, kind, rng)
            outwards = a * rng.uniform(0.2, 2, 3)
            b = a + outwards
            a = a * (1 + rng.choice([-1, 1]) * 10 ** rng.uniform(-7, -2))
        case 8:  # through the axis or the centre
            a[:2], b[:2] = rng.uniform(0.1, 1.5) * a[:2], -rng.uniform(0.1, 1.5) * a[:2]
    return a, b


def unit(rng) -> np.ndarray:
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def surface_point(half: np.ndarray, kind: str, rng) -> np.ndarray:
    """A point of the surface such that a ray from the centre through it leaves the obstacle."""
    toward = unit(rng)
    match kind:
        case "box":
            scale = np.abs(toward).max()
        case "cylinder":
            scale = max(np.hypot(*toward[:2]), abs(toward[2]))
        case "sphere":
            scale = 1.0
    return toward / scale * half


def to_world(obstacle, points: np.ndarray) -> np.ndarray:
    yaw = np.deg2rad(getattr(obstacle, "yaw_deg", 0.0))
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    return points @ turn.T + obstacle.center


def axis_distance(scene: Scene, obstacle: int) -> float:
    """Signed distance of the capsule's axis; 0 where MuJoCo has no answer."""
    distance = scene.capsule_distance(obstacle)
    return 0.0 if distance == 0 else distance + THIN


def draw_pairs(kind: str, obstacles: list, rng) -> Pairs:
    scene = Scene(obstacles, THIN)
    rows = []
    for index, obstacle in enumerate(obstacles):
        half = extent(obstacle)
        for shape in np.repeat(np.arange(SHAPES), PER_SHAPE):
            a, b = to_world(obstacle, np.array(draw_segment(shape, half, kind, rng)))
            scene.place_capsule(a, b)
            rows.append((a, b, index, axis_distance(scene, index)))
    return Pairs(*map(np.array, zip(*rows, strict=True)))


def ours(kind: str, obstacles: list, pairs: Pairs, dtype) -> np.ndarray:
    """Whether each segment meets its obstacle, by the library."""
    everything = packed(kind, obstacles)
    chosen = everything[KINDS.index(kind)]
    body = jax.tree.map(lambda leaf: jnp.asarray(leaf[pairs.obstacle], dtype), chosen)
    a, b = (Vec3.from_array(jnp.asarray(end, dtype)) for end in (pairs.a, pairs.b))
    if kind == "box":
        return np.asarray(segment_meets_box(body.to_own_frame(a), body.to_own_frame(b), body.half))
    a, b = a - body.center, b - body.center
    if kind == "cylinder":
        return np.asarray(segment_meets_cylinder(a, b, body.radius, body.half_height))
    return np.asarray(segment_meets_sphere(a, b, body.radius))


@pytest.mark.parametrize(
    ("dtype", "resolution", "left_out"),
    [(np.float64, 1e-10, 0.01), (np.float32, 1e-5, 0.06)],
    ids=["float64", "float32"],
)
@pytest.mark.parametrize("kind", KINDS)
def test_segments_meet_what_mujoco_says_they_meet(kind, dtype, resolution, left_out):
    rng = np.random.default_rng([2, KINDS.index(kind)])
    obstacles = draw_obstacles(kind, rng)
    pairs = draw_pairs(kind, obstacles, rng)
    told = np.abs(pairs.distance) > resolution
    theirs = pairs.distance <= 0
    wrong = (ours(kind, obstacles, pairs, dtype) != theirs) & told
    print(
        f"\n{kind}, {np.dtype(dtype)}: {told.sum()} pairs, {theirs[told].mean():.0%} hits, "
        f"{(~told).sum()} left out, {wrong.sum()} disagreements"
    )

    assert told.sum() > 4000
    assert (~told).mean() < left_out
    assert 0.2 < theirs[told].mean() < 0.8
    assert not wrong.any(), [np.flatnonzero(wrong)[:5], pairs.distance[wrong][:5]]


BOX = Box(center=(0, 0, 0), size=(1, 2, 3))
CYLINDER = Cylinder(center=(0, 0, 0), radius=0.5, height=2)
SPHERE = Sphere(center=(0, 0, 0), radius=0.5)


@pytest.mark.parametrize(
    ("obstacle", "a", "b"),
    [
        pytest.param(BOX, (0.5, 0.25, 0), (1.5, 0.75, 0), id="end on a face of a box"),
        pytest.param(BOX, (-2, 1, -2), (2, 1, 2), id="within a face of a box"),
        pytest.param(BOX, (1, 0.5, 0), (0, 1.5, 0), id="across an edge of a box"),
        pytest.param(BOX, (0.5, 1, 1.5), (0.5, 1, 1.5), id="corner of a box"),
        pytest.param(CYLINDER, (0.5, 0, -3), (0.5, 0, 3), id="along a cylinder"),
        pytest.param(CYLINDER, (0.5, -3, 0), (0.5, 3, 0), id="across a cylinder"),
        pytest.param(CYLINDER, (-2, 0.25, -1), (2, 0.25, -1), id="within a cylinder's bottom"),
        pytest.param(CYLINDER, (-2, 0.25, 1), (2, 0.25, 1), id="within a cylinder's top"),
        pytest.param(CYLINDER, (0, 0.5, 1), (0, 0.5, 1), id="rim of a cylinder"),
        pytest.param(SPHERE, (-2, 0.5, 0), (2, 0.5, 0), id="across a sphere"),
        pytest.param(SPHERE, (0, 0, 0.5), (0, 0, 0.5), id="point of a sphere"),
    ],
)
def test_touching_is_meeting(obstacle, a, b):
    a, b = np.array(a, float), np.array(b, float)
    scene = Scene([obstacle], THIN)
    scene.place_capsule(a, b)
    distance = scene.capsule_distance(0) + THIN
    pair = Pairs(a[None], b[None], np.array([0]), np.array([distance]))
    assert abs(distance) < 1e-6
    assert ours(obstacle.kind, [obstacle], pair, np.float64).all()
