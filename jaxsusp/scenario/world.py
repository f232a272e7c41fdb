"""The world of a scenario as arrays: what JAX sees of it.

A `Scenario` is for people; a `World` is a pytree of coefficients with nothing ragged in it, so
that worlds of equal robot and (padded) obstacle counts stack and one compiled program serves them
all. Host code builds it in float64; the fitness casts it to the dtype of its argument.
"""

import functools
import math
import os
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float
from jaxsusp.geometry.collisions import Bodies
from jaxsusp.geometry.obstacles import Obstacles, Placed, hull_counts, pack, pack_hulls
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.geometry.sums import sums
from jaxsusp.mechanics.drives import moving
from jaxsusp.mechanics.posture.load import Load
from jaxsusp.mechanics.posture.tilting import attachment_motion, warning_half_extents
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import TOUCH
from jaxsusp.vec3 import Vec3


class Limits(NamedTuple):
    """The bounds of Eq. 22 that the fitness counts (N, m, 1, rad)."""

    tension_low: Float[Array, ""]
    tension_high: Float[Array, ""]
    length_low: Float[Array, ""]
    length_high: Float[Array, ""]
    stability: Float[Array, ""]
    posture: Float[Array, ""]
    separation: Float[Array, ""]


class Robots(NamedTuple):
    """The K robots (m, rad); joints without limits have infinite ones."""

    base: Float[Array, "*stack cables xyz"]
    links: Float[Array, "*stack cables joints"]
    radius: Float[Array, "*stack cables parts=3"]  # of column, upper and lower link
    joint_low: Float[Array, "*stack cables joints"]
    joint_high: Float[Array, "*stack cables joints"]

    @property
    def shoulder(self) -> Vec3:
        """Tops of the columns."""
        base = Vec3.from_array(jnp.asarray(self.base))
        return base._replace(z=base.z + self.links[..., 0])

    @property
    def nearest(self) -> Float[Array, "*stack cables"]:
        """Least distance of an end from the shoulder."""
        return jnp.abs(jnp.asarray(self.links[..., 1] - self.links[..., 2]))

    @property
    def farthest(self) -> Float[Array, "*stack cables"]:
        """Greatest distance of an end from the shoulder."""
        return jnp.asarray(self.links[..., 1] + self.links[..., 2])


class Shape(NamedTuple):
    """Half-extents of what must stay clear of obstacles, the load's posture limit included (m)."""

    radius: float
    half_height: float
    cable_radius: float


class World(NamedTuple):
    """One scenario, or several stacked along a leading axis of every leaf (SI units)."""

    start: Vec3
    goal: Vec3
    lower: Vec3  # workspace of the payload's centre
    upper: Vec3
    floor: Float[Array, ""]  # least z of the payload's centre, by workspace and ground
    bodies: Bodies
    obstacles: Obstacles
    limits: Limits
    mass: Float[Array, ""]
    duration: Float[Array, ""]
    weights: Float[Array, "terms"]
    kappa: Float[Array, ""]
    center_of_mass: Vec3  # from the payload's centre
    robots: Robots

    @property
    def cables(self) -> int:
        """Number of cables K."""
        return self.bodies.ends.x.shape[-1]

    def load(self, gravity: Float[Array, "xyz"]) -> Load:
        """The load as `mechanics.posture.load` sees it, in a field of gravity (m/s²)."""
        rows = jnp.broadcast_to(self.bodies.attachments.to_array(), (self.cables, 3))
        return Load(self.mass, gravity, self.center_of_mass.to_array(), rows)


def obstacle_counts(scenarios: Sequence[Statement]) -> tuple[int, ...]:
    """Least padded numbers, as `pack` takes them, that hold every one of the scenarios."""
    rows = [_by_kind(scenario) for scenario in scenarios]
    plain = tuple(max(len(each[kind]) for each in rows) for kind in _PLAIN)
    hulls = _most(hull_counts(each["hulls"]) for each in rows)
    sums = _most(hull_counts(load_sums(scenario)) for scenario in scenarios)
    return plain + ((hulls or (0, 0, 0)) + sums if sums else hulls)


def _most(counts: Iterable[tuple[int, ...]]) -> tuple[int, ...]:
    """The most of each number that there is."""
    return tuple(max(column) for column in zip(*filter(None, counts), strict=True))


