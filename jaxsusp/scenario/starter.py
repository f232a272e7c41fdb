"""A first scenario of one's own: robots on a ring, a load between them, one obstacle of a kind."""

import math

from jaxsusp.errors import require_count
from jaxsusp.scenario.builtin import FEWEST, MOST
from jaxsusp.scenario.commented import plain_numbers
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import Frame, restated
from jaxsusp.scenario.scenario import Scenario

NEAR, FAR, HIGH = 5.0, 6.0, 7.0
"""m: how far bases and ends are from the middle, and how high ends are; the benchmark's."""


def starter(name: str, robots: int = 3) -> Scenario:
    """A task of the benchmark's size, whose straight way a wall blocks.

    Args:
        name: of the scenario.
        robots: so many, evenly on a ring, the first to the north.

    Raises:
        InputError: too few robots, or too many for a ring.
    """
    require_count("robots", robots, FEWEST, MOST)
    angles = [math.pi / 2 + 2 * math.pi * k / robots for k in range(robots)]
    ring = [(round(math.cos(angle), 4), round(math.sin(angle), 4)) for angle in angles]
    document = {
        "name": name,
        "payload": {"mass": 10.0, "radius": 0.1, "height": 0.3},
        "task": {"start": [0.0, 2.0, 1.0], "goal": [0.0, -2.0, 3.0]},
        "robots": [
            {
                "base": [NEAR * x, NEAR * y, 0.0],
                "links": [4.0, 3.0, 2.0],
                "end": [FAR * x, FAR * y, HIGH],
            }
            for x, y in ring
        ],
        "obstacles": [
            {"name": "wall", "kind": "box", "center": [0.0, 0.5, 0.8], "size": [1.4, 0.4, 1.6],
             "yaw_deg": 20.0},
            {"name": "pillar", "kind": "cylinder", "center": [-1.2, -0.8, 1.4], "radius": 0.2,
             "height": 2.8},
            {"name": "hanging ball", "kind": "sphere", "center": [1.0, -0.7, 2.4], "radius": 0.35},
        ],
    }  # fmt: skip
    return Scenario.model_validate(plain_numbers(document))


def resized(scenario: Statement, name: str, size: float, mass: float) -> Scenario:
    """The same task under another name, so many times as large and as heavy.

    Lengths grow with the size, durations with its square root, tensions with the mass: what is a
    way, and what a tension within its limits, stays so.

    Raises:
        pydantic.ValidationError: numbers become too large or too small for a scenario.
    """
    if (size, mass) == (1.0, 1.0):
        return Scenario.model_validate({**scenario.model_dump(), "name": name})
    found = restated(scenario, Frame(size, mass))
    return Scenario.model_validate({**plain_numbers(found.model_dump()), "name": name})
