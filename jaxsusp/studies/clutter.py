"""Obstacles of random scenes: boxes, pillars and balls, in a share of the room and no more."""

from collections.abc import Callable

import numpy as np

from jaxsusp.errors import InputError
from jaxsusp.freespace.bodies import domain_of, obstacle_bodies
from jaxsusp.freespace.iris import Bodies
from jaxsusp.freespace.polyhedra import Point, Points
from jaxsusp.scenario.models import Box, Cylinder, Obstacle, Sphere
from jaxsusp.scenario.scenario import Scenario

FILLED = 0.4
"""Share of the workspace that obstacles and their shadows may take; each takes its part of it."""

CLEAR = 0.05
"""m that start and goal stay away from what load or cables would touch."""

_CLOUD = 4000  # positions at which the share that is taken is measured


def place_obstacles(
    random: np.random.Generator,
    frame: Scenario,
    count: int,
    leaves: Callable[[Obstacle], bool] = lambda obstacle: True,
) -> list[Obstacle] | None:
    """Obstacles one by one: too big a one is drawn again, smaller, and so are those after it.

    Args:
        random: what draws.
        frame: the scene without them.
        count: how many.
        leaves: whether an obstacle leaves start and goal the room that they are to have besides.

    Returns:
        The obstacles; None where that did not work out.
    """
    domain = domain_of(frame)
    frame = frame.model_copy(update={"drive": "cable"})  # moving cables begin clear as well
    cloud = random.uniform(frame.workspace.lower, frame.workspace.upper, (_CLOUD, 3))
    cloud = cloud[domain.excess(cloud) < 0]
    ends = np.array([frame.task.start, frame.task.goal])
    taken, placed = np.zeros(len(cloud), bool), []
    scale = min(1.0, 2.2 / max(count, 1) ** (1 / 3))
    for number in range(count):
        for _ in range(30):
            place = _between(random, ends) if number == 0 else _anywhere(random, frame, scale)
            obstacle = _obstacle(random, f"{number + 1}", place, scale)
            scale *= 0.85
            bodies = _bodies(frame, obstacle)
            if bodies is None or _near(bodies, ends) or not leaves(obstacle):
                continue
            now = taken | bodies.holding(cloud)
            if now.mean() <= FILLED * (number + 4) / count or number == 0:
                placed.append(obstacle)
                taken, scale = now, min(1.0, scale / 0.85 * 1.05)
                break
        else:
            return None
    return placed


def _bodies(frame: Scenario, obstacle: Obstacle) -> Bodies | None:
    """What one obstacle keeps the load out of; None where it blocks an end of a cable."""
    try:
        return Bodies(obstacle_bodies(frame, obstacle, obstacle.name))
    except InputError:
        return None


def _near(bodies: Bodies, points: Points) -> bool:
    return any((body.faces.excess(points) <= CLEAR).any() for body in bodies.bodies)


def _between(random: np.random.Generator, ends: Points) -> Point:
    """A place about the middle of the straight line, for the obstacle that blocks it."""
    return ends[0] + random.uniform(0.35, 0.65) * (ends[1] - ends[0])


def _anywhere(random: np.random.Generator, frame: Scenario, scale: float) -> Point:
    """A place in the workspace, the lower the smaller things are: low ones cast short shadows."""
    lower, upper = np.array(frame.workspace.lower), np.array(frame.workspace.upper)
    return lower + random.uniform(size=3) * [1, 1, scale] * (upper - lower)


def _obstacle(random: np.random.Generator, number: str, place: Point, scale: float) -> Obstacle:
    """A box, pillar or ball that reaches up to a place; most stand on the ground, some hang."""
    width, depth, height = scale * random.uniform([0.4, 0.4, 0.6], [1.4, 1.2, 4.0]) + 0.02
    top = place[2] + scale * random.uniform(0.0, 0.4)
    if random.random() < 0.7:
        height = top  # from the ground
    center = _rounded([place[0], place[1], top - height / 2])
    match random.choice(["box", "box", "pillar", "ball"]):
        case "box":
            size, yaw = _rounded([width, depth, height]), round(random.uniform(0, 180), 1)
            return Box(name=f"box {number}", center=center, size=size, yaw_deg=yaw)
        case "pillar":
            radius, high = _rounded([width / 4, height, 0])[:2]
            return Cylinder(name=f"pillar {number}", center=center, radius=radius, height=high)
        case _:
            return Sphere(name=f"ball {number}", center=_rounded(place), radius=round(width / 3, 3))


def _rounded(numbers) -> tuple[float, float, float]:
    """As a person would write it: millimetres."""
    x, y, z = (round(float(number), 3) for number in numbers)
    return x, y, z
