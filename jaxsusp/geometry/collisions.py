"""Exact-in-motion contacts of payload and cables along a polyline.

A count of zero proves that the payload and every cable stay clear of the warning area at *every
instant* of the polyline, not only at its samples. Contacts accumulate elementwise per segment
and are summed once at the end: a reduction inside the loop would keep XLA from vectorising it.
"""

import functools
import operator
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Float, Int
from jaxsusp.geometry.cables import attachment
from jaxsusp.geometry.obstacles import (
    KINDS,
    Boxes,
    Cylinders,
    Hulls,
    Obstacles,
    Spheres,
    over_bodies,
)
from jaxsusp.geometry.segments import MEETS, SweptTests
from jaxsusp.vec3 import Vec3, component, cross, dot, norm, safe_sqrt

SINGLE_PRECISION_MARGIN = 1e-4
"""m; added to every inflation when the arithmetic is float32, so that what a search finds clear
stays clear in float64."""


PARTS = 4
"""Parts into which `count_between` cuts a segment: the margins of swept cables are half a part's
motion, and where ends move, those of whole segments forbid much that is clear."""


class Bodies(NamedTuple):
    """What must stay clear: the upright payload and K cables (m)."""

    radius: Float[Array, ""]
    half_height: Float[Array, ""]
    cable_radius: Float[Array, ""]
    clearance: Float[Array, ""]
    attachments: Vec3  # one entry for a common hook, else K, relative to the centre of mass
    ends: Vec3  # K upper cable ends; where they move, (K, samples, …)
    sums: Hulls | None = None
    """Sums of every obstacle and a load that is no cylinder: what its centre keeps out of. The
    radius is then that of a cylinder around it, and counts for arms alone."""


class Motion(NamedTuple):
    """Every segment of a polyline, and half its motion as margins of the swept cables."""

    start: Vec3
    stop: Vec3
    middle: Vec3
    step: Vec3
    half_step: Array  # ½‖Δ‖
    half_step_xy: Array  # ½‖Δ_xy‖

    @classmethod
    def of(cls, position: Vec3) -> "Motion":
        """Segments between consecutive samples along axis 0."""
        return cls.between(position.each(lambda c: c[:-1]), position.each(lambda c: c[1:]))

    @classmethod
    def between(cls, start: Vec3, stop: Vec3) -> "Motion":
        """Segments from there to there."""
        step = stop - start
        plane = step.x**2 + step.y**2
        return cls(
            start,
            stop,
            0.5 * (start + stop),
            step,
            0.5 * safe_sqrt(plane + step.z**2),
            0.5 * safe_sqrt(plane),
        )


def count_collisions(position: Vec3, bodies: Bodies, obstacles: Obstacles) -> Int[Array, "*batch"]:
    """Number n_p of (segment, body, obstacle) contacts of a polyline (Eq. 21, f6).

    Args:
        position: payload centre, samples on axis 0, any trailing batch axes (m).
        bodies: payload and cables.
        obstacles: packed obstacles of one scenario.

    Returns:
        The count per trajectory; 0 means clear at every instant of the polyline.
    """
    bodies = with_margin(bodies, position.x.dtype)
    return _count(Motion.of(position), bodies, tuple(each_cable(bodies)), obstacles)


def count_at_samples(position: Vec3, bodies: Bodies, obstacles: Obstacles) -> Int[Array, "*batch"]:
    """Number of (sample, body, obstacle) contacts: the paper's check, for comparison alone.

    What a load or a cable passes through between two samples is not seen, and optimisers find that
    out: they space the samples so that the load jumps. Arguments are those of `count_collisions`.

    Returns:
        The count per trajectory; 0 means clear at the samples, and nothing in between.
    """
    bodies = with_margin(bodies, position.x.dtype)
    cables = tuple(
        SweptCable(attachment(bodies.attachments, k), component(bodies.ends, k), None)
        for k in range(bodies.ends.x.shape[0])
    )  # what rests lies in any plane through it: the test of the swept plane passes
    return _count(Motion.between(position, position), bodies, cables, obstacles)


def _count(
    motion: "Motion", bodies: Bodies, cables: Sequence["SweptCable"], obstacles: Obstacles
) -> Int[Array, "*batch"]:
    hits = jnp.zeros(motion.step.x.shape, jnp.int32)
    for kind, packed in kinds_of(bodies, obstacles):

        def add(hits, obstacle, kind=kind):
            found = held_against(kind, obstacle, motion, bodies, cables, MEETS)
            told = [each.astype(jnp.int32) for each in found if each is not None]
            return hits + functools.reduce(operator.add, told, *() if told else (0,))

        hits = over_bodies(add, packed, hits)
    return hits.sum(axis=0)