def rounded_counts(scenario: Statement) -> tuple[int, ...]:
    """Padded number of every kind: the same for all of them, 16, 64, 256, and so on.

    For programs that meet one scenario after the other: nearly all of them share the compiled
    program, and padding costs no time (`geometry.obstacles.over_bodies`). Hulls are rounded by
    themselves, and programs of scenarios without any hold none.
    """
    counts = obstacle_counts([scenario])
    plain = (rounded_up(max(counts[:3]), 16),) * 3
    more = zip(counts[3:], (4, 64, 64, 16, 64, 64), strict=False)
    return plain + tuple(rounded_up(count, least) if count else 0 for count, least in more)


def one_at_a_time(scenario: Statement) -> tuple[int, ...]:
    """Counts for a scenario with one obstacle, the same for nearly all of them."""
    return (1, 1, 1, *rounded_counts(scenario)[3:])


def rounded_up(count: int, least: int) -> int:
    """The first of least, 4 least, 16 least, … that is no less than a count."""
    while least < count:
        least *= 4
    return least


def build_world(scenario: Statement, counts: Sequence[int] | None = None) -> World:
    """Scenario → World, float64 on the host, obstacles padded to `counts` (default: no padding)."""
    payload, limits, robots = scenario.payload, scenario.limits, scenario.robots
    attachments = (
        np.array([[0.0, 0.0, payload.height / 2]])
        if payload.attachments == "hook"
        else np.asarray(payload.attachments, np.float64)
    )
    shape, with_load = warning_shape(scenario), load_sums(scenario)
    counts = tuple(counts or obstacle_counts([scenario]))
    bodies = Bodies(
        radius=_scalar(shape.radius),
        half_height=_scalar(shape.half_height),
        cable_radius=_scalar(shape.cable_radius),
        clearance=_scalar(limits.clearance),
        attachments=_vector(attachments),
        ends=_vector([robot.end for robot in robots]),
        sums=pack_hulls(with_load, counts[6:] or hull_counts(with_load)),
    )
    return World(
        start=_vector(scenario.task.start),
        goal=_vector(scenario.task.goal),
        lower=_vector(scenario.workspace.lower),
        upper=_vector(scenario.workspace.upper),
        floor=_scalar(lowest(scenario)[2]),
        bodies=bodies,
        obstacles=_packed(scenario, counts),
        limits=_limits(limits),
        mass=_scalar(payload.mass),
        duration=_scalar(scenario.task.duration),
        weights=np.asarray(scenario.fitness.weights, np.float64),
        kappa=_scalar(scenario.fitness.kappa),
        center_of_mass=_vector(payload.center_of_mass),
        robots=_robots(scenario),
    )


def attachments_of(scenario: Statement) -> Float[np.ndarray, "cables xyz"]:
    """Lower cable ends relative to the load's centre, one row per cable (m)."""
    payload, cables = scenario.payload, len(scenario.robots)
    if payload.attachments == "hook":
        return np.tile([0.0, 0.0, payload.height / 2], (cables, 1))
    return np.array(payload.attachments, np.float64)


def warning_shape(scenario: Statement) -> Shape:
    """Payload and cables as planning sees them, before clearance.

    At a hook, and where movable ends keep it level, the load is as given. With separate
    attachments and fixed ends it turns, by up to the posture limit: load and cables then take the
    room of everything that such a turn can reach.
    """
    payload, limits = scenario.payload, scenario.limits
    if payload.attachments == "hook" or moving(scenario.drive):
        return Shape(payload.radius, payload.height / 2, limits.cable_radius)
    turn = math.radians(limits.posture_deg)
    farthest = max(math.hypot(*attachment) for attachment in payload.attachments)
    wide, high = warning_half_extents(payload.radius, payload.height, turn)
    return Shape(wide, high, limits.cable_radius + attachment_motion(farthest, turn))


def load_of(scenario: Statement) -> Polytope | None:
    """A load with faces, level and about its centre; None where it counts as a cylinder.

    It does where it is one, and where it turns, with separate attachments and fixed ends: then by
    the cylinder around it.
    """
    payload = scenario.payload
    level = payload.attachments == "hook" or moving(scenario.drive)
    return payload.body if level else None


def load_sums(scenario: Statement) -> list[Placed]:
    """What the centre of a load with faces keeps out of, per convex body of every obstacle."""
    load = load_of(scenario)
    if load is None:
        return []
    found = []
    for obstacle in scenario.obstacles:
        stated: tuple[Any, Any] = (obstacle, scenario.payload)  # frozen models: they have hashes
        files = (getattr(each, "file", None) for each in stated)
        written = tuple(os.stat(file).st_mtime_ns for file in files if file)
        bodies = _sums_about(*stated, written)
        found += [Placed(obstacle.center, 0.0, body) for body in bodies]
    return found


