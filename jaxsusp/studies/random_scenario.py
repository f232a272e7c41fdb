"""Fresh planning tasks of the benchmark's kind: blocked, and proved to be solvable."""

import functools
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from pydantic import ValidationError

from jaxsusp._types import Array
from jaxsusp.errors import InputError, require, require_count, require_known, require_seed
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.polyhedra import Point, Points
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem.fitness import position_terms
from jaxsusp.scenario.ownunits import UNCHANGED
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import World, build_world
from jaxsusp.studies.clutter import place_obstacles
from jaxsusp.studies.narrowing import ENDS, HEADROOM, POSTS, leaving, narrowed, wall
from jaxsusp.studies.rigs import MOST_ROBOTS, RIGS, benchmark_rig, drawn_kind, drawn_rig, elsewhere
from jaxsusp.vec3 import Vec3

MOST = 1000
"""Greatest number of obstacles."""

MOVED = 0.35
"""Share of the benchmark's distances that a load goes whose ends move along with it."""

SAMPLES = 4000
"""Samples of the trajectories that are proved or refused."""

ATTEMPTS = 60
"""Scenes that are drawn before giving up."""

PATIENCE = 10
"""Times as many are drawn where a width is asked for: the wrong ones are told at once."""


def random_scenario(
    seed: int,
    obstacles: int = 10,
    rig: str = RIGS[0],
    robots: int | None = None,
    passage: tuple[float, float] | None = None,
) -> Scenario:
    """Draw a scene with the benchmark's robots, load and limits, and its kinds of obstacles.

    With `rig="any"` the robots are drawn as well: three to six unequal ones, the drive mode, the
    attachments, the size (1:20 to 20:1), the mass, and the place (to 5000 km away).

    The straight line from start to goal is blocked. That the task can be solved is proved: a route
    through convex regions of the free space exists, or the widest way where a passage is asked
    for, and a trajectory along it has no collision (n_p = 0) and no violated limit (n_g = 0).

    Args:
        seed: the same seed and number give the same scene.
        obstacles: how many, 1 to 1000; the more, the smaller.
        rig: "benchmark" or "any".
        robots: how many, 3 to 12, evenly on the benchmark's ring; default three of the benchmark,
            and of "any" as many as are drawn.
        passage: least and greatest width of the narrowest place of the widest way, see
            `jaxsusp.passage` (m; of "any" in its own units); default whatever it comes to, which
            is most often what an obstacle beside start or goal leaves. Where it is given, the
            first two obstacles are a wall between them with a gap of that width, and the top of
            the workspace comes down to the wall's.

    Raises:
        InputError: bad numbers, an unknown rig, or no such scene within 60 attempts, 600 where a
            width is asked for.
    """
    require_seed(seed)
    require_count("obstacles", obstacles, most=MOST)
    require_known("rig", rig, RIGS)
    if robots is not None:
        require_count("robots", robots, least=3, most=MOST_ROBOTS)
    if passage is not None:
        passage = _range_of(passage)
        require(
            obstacles >= POSTS,
            f"obstacles = {obstacles}: a passage is the gap of a wall of {POSTS}; give more",
        )
    kind = drawn_kind(np.random.default_rng([seed, obstacles]), robots) if rig == "any" else None
    name, attempts = _name(seed, obstacles, rig, robots, passage), ATTEMPTS
    if passage is not None:
        attempts *= PATIENCE
    for attempt in range(attempts):
        random = np.random.default_rng([seed, obstacles, attempt])
        empty, frame = drawn_rig(random, kind) if kind else (benchmark_rig(robots), UNCHANGED)
        scenario = _draw(random, name, obstacles, empty, passage)
        if scenario is None or not blocked(scenario):
            continue
        if passage is None:
            if solvable(scenario):
                return elsewhere(scenario, frame)
        elif found := narrowed(scenario, passage):
            scenario, ways = found
            if blocked(scenario) and passable(scenario, ways):  # the gap may have grown to the line
                return elsewhere(scenario, frame)
    wide = "" if passage is None else f" {passage[0]:g} to {passage[1]:g} m wide"
    raise InputError(
        f"obstacles = {obstacles}, seed = {seed}: no blocked and solvable scene{wide} in "
        f"{attempts} attempts; choose another seed{' or range of passage' if wide else ''}"
    )


def random_scenarios(
    count: int,
    told: Callable[[str, int], None] = lambda name, number: None,
    known: Mapping[str, Scenario] | None = None,
) -> tuple[Scenario, ...]:
    """Random scenes of rising difficulty: scene i is `random_scenario(i, 5 + i // 2)`.

    The first scenes are the same for every count, so that a longer series goes on where a shorter
    one ended. Fifty of them have 5 to 29 obstacles and take minutes to draw.

    Args:
        count: how many, 0 to 1992.
        told: called with the name and the number i of a scene before it is drawn.
        known: scenes by name that were drawn before, and are taken as they are.

    Raises:
        InputError: a bad count, or a scene that cannot be drawn (see `random_scenario`).
    """
    require_count("count", count, least=0, most=2 * (MOST - 4))
    scenes = []
    for i in range(count):
        obstacles = 5 + i // 2
        name = _name(i, obstacles)
        if known is None or name not in known:
            told(name, i)
            scenes.append(random_scenario(i, obstacles))
        else:
            scenes.append(known[name])
    return tuple(scenes)


