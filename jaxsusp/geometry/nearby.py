"""Which obstacles load and cables can touch from where, so that the others are not tested.

The workspace is cut into cells, coarser ones for longer segments: a segment belongs to the cell
that its middle is in, of the finest level whose cells are as long as half of it. From a cell every
body (the load, each cable) can touch some obstacles and never the others. Which, is told once by
the tests of `collisions` themselves: of a body at rest in the cell's middle, grown by all that a
segment of that cell can be elsewhere. A count by lists of them is therefore the count of all.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.geometry.collisions import (
    HELD_AGAINST,
    SINGLE_PRECISION_MARGIN,
    Bodies,
    Motion,
    each_cable,
    with_margin,
)
from jaxsusp.geometry.obstacles import Obstacles
from jaxsusp.geometry.segments import MEETS
from jaxsusp.vec3 import Vec3

LISTED = ("boxes", "cylinders", "spheres")
"""Kinds of obstacles of which there are lists, where there is no other kind."""

DIVISIONS = (32, 23, 16, 11, 8, 6, 4, 3)
"""Cells along every axis of the box, finest level first; from one to the next they grow by √2."""

BEYOND = 0.125
"""Share of the workspace by which the box of cells is larger on every side: curves overshoot."""

SLACK = 1e-3
"""Share of a cell's length by which bodies are grown beyond what they need, against rounding."""

GROUP = 512
"""Segments that are taken together, for as long as the one that has the most to be tested."""

_CHUNK = 4096  # cells that lists are made for at a time


class Nearby(NamedTuple):
    """Lists of obstacles per kind, body (the load, then every cable) and cell.

    The obstacles of list (i, j, c) are numbers[first[i, j, c]:first[i, j, c + 1]]. The last cell is
    everywhere else: its lists hold all that there is.
    """

    lower: Vec3  # corner of the box of cells, m
    extent: Vec3  # its sides, m
    reach: Float[Array, "*stack levels"]  # longest half segment that a level serves, m
    rank: Int[Array, "*stack cells"]  # of cells by the length of their lists, about
    first: Int[Array, "*stack kinds bodies borders"]
    numbers: Int[Array, "*stack entries"]

    def cell(self, middle: Vec3, half_step: Array) -> Int[Array, "..."]:
        """The cell of every segment, by its middle and half its length (m)."""
        divisions, offsets = (jnp.asarray(each, jnp.int32) for each in (DIVISIONS, _OFFSETS))
        level = jnp.zeros(half_step.shape, jnp.int32)
        for i in range(len(DIVISIONS)):
            level += (~(half_step <= self.reach[i])).astype(jnp.int32)
        served = level < len(DIVISIONS)
        level = jnp.minimum(level, len(DIVISIONS) - 1)
        count, number = divisions[level], jnp.zeros_like(level)
        for at, lower, extent in zip(middle, self.lower, self.extent, strict=True):
            share = (at - lower) / extent
            served &= (share >= 0) & (share < 1)
            along = (share * count.astype(share.dtype)).astype(jnp.int32)
            number = number * count + jnp.clip(along, 0, count - 1)
        return jnp.where(served, offsets[level] + number, _OFFSETS[-1])


_OFFSETS = tuple(np.cumsum([0, *(n**3 for n in DIVISIONS)]).tolist())
"""The number of every level's first cell, and last that of everywhere else."""


def count_nearby(
    position: Vec3, bodies: Bodies, obstacles: Obstacles, nearby: Nearby
) -> Int[Array, "*batch"]:
    """`count_collisions` of bodies whose ends stay, without the tests that must fail.

    Segments are taken in groups, in the order of how many obstacles they are tested against: as
    many for all of a group, some of them for nothing.

    Args:
        position: payload centre, samples on axis 0, any trailing batch axes (m).
        bodies: payload and cables, those that the lists were made for or the payload alone.
        obstacles: packed obstacles of one scenario, those that the lists were made for.
        nearby: the lists.
    """
    bodies, nearby = with_margin(bodies, position.x.dtype), jax.tree.map(jnp.asarray, nearby)
    # Counts have no slope: what follows is spared the tangents of a gradient.
    position = position.each(jax.lax.stop_gradient)
    shape = position.x[1:].shape
    ends = position.each(lambda c: c[:-1].reshape(-1)), position.each(lambda c: c[1:].reshape(-1))
    motion = Motion.between(*ends)
    cell = nearby.cell(motion.middle, motion.half_step)
    order = jnp.argsort(nearby.rank[cell])
    group = min(GROUP, order.size)
    order = jnp.pad(order, (0, -order.size % group), mode="edge").reshape(-1, group)
    count = partial(_count_group, bodies=bodies, obstacles=obstacles, nearby=nearby)
    start, stop = (each.each(lambda c: c[order]) for each in ends)
    hits = jax.lax.map(lambda each: count(*each), (start, stop, cell[order]))
    return jnp.zeros_like(cell).at[order].set(hits).reshape(shape).sum(axis=0)