def kinds_of(bodies: Bodies, obstacles: Obstacles) -> list[tuple[str, Any]]:
    """All kinds of packed obstacles, and the sums that stand for them for some loads."""
    found = [(kind, getattr(obstacles, kind)) for kind in KINDS]
    return found if bodies.sums is None else [*found, (SUMS, bodies.sums)]


SUMS = "sums"


def held_against(
    kind: str,
    obstacle: Any,
    motion: "Motion",
    bodies: Bodies,
    cables: Sequence["SweptCable"],
    tests: SweptTests,
) -> Iterator[Array | None]:
    """What the tests tell of the load, then of every cable, and an obstacle.

    Where the load has sums with obstacles, those tell of it, and the obstacles of cables alone:
    what is not told is None.
    """
    if kind == SUMS:
        start, stop = obstacle.to_own_frame(motion.start), obstacle.to_own_frame(motion.stop)
        yield tests.faces(start, stop, obstacle.faces, lambda normal: bodies.clearance)
        return
    for number, found in enumerate(HELD_AGAINST[kind](obstacle, motion, bodies, cables, tests)):
        yield None if number == 0 and bodies.sums is not None else found


def with_margin(bodies: Bodies, dtype) -> Bodies:
    """Bodies with the clearance that rounding asks for in that dtype."""
    margin = SINGLE_PRECISION_MARGIN if dtype == jnp.float32 else 0.0
    return bodies._replace(clearance=bodies.clearance + margin)


def count_between(position: Vec3, bodies: Bodies, obstacles: Obstacles) -> Int[Array, "*batch"]:
    """As `count_collisions` with every segment cut into `PARTS`: as sound, tighter where ends move.

    It is 0 where that is; where it is not it counts the parts of segments that have a contact.

    Args:
        position: payload centre, samples on axis 0, any trailing batch axes (m).
        bodies: load and cables; their ends (K, samples, …), or (K,) where they stay.
        obstacles: packed obstacles of one scenario.
    """
    ends = bodies.ends
    if ends.x.ndim > 1:
        ends = ends.each(jax.vmap(_cut))
    return count_collisions(position.each(_cut), bodies._replace(ends=ends), obstacles)


def _cut(values: Array) -> Array:
    """Every segment along axis 0 in `PARTS`, evenly."""
    share = (jnp.arange(PARTS) / PARTS).astype(values.dtype)
    share = share.reshape(1, -1, *(1,) * (values.ndim - 1))
    cut = values[:-1, None] * (1 - share) + values[1:, None] * share
    return jnp.concatenate([cut.reshape(-1, *values.shape[1:]), values[-1:]])


class SweptCable(NamedTuple):
    """A cable during every segment: where its upper end is in the middle, and how it moves."""

    attachment: Vec3
    end: Vec3
    step: Vec3 | None  # None: the end stays


def each_cable(bodies: Bodies) -> Iterator[SweptCable]:
    """Every cable; a common hook serves them all."""
    for k in range(bodies.ends.x.shape[0]):
        end = component(bodies.ends, k)
        step = None
        if end.x.ndim > 0:
            before, after = end.each(lambda c: c[:-1]), end.each(lambda c: c[1:])
            end, step = 0.5 * (before + after), after - before
        yield SweptCable(attachment(bodies.attachments, k), end, step)


def _with_box(
    box: Boxes, motion: Motion, bodies: Bodies, cables: Sequence[SweptCable], tests: SweptTests
) -> Iterator[Array]:
    wide = bodies.radius + bodies.clearance
    payload = box.half + Vec3(wide, wide, bodies.half_height + bodies.clearance)
    start, stop = box.to_own_frame(motion.start), box.to_own_frame(motion.stop)
    yield tests.box(start, stop, payload)

    thin = bodies.cable_radius + bodies.clearance
    half = box.half + Vec3(thin, thin, thin)
    middle, step = 0.5 * (start + stop), stop - start
    for cable in cables:
        hook, end_own = middle + box.turn(cable.attachment), box.to_own_frame(cable.end)
        end_step = box.turn(cable.step) if cable.step else None
        met = tests.box(hook, end_own, half + 0.5 * _larger(step, end_step))
        if end_step is None:  # the swept cable lies in one plane
            normal = cross(step, end_own - hook)
            met = tests.both(met, tests.plane_box(normal, end_own, half))
        yield met


