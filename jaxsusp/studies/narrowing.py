"""Scenes that are as narrow as asked, between their ends: a wall across the way with one gap."""

from collections.abc import Callable

import numpy as np
from pydantic import ValidationError

from jaxsusp.errors import InputError
from jaxsusp.freespace.cells.forbidden import forbidden_of
from jaxsusp.freespace.cells.passage import widest_way
from jaxsusp.freespace.polyhedra import Points
from jaxsusp.scenario.models import Box, Obstacle
from jaxsusp.scenario.scenario import Scenario

POSTS = 2
"""Obstacles that the wall consists of, one on either side of its gap; a scene's first ones."""

ENDS = 0.75
"""Room of start and goal over the greatest width asked for; half of it would be as narrow."""

HEADROOM = 0.2
"""m between the higher end of the task and the top of the workspace, and of the wall."""

_BESIDE = (0.6, 1.5)  # m from the straight line to the middle of the gap
_THICK = (0.2, 0.6)  # m
_ROUNDS = 6  # of widening the gap by what is missing


def wall(random: np.random.Generator, frame: Scenario, width: float, wide: float) -> list[Obstacle]:
    """Two upright boxes about the middle between start and goal, across the whole workspace.

    Args:
        random: what draws where the wall stands, how thick it is, and where its gap is.
        frame: the scene, with the top of its workspace `HEADROOM` above its ends.
        width: about what the gap is to leave the load (m).
        wide: share of the benchmark's distances that the load goes.
    """
    start, goal = np.array(frame.task.start), np.array(frame.task.goal)
    across = np.array([start[1] - goal[1], goal[0] - start[0]])
    across /= np.linalg.norm(across)
    beside = wide * random.uniform(*_BESIDE) * random.choice([-1, 1])
    middle = (start + random.uniform(0.4, 0.6) * (goal - start))[:2] + beside * across
    thick, top = wide * random.uniform(*_THICK), frame.workspace.upper[2]
    lower, upper = np.array(frame.workspace.lower), np.array(frame.workspace.upper)
    long = float(np.linalg.norm((upper - lower)[:2]))  # beyond the workspace from anywhere in it
    gap = 2 * (frame.payload.radius + frame.limits.clearance) + width
    posts = []
    for number, side in enumerate((-1, 1), 1):
        x, y = middle + side * (gap + long) / 2 * across
        posts.append(
            Box(
                name=f"wall {number}",
                center=(round(float(x), 3), round(float(y), 3), round(top / 2, 3)),
                size=(round(long, 3), round(thick, 3), top),
                yaw_deg=round(float(np.rad2deg(np.arctan2(across[1], across[0]))), 1),
            )
        )
    return posts


def leaving(scenario: Scenario, room: float) -> Callable[[Obstacle], bool]:
    """Whether an obstacle alone leaves load and cables so much room (m) at start and goal."""
    ends = np.array([scenario.task.start, scenario.task.goal])

    def leaves(obstacle: Obstacle) -> bool:
        try:
            return bool(forbidden_of(_holding(scenario, [obstacle])).least(ends).min() > room)
        except (ValidationError, InputError):  # a robot or an end of a cable stands in it
            return False

    return leaves


def narrowed(
    scenario: Scenario, passage: tuple[float, float]
) -> tuple[Scenario, tuple[Points, Points]] | None:
    """The scene with the gap of its wall as wide as the passage is to be, and ways through it.

    What is narrow lies between start and goal, which have more room (see `ENDS`): a width that
    one of them has because an obstacle was drawn beside it makes no task harder.

    Args:
        scenario: what was drawn, its first obstacles a wall.
        passage: least and greatest width (m), see `jaxsusp.passage`.

    Returns:
        Both, or None where the gap does not decide: what else stands there leaves less.
    """
    wanted = sum(passage) / 2
    for _ in range(_ROUNDS):
        try:
            width, ways = widest_way(scenario)
        except InputError:
            return None
        if passage[0] <= width <= passage[1]:
            return scenario, ways
        scenario = _opened(scenario, wanted - width)
    return None


def _opened(scenario: Scenario, more: float) -> Scenario:
    """The posts of the wall moved apart (m), or towards each other."""
    one, other = scenario.obstacles[:POSTS]
    apart = np.subtract(other.center, one.center)
    step = more / 2 * apart / np.linalg.norm(apart)
    moved = [
        post.model_copy(update={"center": tuple(np.round(post.center + move, 3).tolist())})
        for post, move in ((one, -step), (other, step))
    ]
    return _holding(scenario, [*moved, *scenario.obstacles[POSTS:]])


def _holding(scenario: Scenario, obstacles: list[Obstacle]) -> Scenario:
    """The scene with other obstacles."""
    rows = [obstacle.model_dump() for obstacle in obstacles]
    return Scenario.model_validate(scenario.model_dump() | {"obstacles": rows})
