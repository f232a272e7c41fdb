"""Cable shadows: where the load must not be because a cable would touch an obstacle."""

from collections.abc import Iterator
from itertools import product

import numpy as np

from jaxsusp.errors import InputError
from jaxsusp.freespace.polyhedra import Body, nearest_point
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.scenario.world import attachments_of


def shadows(scenario: Scenario, body: Body) -> Iterator[Body]:
    """The load positions at which each cable meets a body, {P + s (o - P) - B' : s >= 1}.

    Cut off beyond the workspace, a shadow is the hull of the body's corners and of the same
    corners pushed away from the end.
    """
    corners = np.array(
        [*product(*np.transpose([scenario.workspace.lower, scenario.workspace.upper]))]
    )
    rows = zip(scenario.robots, attachments_of(scenario), strict=True)
    for k, (robot, attachment) in enumerate(rows):
        end = np.array(robot.end)
        scale = float(np.linalg.norm(body.corners[0] - end)) or 1.0
        nearest = nearest_point(body.faces, end, scale).point
        distance = 0.0 if nearest is None else float(np.linalg.norm(nearest - end))
        if distance < 1e-6:
            place = scenario.frame.place(robot.end).tolist()
            raise InputError(
                f"robots[{k}].end = {place} is in the warning area of {body.name}; "
                "move the end or the obstacle"
            )
        farthest = np.linalg.norm(corners + attachment - end, axis=1).max()
        push = max(1.0, farthest / distance) * 1.01
        pushed = end + push * (body.corners - end)
        yield Body.hull(
            f"{body.name} (cable {k + 1})", np.concatenate([body.corners, pushed]) - attachment
        )
