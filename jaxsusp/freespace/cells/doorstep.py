"""Bodies that start and goal stand in only because they are circumscribed, cut open there.

Polyhedra around round obstacles, and the margin for float32, reach further than what they stand
for. What is forbidden itself is convex: where it leaves a place of the task clear, a plane between
the two cuts the polyhedron, and nothing that is forbidden with it. So a task that is admissible
begins and ends in its free space, however narrow it is there.
"""

from collections.abc import Sequence

import numpy as np

from jaxsusp.freespace.cells.forbidden import Forbidden, forbidden_of
from jaxsusp.freespace.polyhedra import Body, HalfSpaces, Point, cut
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.ownunits import TOUCH
from jaxsusp.scenario.scenario import Scenario

STEPS = 44
"""Halvings for the nearest place on a cable: to 1e-12 of its length."""

_DIFFERENCE = 1e-7  # m, of positions for a direction
_BACK = 60  # halvings of the way from a place to the border of what is forbidden


def opened(scenario: Scenario, bodies: Sequence[Body]) -> list[Body]:
    """The same bodies, cut where they come nearer to start or goal than what they stand for.

    Args:
        scenario: the task.
        bodies: those of `bodies_of`, obstacle by obstacle.
    """
    forbidden = forbidden_of(scenario, not moving(scenario.drive), STEPS)
    assert len(forbidden) == len(bodies)
    found = list(bodies)
    for place in (np.array(scenario.task.start), np.array(scenario.task.goal)):
        for number, body in enumerate(found):
            if body.faces.excess(place) > TOUCH:
                continue
            plane = _between(forbidden, number, place, body)
            if plane is not None and plane.b < (body.corners @ plane.A[0]).max():
                found[number] = cut(body, plane)
    return found


def _between(forbidden: Forbidden, number: int, place: Point, body: Body) -> HalfSpaces | None:
    """The side of a plane that a forbidden set lies on, and a place does not; None where it does.

    The room is quasi-convex: where it is as little as at a point, is beyond the plane through the
    point and square to the slope there.
    """

    def room(*points: Point) -> np.ndarray:
        return forbidden.room(np.array(points), np.full(len(points), number))

    if room(place)[0] < TOUCH / 2:
        return None
    inside = body.corners.mean(axis=0)
    if room(inside)[0] > 0:
        return None
    low, high = 0.0, 1.0  # shares of the way from the place into the body
    for _ in range(_BACK):
        middle = (low + high) / 2
        free = room(place + middle * (inside - place))[0] > TOUCH / 4
        low, high = (middle, high) if free else (low, middle)
    border = place + low * (inside - place)
    steps = _DIFFERENCE * np.eye(3)
    slope = room(*(border + steps)) - room(*(border - steps))
    size = np.linalg.norm(slope)
    if not size > 0:
        return None
    normal = slope / size
    plane = HalfSpaces(normal[None], np.array([normal @ border]))
    return plane if plane.excess(place) > 0 else None
