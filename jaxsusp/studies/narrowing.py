"""Scenes that are as narrow as asked, between their ends: obstacles grow until they are."""

from collections.abc import Callable
from itertools import takewhile

import numpy as np
from pydantic import ValidationError

from jaxsusp.errors import InputError
from jaxsusp.freespace.cells.forbidden import forbidden_of
from jaxsusp.freespace.cells.passage import passage_width
from jaxsusp.scenario.models import Box, Cylinder, Obstacle, Sphere
from jaxsusp.scenario.scenario import Scenario

LARGEST = 10.0
"""Times as large as it was drawn an obstacle may become."""

ENDS = 0.75
"""Room of start and goal over the greatest width asked for; half of it would be as narrow."""

HEADROOM = 0.2
"""m between the higher end of the task and the top of the workspace: no way above everything."""

_STEPS = np.geomspace(1.0, LARGEST, 9)[1:]  # sizes at which it is seen whether the ends allow it
_ROUNDS = 6  # of halving the range of sizes


def leaving(scenario: Scenario, room: float) -> Callable[[Obstacle], bool]:
    """Whether an obstacle alone leaves load and cables so much room (m) at start and goal."""
    ends = np.array([scenario.task.start, scenario.task.goal])

    def leaves(obstacle: Obstacle) -> bool:
        try:
            return bool(forbidden_of(_holding(scenario, [obstacle])).least(ends).min() > room)
        except (ValidationError, InputError):  # a robot or an end of a cable stands in it
            return False

    return leaves


def narrowed(scenario: Scenario, passage: tuple[float, float]) -> Scenario | None:
    """The scene with all obstacles grown alike, each as far as start and goal allow it to.

    The widest way narrows steadily as obstacles grow, so that halving finds a width in the range.
    What is narrow lies between start and goal, which have more room (see `ENDS`): a width that
    one of them has because an obstacle was drawn beside it makes no task harder.

    Args:
        scenario: what was drawn, with that room at its ends (see `leaving`).
        passage: least and greatest width (m), see `jaxsusp.passage`.

    Returns:
        The scene, or None where no size that was tried is in the range: most often there is a way
        around everything.
    """
    leaves = leaving(scenario, ENDS * passage[1])
    most = [_most(obstacle, leaves) for obstacle in scenario.obstacles]
    small, large = 1.0, LARGEST
    for factor in (large, small, *[None] * _ROUNDS):
        factor = (small * large) ** 0.5 if factor is None else factor
        grown = _grown(scenario, np.minimum(factor, most))
        width = passage_width(grown)
        if passage[0] <= width <= passage[1]:
            return grown
        if width > passage[1]:
            small = factor
        else:
            large = factor
        if small >= large:  # too wide at most, or too narrow as drawn
            return None
    return None


def _most(obstacle: Obstacle, leaves: Callable[[Obstacle], bool]) -> float:
    """Times as large as one may become."""
    return max((1.0, *takewhile(lambda factor: leaves(larger(obstacle, factor)), _STEPS)))


def _grown(scenario: Scenario, factors: np.ndarray) -> Scenario:
    sizes = zip(scenario.obstacles, factors.tolist(), strict=True)
    return _holding(scenario, [larger(obstacle, factor) for obstacle, factor in sizes])


def _holding(scenario: Scenario, obstacles: list[Obstacle]) -> Scenario:
    """The scene with other obstacles."""
    rows = [obstacle.model_dump() for obstacle in obstacles]
    return Scenario.model_validate(scenario.model_dump() | {"obstacles": rows})


def larger(obstacle: Obstacle, factor: float) -> Obstacle:
    """The obstacle, so many times as large about its centre, but not into the ground."""
    match obstacle:
        case Sphere(radius=radius):
            return obstacle.model_copy(update={"radius": round(factor * radius, 3)})
        case Box(size=(width, depth, height)):
            center, height = _raised(obstacle.center, height, factor)
            size = (round(factor * width, 3), round(factor * depth, 3), height)
            return obstacle.model_copy(update={"center": center, "size": size})
        case Cylinder(radius=radius, height=height):
            center, height = _raised(obstacle.center, height, factor)
            changed = {"center": center, "radius": round(factor * radius, 3), "height": height}
            return obstacle.model_copy(update=changed)
    return obstacle


def _raised(
    center: tuple[float, float, float], height: float, factor: float
) -> tuple[tuple[float, float, float], float]:
    """Centre and height (m) of what grows upwards, and downwards no further than to the ground."""
    x, y, z = center
    bottom = min(z - height / 2, max(0.0, z - factor * height / 2))
    top = z + factor * height / 2
    return (x, y, round((bottom + top) / 2, 3)), round(top - bottom, 3)