@functools.lru_cache(maxsize=1024)
def _sums_about(obstacle: Any, payload: Any, written: tuple[int, ...]) -> list[Polytope]:
    """Sums of an obstacle and a load about the obstacle's centre, while their files last."""
    del written
    away = tuple(-c for c in obstacle.center)
    return [body.placed(away, 0.0) for body in sums(obstacle, payload.body)]


def lowest(scenario: Statement) -> tuple[float, float, float]:
    """Lowest corner of where the payload's centre may be: in its workspace, and off the ground.

    In own units: a start or goal that is lower by no more than `TOUCH` is not below it.
    """
    x, y, z = scenario.workspace.lower
    if (ground := scenario.ground_height) is not None:
        off_ground = ground + warning_shape(scenario).half_height + scenario.limits.clearance
        ends = scenario.task.start[2], scenario.task.goal[2]
        z = max(z, min(off_ground, *(end for end in ends if end >= off_ground - 2 * TOUCH), np.inf))
    return x, y, z


def cast_world(world: Any, dtype) -> Any:
    """The same world, or other arrays of a scenario, with every floating leaf in `dtype`."""

    def cast(leaf):
        leaf = jnp.asarray(leaf) if isinstance(leaf, jax.Array) else np.asarray(leaf)
        return jnp.asarray(leaf, dtype) if jnp.issubdtype(leaf.dtype, jnp.floating) else leaf

    return jax.tree.map(cast, world)


def _limits(limits) -> Limits:
    low, high = limits.tension
    shortest, longest = limits.cable_length
    return Limits(
        tension_low=_scalar(low),
        tension_high=_scalar(high),
        length_low=_scalar(shortest),
        length_high=_scalar(longest),
        stability=_scalar(limits.stability),
        posture=_scalar(math.radians(limits.posture_deg)),
        separation=_scalar(limits.separation),
    )


def _robots(scenario: Statement) -> Robots:
    robots, limits = scenario.robots, scenario.limits.joint_limits_deg
    ranges = np.tile([-np.inf, np.inf], (len(robots), 3, 1))
    if limits is not None:
        ranges = np.broadcast_to(np.deg2rad(np.array(limits)), ranges.shape)
    return Robots(
        np.array([robot.base for robot in robots], np.float64),
        np.array([robot.links for robot in robots], np.float64),
        np.array([[robot.column_radius, *[robot.link_radius] * 2] for robot in robots]),
        np.ascontiguousarray(ranges[..., 0]),
        np.ascontiguousarray(ranges[..., 1]),
    )


def _vector(rows) -> Vec3:
    """(…, 3) numbers → Vec3 of float64 host arrays."""
    columns = np.moveaxis(np.asarray(rows, np.float64), -1, 0).copy()
    return Vec3(*(np.asarray(column) for column in columns))


def _scalar(value: float) -> np.ndarray:
    """A number as a leaf that stacks and casts like all others."""
    return np.array(value, np.float64)


def _packed(scenario: Statement, counts: Sequence[int]) -> Obstacles:
    rows = _by_kind(scenario)
    plain = {kind: np.array(rows[kind]) for kind in _PLAIN}
    return pack(**plain, counts=counts, hulls=rows["hulls"])


_PLAIN = "boxes", "cylinders", "spheres"


def _by_kind(scenario: Statement) -> dict[str, list]:
    """Rows of every kind as `pack` wants them; a mesh counts as what stands for it."""
    rows: dict[str, list] = {kind: [] for kind in (*_PLAIN, "hulls")}
    for obstacle in scenario.obstacles:
        center = obstacle.center
        match obstacle.kind:
            case "mesh" if obstacle.shape != "box":
                yaw = math.radians(obstacle.yaw_deg)
                rows["hulls"] += [Placed(center, yaw, each) for each in obstacle.bodies]
            case "box" | "mesh":
                half = [side / 2 for side in obstacle.size]
                rows["boxes"].append([*center, *half, np.deg2rad(obstacle.yaw_deg)])
            case "cylinder":
                rows["cylinders"].append([*center, obstacle.radius, obstacle.height / 2])
            case "sphere":
                rows["spheres"].append([*center, obstacle.radius])
            case _:
                raise ValueError(f"no arrays for an obstacle of kind {obstacle.kind!r}")
    return rows