def _with_cylinder(
    cylinder: Cylinders,
    motion: Motion,
    bodies: Bodies,
    cables: Sequence[SweptCable],
    tests: SweptTests,
) -> Iterator[Array]:
    start, stop = motion.start - cylinder.center, motion.stop - cylinder.center
    yield tests.cylinder(
        start,
        stop,
        cylinder.radius + bodies.radius + bodies.clearance,
        cylinder.half_height + bodies.half_height + bodies.clearance,
    )

    thin = bodies.cable_radius + bodies.clearance
    radius, half_height = cylinder.radius + thin, cylinder.half_height + thin
    middle, step = motion.middle - cylinder.center, motion.step
    for cable in cables:
        hook, end_own = middle + cable.attachment, cable.end - cylinder.center
        swept_radius, swept_height = radius + motion.half_step_xy, half_height
        swept_height += 0.5 * _larger(step, cable.step).z
        if cable.step:
            swept_radius = radius + jnp.maximum(motion.half_step_xy, 0.5 * _level(cable.step))
        met = tests.cylinder(hook, end_own, swept_radius, swept_height)
        if cable.step is None:
            normal = cross(step, end_own - hook)
            met = tests.both(met, tests.plane_cylinder(normal, end_own, radius, half_height))
        yield met


def _with_sphere(
    sphere: Spheres, motion: Motion, bodies: Bodies, cables: Sequence[SweptCable], tests: SweptTests
) -> Iterator[Array]:
    wide = sphere.radius + bodies.clearance
    start, stop = motion.start - sphere.center, motion.stop - sphere.center
    # The payload meets a sphere conservatively: its inflation is a vertical cylinder.
    yield tests.cylinder(start, stop, wide + bodies.radius, wide + bodies.half_height)

    radius = wide + bodies.cable_radius
    middle, step = motion.middle - sphere.center, motion.step
    for cable in cables:
        hook, end_own = middle + cable.attachment, cable.end - sphere.center
        half_step = motion.half_step
        if cable.step:
            half_step = jnp.maximum(half_step, 0.5 * norm(cable.step))
        met = tests.sphere(hook, end_own, radius + half_step)
        if cable.step is None:
            normal = cross(step, end_own - hook)
            met = tests.both(met, tests.plane_sphere(normal, end_own, radius))
        yield met


def _with_hull(
    hull: Hulls, motion: Motion, bodies: Bodies, cables: Sequence[SweptCable], tests: SweptTests
) -> Iterator[Array]:
    wide, high = bodies.radius + bodies.clearance, bodies.half_height + bodies.clearance
    start, stop = hull.to_own_frame(motion.start), hull.to_own_frame(motion.stop)

    def by_load(normal: Vec3) -> Array:
        """How far an upright cylinder reaches."""
        return wide * safe_sqrt(normal.x**2 + normal.y**2) + high * jnp.abs(normal.z)

    yield tests.faces(start, stop, hull.faces, by_load)

    thin = bodies.cable_radius + bodies.clearance
    middle, step = 0.5 * (start + stop), stop - start
    for cable in cables:
        hook, end_own = middle + hull.turn(cable.attachment), hull.to_own_frame(cable.end)
        end_step = hull.turn(cable.step) if cable.step else None
        half_motion = 0.5 * _larger(step, end_step)

        def by_cable(normal: Vec3, half_motion: Vec3 = half_motion) -> Array:
            """How far a ball and then half the motion reach."""
            return thin + dot(normal.abs(), half_motion)

        met = tests.faces(hook, end_own, hull.faces, by_cable)
        if end_step is None:
            normal = cross(step, end_own - hook)
            met = tests.both(met, tests.plane_corners(normal, end_own, hull.corners, thin))
        yield met


HELD_AGAINST = {
    "boxes": _with_box,
    "cylinders": _with_cylinder,
    "spheres": _with_sphere,
    "hulls": _with_hull,
}
"""How the load and every cable are held against an obstacle, by its kind."""


def _larger(step: Vec3, end_step: Vec3 | None) -> Vec3:
    """Per axis the larger motion of a cable's two ends: no point of it moves more."""
    if end_step is None:
        return step.abs()
    return Vec3(*map(jnp.maximum, step.abs(), end_step.abs()))


def _level(step: Vec3) -> Array:
    return safe_sqrt(step.x**2 + step.y**2)
