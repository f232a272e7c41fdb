"""Random scenes for the tests: any kind of obstacle anywhere, any number of robots."""

import functools

import numpy as np

import jaxsusp as js
from jaxsusp.scenario.models import Box, Cylinder, Robot, Sphere


@functools.cache
def frame() -> js.Scenario:
    """What all scenes share: loading it checks it, which takes longer than a scene."""
    return js.load_scenario("scenario-1")


def anywhere(random: np.random.Generator, count: int, robots: int) -> js.Scenario:
    """A scene that need not be admissible: obstacles overlap, touch or leave the workspace."""
    angles = np.pi / 2 + 2 * np.pi * np.arange(robots) / robots
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    heights = random.uniform(6.0, 8.0, robots)
    held = [
        Robot(base=(5 * x, 5 * y, 0.0), links=(4.0, 3.0, 2.0), end=(6 * x, 6 * y, z))
        for (x, y), z in zip(ring.tolist(), heights.tolist(), strict=True)
    ]
    # Checks nothing: what these scenes are for is what no check has looked at.
    return frame().model_copy(
        update={"robots": tuple(held), "obstacles": tuple(obstacles(random, count))}
    )


def obstacles(random: np.random.Generator, count: int):
    """Boxes with yaw, cylinders and spheres, some exactly on the border of the workspace."""
    for _ in range(count):
        center = random.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 4.0])
        if random.random() < 0.2:
            center[random.integers(2)] = random.choice([-3.5, 3.5])
        center = tuple(center.tolist())
        size = random.uniform(0.05, 1.5, 3).tolist()
        match random.integers(3):
            case 0:
                yaw = random.uniform(0, 360)
                yield Box(center=center, size=tuple(size), yaw_deg=float(yaw))
            case 1:
                yield Cylinder(center=center, radius=size[0] / 2, height=size[1])
            case _:
                yield Sphere(center=center, radius=size[0] / 2)