def _name(
    seed: int,
    obstacles: int,
    rig: str = RIGS[0],
    robots: int | None = None,
    passage: tuple[float, float] | None = None,
) -> str:
    """What was asked for: "random-0-5", "random-0-5-robots-6-passage-0.1-0.2"."""
    name = f"{'random' if rig == RIGS[0] else rig}-{seed}-{obstacles}"
    name += "" if robots is None else f"-robots-{robots}"
    return name if passage is None else f"{name}-passage-{passage[0]:g}-{passage[1]:g}"


def _range_of(passage: Any) -> tuple[float, float]:
    """The range of widths that is asked for.

    Raises:
        InputError: not two numbers, or not those of a range.
    """
    try:
        if any(isinstance(each, str | bool) for each in passage):
            raise TypeError
        low, high = map(float, passage)
    except (TypeError, ValueError):
        raise InputError(
            f"passage = {passage!r}: give two numbers in m, as passage = (0.2, 0.4)"
        ) from None
    require(
        0 <= low < high < np.inf,
        f"passage = {passage}: give a least width of at least 0 m and a greatest above it",
    )
    return low, high


def blocked(scenario: Scenario) -> bool:
    """Whether the load or a cable meets an obstacle on the straight line from start to goal."""
    line = np.array([scenario.task.start, scenario.task.goal])
    return _faults(scenario, line)[0] > 0


def solvable(scenario: Scenario) -> bool:
    """Whether a route exists and a trajectory along it is without collision and violation.

    The trajectory goes along the route somewhere between the shortest polyline, which grazes
    corners, and the one by the centres of the crossings, which may hang too high for the tensions;
    in samples so fine that the collision count is hardly more cautious than need be.
    """
    try:
        space = free_space(scenario, coverage=0.1, routes=False, cache=False)
    except InputError:  # an end of a cable stands in a warning area
        return False
    if not space.connected:
        return False
    return passable(scenario, (space.polyline, space.centerline))


def passable(scenario: Scenario, ways: tuple[Points, Points]) -> bool:
    """Whether a way between two of as many corners is without collision and violation."""
    return any(_faults(scenario, way) == (0, 0) for way in _between_ways(*ways))


def _between_ways(short: Points, roomy: Points) -> Iterator[Points]:
    """The nearer to the second the more room there is, and the higher tensions may be."""
    return (short + share * (roomy - short) for share in (0.1, 0.3, 0.6, 1.0))


def _faults(scenario: Scenario, polyline: Points) -> tuple[int, int]:
    """(n_p, n_g) of a finely sampled polyline, in float64."""
    padded = len(scenario.obstacles)  # of every kind: one compiled program for all such scenes
    with jax.enable_x64(True):
        world = build_world(scenario, [padded] * 3)
        position = Vec3(*(jnp.asarray(c) for c in _sampled(polyline).T))
        collisions, violations = _count_faults(world, position, scenario.drive)
        return int(collisions), int(violations)


@functools.partial(jax.jit, static_argnums=2)
def _count_faults(world: World, position: Vec3, drive: str) -> tuple[Array, Array]:
    terms = position_terms(world, position, drive=drive)
    return terms.collisions, terms.violations


def _sampled(polyline: Points) -> Points:
    """Points along a polyline, evenly spaced on every segment."""
    knots = np.linspace(0, len(polyline) - 1, SAMPLES)
    return np.stack([np.interp(knots, np.arange(len(polyline)), c) for c in polyline.T], axis=1)


def _draw(
    random: np.random.Generator,
    name: str,
    count: int,
    empty: dict[str, Any],
    passage: tuple[float, float] | None,
) -> Scenario | None:
    """A scene whose obstacles leave start and goal clear; None where that did not work out."""
    empty = empty | {"name": name, "obstacles": []}
    wide = MOVED if moving(empty["drive"]) else 1.0
    start, goal = _ends_of_task(random, wide)
    empty["task"] |= {"start": start.tolist(), "goal": goal.tolist()}
    if passage is not None:
        x, y, _ = empty["workspace"]["upper"]
        top = round(float(max(start[2], goal[2])) + HEADROOM, 3)
        empty["workspace"] = empty["workspace"] | {"upper": [x, y, top]}
    try:
        frame = Scenario.model_validate(empty)
    except ValidationError:
        return None
    if passage is None:
        obstacles = place_obstacles(random, frame, count)
    else:
        leaves = leaving(frame, ENDS * passage[1])
        posts = wall(random, frame, sum(passage) / 2, wide)
        if not all(map(leaves, posts)):
            return None
        others = place_obstacles(random, frame, count - POSTS, leaves)
        obstacles = None if others is None else [*posts, *others]
    if obstacles is None:
        return None
    try:
        rows = [obstacle.model_dump() for obstacle in obstacles]
        return Scenario.model_validate(empty | {"obstacles": rows})
    except ValidationError:  # the exact tests see what a cloud of points does not
        return None


def _ends_of_task(random: np.random.Generator, wide: float) -> tuple[Point, Point]:
    """Start and goal on different sides of the workspace, or of a part of it, below the ends."""
    angle = random.uniform(0, 2 * np.pi)
    radius = random.uniform(1.5, 2.6, 2)
    height = random.uniform(0.8, 3.5, 2)
    height[1] = height[0] + wide * (height[1] - height[0])
    turn = random.uniform(0.7, 1.3) * np.pi
    return tuple(
        np.round([wide * r * np.cos(a), wide * r * np.sin(a), z], 2)
        for r, a, z in zip(radius, (angle, angle + turn), height, strict=True)
    )  # type: ignore[return-value]
