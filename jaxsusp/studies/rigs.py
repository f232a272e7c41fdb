"""Robots and loads of random scenes: the benchmark's, or drawn, in any size and place."""

from typing import Any, NamedTuple

import numpy as np

from jaxsusp.scenario.ownunits import UNCHANGED, Frame, restated
from jaxsusp.scenario.scenario import Scenario, load_scenario

RIGS = ("benchmark", "any")

LARGEST = 20.0
"""Drawn rigs are at most so many times as large as the benchmark's, or as small."""

FARTHEST = 5e6
"""m from the world's origin; most drawn rigs are nearer."""

DRIVES = ("cable", "cable", "cable", "end", "base", "hybrid")
"""Drive modes, every one as often as it is here."""

SEPARATE = 0.15
"""Share of the rigs with three robots and still ends whose load has separate attachments."""


MOST_ROBOTS = 12
"""On the benchmark's ring; the columns of as many stand 2.6 m apart."""


def benchmark_rig(robots: int | None = None) -> dict[str, Any]:
    """The benchmark's robots, load and limits, as the tables of a scenario.

    Args:
        robots: how many, evenly on the benchmark's ring; its first robot stays where it is.
            Default and 3: the benchmark's own.
    """
    rig = load_scenario("scenario-1").model_dump()
    if robots is not None and robots != len(rig["robots"]):
        first, whole = rig["robots"][0], 2 * np.pi
        rig["robots"] = [_turned(first, whole * k / robots) for k in range(robots)]
    return rig


def _turned(robot: dict[str, Any], angle: float) -> dict[str, Any]:
    """A robot about the vertical through the origin, to the micrometre."""
    c, s = np.cos(angle), np.sin(angle)

    def turned(place):
        x, y, z = place
        return [round(float(c * x - s * y), 6), round(float(s * x + c * y), 6), z]

    return robot | {"base": turned(robot["base"]), "end": turned(robot["end"])}


class Kind(NamedTuple):
    """What scenes of one compiled program have in common."""

    robots: int
    drive: str
    hook: bool


def drawn_kind(random: np.random.Generator, robots: int | None = None) -> Kind:
    """Three to six robots; only three move their ends, or carry separate attachments.

    Args:
        random: what draws.
        robots: how many, whatever is drawn.
    """
    count = int(random.choice([3, 3, 3, 4, 5, 6]))
    count = count if robots is None else robots
    drive = str(random.choice(DRIVES)) if count == 3 else "cable"
    return Kind(count, drive, count > 3 or drive != "cable" or random.random() >= SEPARATE)


def drawn_rig(random: np.random.Generator, kind: Kind) -> tuple[dict[str, Any], Frame]:
    """Unequal robots about a load, in about own units; and their size and place."""
    rig, count = benchmark_rig(), kind.robots
    rig["drive"] = kind.drive
    rig["robots"] = [_robot(random, 2 * np.pi * k / count, np.pi / count) for k in range(count)]
    if not kind.hook:
        height = rig["payload"]["height"] / 2
        places = ((np.cos(a), np.sin(a)) for a in (_heading(each) for each in rig["robots"]))
        rig["payload"]["attachments"] = [[0.1 * x, 0.1 * y, height] for x, y in places]
    rig["task"]["duration"] = random.uniform(30, 60)
    size = LARGEST ** random.uniform(-1, 1)
    mass = size**3 * 10 ** random.uniform(-0.5, 0.5)
    angle, far = random.uniform(0, 2 * np.pi), FARTHEST ** random.uniform(0, 1)
    place = far * np.cos(angle), far * np.sin(angle), random.uniform(-100, 100)
    return rig, Frame(size, mass, place)


def _robot(random: np.random.Generator, angle: float, half: float) -> dict[str, Any]:
    """A robot that stands about there, and holds its end outside of where the load goes."""
    angle += random.uniform(-0.3, 0.3) * half
    out = np.array([np.cos(angle), np.sin(angle)])
    base, end = (random.uniform(*near) * out for near in ((4.6, 5.4), (5.7, 6.3)))
    links = [random.uniform(*about) for about in ((3.7, 4.3), (2.7, 3.3), (1.9, 2.3))]
    rise = random.uniform(2.5, 3.5)
    return {
        "base": [*base, random.uniform(-0.2, 0.2)],
        "links": links,
        "end": [*end, links[0] + rise],
        "link_radius": 0.08,
        "column_radius": 0.12,
    }


def _heading(robot: dict[str, Any]) -> float:
    x, y, _ = robot["end"]
    return float(np.arctan2(y, x))


def elsewhere(scenario: Scenario, frame: Frame) -> Scenario:
    """A scene in another size and place; the very same one where the frame changes nothing."""
    if frame == UNCHANGED:
        return scenario
    return Scenario.model_validate(restated(scenario, frame).model_dump())
