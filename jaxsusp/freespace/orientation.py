"""The way round in which regions are grown, so that a turned or mirrored task has the same ones.

Seeds of regions are drawn at random in the workspace, along its axes. They are therefore drawn with
the task turned by quarter turns until its first robot stands to the north, seen from the middle of
all, and mirrored where its second one does not follow counter-clockwise, as the benchmark's does.
"""

import numpy as np
from jaxtyping import Float

from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.polyhedra import Body, HalfSpaces
from jaxsusp.scenario.scenario import Scenario

Turn = Float[np.ndarray, "3 3"]
"""A rotation by quarter turns about the vertical axis, or with a reflection: one 1 in every row."""

NO_TURN = np.eye(3)
_QUARTER = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
_MIRROR = np.diag([-1.0, 1.0, 1.0])


def turn_of(scenario: Scenario) -> Turn:
    """What brings a task in own units into that orientation; nothing changes the benchmark's."""
    first, second = (np.array(robot.base) for robot in scenario.robots[:2])
    turns = (NO_TURN, _QUARTER, _QUARTER @ _QUARTER, _QUARTER.T)
    turn = next((each for each in turns if _is_north(each @ first)), NO_TURN)
    (x, y, _), (across, along, _) = turn @ first, turn @ second
    return turn if x * along >= y * across else _MIRROR @ turn


def _is_north(place: np.ndarray) -> bool:
    """Whether a place is in the northern quarter as seen from the middle."""
    x, y, _ = place.tolist()
    return -y < x <= y


# What is not turned is handed on as it is: another layout in memory would be rounded otherwise.


def turned_points(
    points: Float[np.ndarray, "*batch 3"], turn: Turn
) -> Float[np.ndarray, "*batch 3"]:
    """Places turned about the middle."""
    return points if turn is NO_TURN else points @ turn.T


def turned_halves(halves: HalfSpaces, turn: Turn) -> HalfSpaces:
    """A polyhedron turned about the middle."""
    return halves if turn is NO_TURN else HalfSpaces(halves.A @ turn.T, halves.b)


def turned_body(body: Body, turn: Turn) -> Body:
    """A body turned about the middle."""
    return Body(body.name, turned_points(body.corners, turn), turned_halves(body.faces, turn))


def turned_ellipsoid(shape: Ellipsoid, turn: Turn) -> Ellipsoid:
    """An ellipsoid turned about the middle."""
    if turn is NO_TURN:
        return shape
    return Ellipsoid(turn @ shape.C @ turn.T, turn @ shape.d)


def undone(turn: Turn) -> Turn:
    """What turns back."""
    return turn if turn is NO_TURN else turn.T
