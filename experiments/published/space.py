"""Free space in the plane: polygons, their ellipses, and a trajectory through them."""

import numpy as np

import jaxsusp as js
from experiments.artefacts import Artefacts
from experiments.contents import Page
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.rounding import rounded_ways
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.report.freeplane import plane
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.toml import dumps

TITLE = "Free space in the plane"
PRINTED = "Fig. 5"
DIFFERS = (
    "Not our scenario 1 itself: its obstacles are walls and pillars that cannot be passed above, "
    "start and goal are other ones; there are no cables, and the load "
    "keeps its height. Colours are as the paper describes them; what the load's "
    "radius and clearance add to obstacles is grey."
)
MADE = READ = ()
MINUTES = 0.0
FULL = MINIATURE = None
SCENARIO = "scenario-1"
HEIGHT, THICK, TALL = 2.0, 0.4, 0.6
"""m: middle and thickness of the slab in which the load moves, and height of the obstacles."""
START, GOAL = (-1.6, 2.2, HEIGHT), (1.6, -2.2, HEIGHT)


def flat() -> Scenario:
    """The scenario in a slab: every obstacle goes through it from below to above."""
    known = js.load_scenario(SCENARIO)
    stated = known.model_dump(exclude_none=True)
    for each in stated["obstacles"]:
        each["center"] = (*each["center"][:2], HEIGHT)
        if each["kind"] == "box":
            each["size"] = (*each["size"][:2], TALL)
        else:  # a ball becomes a pillar
            each |= {"kind": "cylinder", "height": TALL}
    stated |= {"name": "plane", "drive": "end", "ground": "none"}  # no shadows of cables
    for side, sign in (("lower", -1), ("upper", 1)):
        level = getattr(known.workspace, side)[:2]
        stated["workspace"][side] = (*level, HEIGHT + sign * THICK / 2)
    stated["task"] |= {"start": START, "goal": GOAL}
    return Scenario.from_toml(dumps(stated), "plane.toml", task_checked=False)


def draw(artefacts: Artefacts) -> Page:
    """One picture."""
    scenario = flat()
    space = free_space(scenario)
    way = next(iter(rounded_ways(space, 40)), np.empty((0, 3)))
    figure = plane(scenario, space, way, HEIGHT)
    figure.set_label(
        "Obstacles (black) and the margin that the load's radius and clearance add to them (grey), "
        "convex polygons of the free space (ochre; those on the route filled), the largest ellipse "
        "in each (blue), start and goal (red), intermediate targets (green), and the "
        "trajectory (magenta)."
    )
    return Page({"space": figure}, findings=findings(space, way))


def findings(space: FreeSpace, way: np.ndarray) -> str:
    """How many polygons cover how much, and how long the ways are."""
    long = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
    return (
        f"{len(space.d)} polygons cover {100 * space.coverage:.1f} % of the free space; the route "
        f"goes through {len(space.route)} of them. The shortest polyline is {space.length:.2f} m "
        f"long, the trajectory along it {long:.2f} m."
    )
