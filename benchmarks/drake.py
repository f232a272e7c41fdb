"""IRIS beside Drake's on the same random boxes, seeds and options."""

import time
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from jaxsusp.freespace.iris import Bodies, iris
from jaxsusp.freespace.polyhedra import Body, HalfSpaces, Point

SIDE = 10.0  # of the workspace, m
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


class Pair(NamedTuple):
    """One region, grown twice."""

    ours: float  # volume of the ellipsoid, m³
    drakes: float
    seconds: float
    drakes_seconds: float


def boxes(count: int, seed: int) -> list[tuple[Point, Point]]:
    """Random boxes (lower, upper) in a cube, smaller where there are more."""
    random = np.random.default_rng([count, seed])
    centers = random.uniform(0, SIDE, (count, 3))
    halves = random.uniform(0.1, 1.0, (count, 3)) * (10 / count) ** (1 / 3)
    return list(zip(centers - halves, centers + halves, strict=True))


def seeds(scene: list[tuple[Point, Point]], count: int, seed: int) -> list[Point]:
    """Random points outside all boxes."""
    random, found = np.random.default_rng(seed), []
    while len(found) < count:
        point = random.uniform(0, SIDE, 3)
        if not any((low < point).all() and (point < high).all() for low, high in scene):
            found.append(point)
    return found


def compare(count: int, regions: int, seed: int = 0) -> Iterator[Pair]:
    """Grow regions in one scene by both, with Drake's defaults and the seed kept inside."""
    from pydrake.geometry.optimization import HPolyhedron, Iris, IrisOptions

    scene = boxes(count, seed)
    bodies = Bodies([Body.hull("box", (a + b) / 2 + CORNERS * (b - a) / 2) for a, b in scene])
    domain = HalfSpaces.box(np.zeros(3), np.full(3, SIDE))
    obstacles = [HPolyhedron.MakeBox(low, high) for low, high in scene]
    whole = HPolyhedron.MakeBox(np.zeros(3), np.full(3, SIDE))
    options = IrisOptions()
    options.require_sample_point_is_contained = True
    for point in seeds(scene, regions, seed):
        clock = time.perf_counter()
        region = iris(bodies, domain, point)
        seconds, clock = time.perf_counter() - clock, time.perf_counter()
        polytope = Iris(obstacles, point, whole, options)
        drakes_seconds = time.perf_counter() - clock
        assert region is not None
        drakes = polytope.MaximumVolumeInscribedEllipsoid().CalcVolume()
        yield Pair(region.ellipsoid.volume, drakes, seconds, drakes_seconds)
