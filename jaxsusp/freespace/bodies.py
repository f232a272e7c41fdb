"""What the load must avoid, as convex bodies in the space of its positions.

Two kinds of body: an obstacle inflated by the load, and the shadow that an obstacle casts from a
cable's upper end: where the load hangs in it, that cable touches the obstacle. A position outside
all bodies is clear for the load and for every cable.

Boxes are exact; hulls of meshes have their faces moved out by what load or cable reach, as in the
fitness. Round bodies are circumscribed by polyhedra, so that free stays conservative: a
cylinder by a prism of `SIDES` sides, up to 0.9 % of its inflated radius outside the circle, and a
sphere (for cables) by the polyhedron of 162 tangent planes, up to 1.9 % of its radius outside. Of
more than `FEW` obstacles, which are small, half as many sides (3.5 %) and 42 planes (8 %) serve.
"""

import functools
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection

from jaxsusp.freespace.orientation import NO_TURN, Turn
from jaxsusp.freespace.polyhedra import Body, HalfSpaces, Points, corners_of
from jaxsusp.freespace.shadows import shadows
from jaxsusp.geometry.collisions import SINGLE_PRECISION_MARGIN
from jaxsusp.geometry.polytopes import Polytope
from jaxsusp.geometry.sums import sums
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.messages import numbered
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import load_of, lowest, warning_shape

SIDES = 24
"""Sides of the prism around a cylinder."""

FEW = 100
"""Obstacles up to which round ones are taken as closely as that."""

MARGIN = SINGLE_PRECISION_MARGIN
"""m by which every inflation is larger than its name says, as in a search in float32: a waypoint
on the border of a region stays clear when it is rounded."""

_SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))


def bodies_of(scenario: Scenario, turn: Turn = NO_TURN) -> list[Body]:
    """Inflated obstacles for the load, and a shadow of every obstacle per cable.

    Args:
        scenario: the task.
        turn: the orientation in which polyhedra around round bodies are the same for all tasks.

    Raises:
        InputError: the upper end of a cable lies in an obstacle's warning area.
    """
    return [
        body
        for i, obstacle in enumerate(scenario.obstacles)
        for body in obstacle_bodies(
            scenario, obstacle, numbered("obstacles", i, obstacle.name), turn
        )
    ]


def obstacle_bodies(
    scenario: Scenario, obstacle: Any, name: str, turn: Turn = NO_TURN
) -> list[Body]:
    """One obstacle of a scenario inflated for the load and, where ends are fixed, its shadows.

    Where the ends move, a load position does not say where the cables are: only the load's own
    body is left, and the search counts contacts of the cables.

    Raises:
        InputError: the upper end of a cable lies in the obstacle's warning area.
    """
    clear, shape = scenario.limits.clearance + MARGIN, warning_shape(scenario)
    across, up = shape.radius + clear, shape.half_height + clear
    thin, found = shape.cable_radius + clear, []
    load = load_of(scenario)
    sides = SIDES if len(scenario.obstacles) <= FEW else SIDES // 2
    met = [] if load is None else [body.larger(clear).corners for body in sums(obstacle, load)]
    for i, (part, named) in enumerate(_parts(obstacle, name)):
        around_load = _inflated(part, across, up, None, sides) if load is None else met[i]
        found.append(Body.hull(f"{named} (load)", around_load))
        if not moving(scenario.drive):
            around_cable = Body.hull(named, _inflated(part, thin, thin, turn, sides))
            found += shadows(scenario, around_cable)
    return found


def _parts(obstacle: Any, name: str) -> Iterator[tuple[Any, str]]:
    """The convex bodies of an obstacle, each with its name."""
    if obstacle.kind != "mesh" or obstacle.shape == "box":
        yield obstacle, name
        return
    bodies = obstacle.bodies
    for number, body in enumerate(bodies, start=1):
        placed = body.placed(obstacle.center, obstacle.yaw_deg)
        yield placed, f"{name}, piece {number}" if len(bodies) > 1 else name