def _count_group(
    start: Vec3, stop: Vec3, cell: Array, bodies: Bodies, obstacles: Obstacles, nearby: Nearby
) -> Int[Array, "segments"]:
    """Contacts of every segment of a group with what its lists hold."""
    motion, hits = Motion.between(start, stop), jnp.zeros(cell.shape, jnp.int32)
    for kind, first in zip(LISTED, nearby.first, strict=True):
        packed = jax.tree.map(jnp.asarray, getattr(obstacles, kind))
        if packed.active.size == 0:
            continue
        for number, cables in enumerate(((), *((cable,) for cable in each_cable(bodies)))):
            begin, end = first[number][cell], first[number][cell + 1]

            def test(i, hits, packed=packed, kind=kind, cables=cables, begin=begin, end=end):
                at = begin + i
                chosen = nearby.numbers[jnp.minimum(at, nearby.numbers.shape[0] - 1)]
                obstacle = jax.tree.map(lambda leaf: leaf[chosen.astype(jnp.int32)], packed)
                *_, met = HELD_AGAINST[kind](obstacle, motion, bodies, cables, MEETS)
                return hits + (met & (at < end)).astype(jnp.int32)

            hits = jax.lax.fori_loop(0, (end - begin).max(), test, hits)
    return hits


def nearby_of(bodies: Bodies, obstacles: Obstacles, lower: Vec3, upper: Vec3) -> Nearby:
    """The lists of a scenario whose ends stay.

    Args:
        bodies: load and cables, float64.
        obstacles: of the scenario, float64.
        lower: a corner of the load's workspace (m).
        upper: the opposite one.
    """
    extent = np.array(upper) - np.array(lower)
    corner, extent = np.array(lower) - BEYOND * extent, (1 + 2 * BEYOND) * extent
    reach = np.array([extent.max() / divisions for divisions in DIVISIONS])
    lists = [_lists(kind, bodies, obstacles, corner, extent, reach) for kind in LISTED]
    lengths = np.array([[counts for counts, _ in each] for each in lists])
    ends = np.cumsum(lengths).reshape(lengths.shape)
    first = np.concatenate([(ends - lengths)[..., :1], ends], axis=-1)
    numbers = np.concatenate([numbers for each in lists for _, numbers in each])
    about = np.round(8 * np.log2(1 + lengths.sum(axis=(0, 1))))
    rank = np.empty(about.size, np.int32)
    rank[np.argsort(about, kind="stable")] = np.arange(about.size)
    tables = rank, first.astype(np.int32)
    found = Nearby(Vec3(*corner), Vec3(*extent), reach, *tables, numbers)
    # Powers of two, so that programs for one scene serve others.
    return padded(found, 1 << (len(numbers) - 1).bit_length())


def padded(nearby: Nearby, length: int) -> Nearby:
    """The same lists in a longer array, so that they stack."""
    numbers = np.pad(nearby.numbers, (0, length - nearby.numbers.size))
    return nearby._replace(numbers=numbers)


def _lists(
    kind: str, bodies: Bodies, obstacles: Obstacles, corner: np.ndarray, extent: np.ndarray,
    reach: np.ndarray,
) -> list[tuple[np.ndarray, np.ndarray]]:  # fmt: skip
    """Lengths of all lists of a kind, and what they hold one after the other, for every body."""
    packed = getattr(obstacles, kind)
    there = int(packed.active.sum())
    counts: list[list[np.ndarray]] = [[] for _ in range(1 + bodies.ends.x.shape[0])]
    numbers: list[list[np.ndarray]] = [[] for _ in counts]
    for divisions, longest in zip(DIVISIONS, reach, strict=True):
        size = extent / divisions
        grown = bodies_grown(bodies, longest + np.linalg.norm(size) / 2 + SLACK * longest)
        places = corner + size * (np.indices((divisions,) * 3).reshape(3, -1).T + 0.5)
        for touched in _touched(kind, packed, grown, places) if there else ():
            for body, found in enumerate(touched):
                counts[body].append(found.sum(axis=1))
                numbers[body].append(np.nonzero(found)[1])
        if not there:
            for each in counts:
                each.append(np.zeros(len(places), int))
    return [
        (
            np.concatenate([*lengths, [there]]),
            np.concatenate([*found, np.arange(there)]).astype(np.uint16),
        )
        for lengths, found in zip(counts, numbers, strict=True)
    ]


def bodies_grown(bodies: Bodies, by: float) -> Bodies:
    """Load and cables that reach so much (m) further, and a float32's margin."""
    return bodies._replace(
        radius=bodies.radius + by,
        half_height=bodies.half_height + by,
        cable_radius=bodies.cable_radius + by,
        clearance=bodies.clearance + SINGLE_PRECISION_MARGIN,
    )


def _touched(
    kind: str, packed: Any, bodies: Bodies, places: np.ndarray
) -> Iterator[Bool[np.ndarray, "bodies places obstacles"]]:
    """Which obstacles of a kind every body touches at rest in places of the load, in portions."""
    there = int(packed.active.sum())
    for begin in range(0, len(places), _CHUNK):
        part = places[begin : begin + _CHUNK]
        filled = np.pad(part, ((0, _CHUNK - len(part)), (0, 0)), mode="edge")  # one program
        with jax.enable_x64(True):
            found = _touching(kind, packed, bodies, Vec3(*filled.T))
        yield np.moveaxis(np.asarray(found)[:there, :, : len(part)], 0, -1)


@partial(jax.jit, static_argnums=0)
def _touching(kind: str, packed: Any, bodies: Bodies, places: Vec3) -> Array:
    motion, cables = Motion.between(places, places), tuple(each_cable(bodies))

    def one(obstacle: Any) -> Array:
        return jnp.stack([*HELD_AGAINST[kind](obstacle, motion, bodies, cables, MEETS)])

    return jax.lax.map(one, packed)
