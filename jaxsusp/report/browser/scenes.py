"""What stands still on the page: a scenario in its own units, with the layers of its free space.

WebGL computes in single precision, which is coarser than a cable in survey coordinates. So places
and lengths are those of `scenario.own`; `frame` makes metres in the world of them, for words.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from jaxsusp.errors import InputError
from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.polyhedra import Body, HalfSpaces
from jaxsusp.freespace.space import FreeSpace
from jaxsusp.report.browser.layers import body_layers, region_layer, triangles_of
from jaxsusp.report.drawing.room import ground_of
from jaxsusp.report.drawing.scales import anchor, decimals
from jaxsusp.report.drawing.style import CABLES
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of

NEAR = 1e-6
"""Own units of length by which bodies of one task may differ."""


def scene_of(
    scenario: Scenario, space: FreeSpace | None = None, shadows: bool = True
) -> dict[str, Any]:
    """A scenario as the page draws it.

    Args:
        scenario: in its own numbers; admissible or not.
        space: its free space; None leaves the regions out.
        shadows: whether to add where the load or a cable would touch an obstacle.
    """
    own = scenario.own
    limits, payload = own.limits, own.payload
    found = {
        "name": scenario.name,
        "frame": _frame(scenario.units, (scenario.workspace.lower, scenario.workspace.upper)),
        "workspace": [own.workspace.lower, own.workspace.upper],
        "ground": own.ground_height,
        "floor": ground_of(own),
        "start": own.task.start,
        "goal": own.task.goal,
        "payload": {
            "radius": payload.radius,
            "height": payload.height,
            "triangles": None if payload.body is None else triangles_of(payload.body.corners),
            "attachments": attachments_of(own),
        },
        "cableRadius": limits.cable_radius,
        "clearance": limits.clearance,
        "tension": scenario.limits.tension,
        "colors": [CABLES[k % len(CABLES)] for k in range(len(own.robots))],
        "robots": [
            {"column": robot.column_radius, "link": robot.link_radius} for robot in own.robots
        ],
        "obstacles": [
            row
            for i, each in enumerate(own.obstacles, start=1)
            for row in _obstacle(i, each, limits.clearance)
        ],
        "notes": [],
        "regions": None,
        "bodies": {},
    }
    if space is not None:
        found["regions"] = region_layer(space.own)
    if shadows:
        try:
            found["bodies"] = body_layers(bodies_of(own), _room(own))
        except InputError as error:
            found["notes"].append(f"No shadows of cables: {error}")
    return found


def scene_of_space(name: str, space: FreeSpace) -> dict[str, Any]:
    """A free space without its scenario: regions, and what they keep clear of."""
    own = space.own
    reach = np.linalg.norm(own.C, axis=2)  # of every ellipsoid along the axes
    lower, upper = (own.d - reach).min(axis=0), (own.d + reach).max(axis=0)
    ends = own.polyline[[0, -1]] if own.connected else [None, None]
    return {
        "name": name,
        "frame": _frame(space.frame, space.frame.place(np.array([lower, upper]))),
        "workspace": [lower, upper],
        "ground": None,
        "floor": lower[2],
        "start": ends[0],
        "goal": ends[1],
        "payload": None,
        "obstacles": [],
        "robots": [],
        "colors": [],
        "notes": [
            "This file holds regions and what they keep clear of, no robots and no obstacles: "
            "give its scenario before it to see them as well."
        ],
        "regions": region_layer(own),
        "bodies": body_layers(_bodies(own), HalfSpaces.box(lower, upper)),
    }


def _bodies(space: FreeSpace) -> list[Body]:
    """What a free space keeps clear of, by name; their corners are not kept in files."""
    pairs = zip(space.body_names, space.bodies, strict=True)
    return [Body(name, np.empty((0, 3)), faces) for name, faces in pairs]


def _frame(units: Frame, box: Any) -> dict[str, Any]:
    """How places in own units become metres, and what numbers count from where they are long."""
    return {
        "length": units.length,
        "origin": units.origin,
        "anchor": [anchor(low, high) for low, high in zip(*box, strict=True)],
        "decimals": decimals(units.length),
    }


def _room(own: Scenario) -> HalfSpaces:
    """The workspace down to the floor, in which bodies are drawn."""
    (x, y, z), upper = own.workspace.lower, np.array(own.workspace.upper)
    return HalfSpaces.box(np.array([x, y, min(z, ground_of(own))]), upper)


def _obstacle(number: int, obstacle: Any, clear: float) -> Iterator[dict[str, Any]]:
    """Kind and size, in own units; a mesh is drawn as what stands for it, a row per body."""
    found = {
        "name": obstacle.name or f"obstacle {number}",
        "kind": obstacle.kind,
        "center": obstacle.center,
    }
    match obstacle.kind:
        case "mesh" if obstacle.shape != "box":
            stands = "as its hull" if obstacle.shape == "hull" else "a piece of it"
            for body in obstacle.bodies:
                shape = body.placed((0.0, 0.0, 0.0), obstacle.yaw_deg)
                yield {
                    **found, "kind": "hull", "stands": stands,
                    "triangles": triangles_of(shape.corners),
                    "wide": triangles_of(shape.larger(clear).corners),
                }  # fmt: skip
        case "box" | "mesh":
            yield {**found, "size": obstacle.size, "yaw": np.deg2rad(obstacle.yaw_deg)}
        case "cylinder":
            yield {**found, "radius": obstacle.radius, "height": obstacle.height}
        case "sphere":
            yield {**found, "radius": obstacle.radius}
        case _:
            raise ValueError(f"cannot show an obstacle of kind {obstacle.kind!r}")


def same_task(space: FreeSpace, scenario: Statement) -> bool:
    """Whether a free space is of a scenario, by the names and the faces of what it avoids."""
    if not isinstance(scenario, Scenario) or space.frame != scenario.units:
        return False
    try:
        bodies = bodies_of(scenario.own)
    except InputError:
        return False
    if tuple(body.name for body in bodies) != space.body_names:
        return False
    # A body that start or goal stands in is cut open; most of its corners are there all the same.
    return all(
        np.median(np.abs(known.excess(body.corners))) < NEAR
        for known, body in zip(space.own.bodies, bodies, strict=True)
    )