def domain_of(scenario: Scenario) -> HalfSpaces:
    """The workspace above the ground and, for a hook, where every cable pulls (all T_k >= 0).

    Without horizontal force a hook is balanced by pulling cables iff the vertical above it meets
    the convex hull of the ends: for ends of one height, iff it is inside their polygon.
    """
    workspace = HalfSpaces.box(np.array(lowest(scenario)), np.array(scenario.workspace.upper))
    if scenario.payload.attachments != "hook" or moving(scenario.drive):
        return workspace
    taut = _below(np.array([robot.end for robot in scenario.robots]))
    hook = np.array([0.0, 0.0, scenario.payload.height / 2])
    return workspace & HalfSpaces(taut.A, taut.b - taut.A @ hook)


def _below(ends: Points) -> HalfSpaces:
    """All points from which a vertical line upwards meets the convex hull of the ends."""
    deep = ends - [0.0, 0.0, 1e3 * np.ptp(ends[:, :2])]
    hull = ConvexHull(np.concatenate([ends, deep])).equations
    hull = np.unique(hull[hull[:, 2] > -1e-9].round(12), axis=0)  # all faces but the bottom
    return HalfSpaces(hull[:, :3], -hull[:, 3])


def _inflated(obstacle: Any, across: float, up: float, ball: Turn | None, sides: int) -> Points:
    """Corners of a polyhedron around an obstacle inflated horizontally and vertically.

    Args:
        obstacle: of a scenario, or one convex body of it.
        across: horizontal inflation (m).
        up: vertical inflation (m), upwards and downwards.
        ball: the turn of an inflated sphere that is a ball (cables); None: it is an upright
            cylinder (load).
        sides: of prisms.
    """
    grown = np.array([across, across, up])
    if isinstance(obstacle, Polytope):
        level = np.hypot(obstacle.grown[:, 0], obstacle.grown[:, 1])
        reach = across * level + up * np.abs(obstacle.grown[:, 2])
        if ball is not None:
            reach = np.full(len(reach), across)
        faces = HalfSpaces(obstacle.grown, obstacle.support(obstacle.grown) + reach)
        return corners_of(faces, obstacle.corners.mean(axis=0))
    center = np.array(obstacle.center)
    match obstacle.kind:
        case "box" | "mesh":
            local = _SIGNS * (np.array(obstacle.size) / 2 + grown)
            return center + _turned(local, obstacle.yaw_deg)
        case "cylinder":
            return center + _prism(obstacle.radius + across, obstacle.height / 2 + up, sides)
        case "sphere" if ball is not None:
            return center + (obstacle.radius + across) * _round_polyhedron(sides == SIDES) @ ball
        case "sphere":
            return center + _prism(obstacle.radius + across, obstacle.radius + up, sides)
    raise ValueError(f"no body for an obstacle of kind {obstacle.kind!r}")


def _turned(points: Points, yaw_deg: float) -> Points:
    c, s = np.cos(np.deg2rad(yaw_deg)), np.sin(np.deg2rad(yaw_deg))
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _prism(radius: float, half_height: float, sides: int) -> Points:
    """Corners of the upright prism around a cylinder about the origin."""
    angle = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    ring = radius / np.cos(np.pi / sides) * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.concatenate(
        [np.column_stack([ring, np.full(sides, z)]) for z in (-half_height, half_height)]
    )


@functools.cache
def _round_polyhedron(fine: bool) -> Points:
    """Corners of the polyhedron whose faces touch the unit sphere at an icosphere's points."""
    from trimesh.creation import icosphere

    normals = np.asarray(icosphere(subdivisions=2 if fine else 1).vertices, np.float64)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    halves = np.column_stack([normals, np.full(len(normals), -1.0)])
    return np.unique(HalfspaceIntersection(halves, np.zeros(3)).intersections.round(12), axis=0)
