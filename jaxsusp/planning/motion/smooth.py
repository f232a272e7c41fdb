"""The smoothest path near the one that was searched, as far as everything is still kept.

Makima's curve bends hard where its pieces meet. Its samples may move a little, within half-spaces
that keep load and cables clear (`room`), to where the natural quintic spline through them has the
least third derivative (`trajectory.smoothing`). What the half-spaces do not know of, between the
samples and of tensions, reach and arms, the checks of the plan tell; where they find something the
samples may move less, and in the end not at all.
"""

from collections.abc import Callable

import numpy as np

from jaxsusp.mechanics.drives import moving
from jaxsusp.planning.motion.along import plan_along
from jaxsusp.planning.motion.room import room_around
from jaxsusp.planning.plan import Plan
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.smoothing import NOWHERE, smoothed
from jaxsusp.trajectory.timelaw import TimeLaw

RADII = (0.05, 0.02, 0.008, 0.003)
"""m of the task's own, tried in turn: how far a sample may move along every axis. The first is the
benchmark's clearance, beyond which a path would be another one than was searched."""

KEPT = 1e-3
"""m that half-spaces keep beyond what is required: between the samples a curve bulges."""


def smoothest(found: Plan, drive: Callable[[Plan], Plan] = lambda plan: plan) -> Plan:
    """The plan on the smoothest path on which it is feasible; itself where there is none.

    A plan that comes too close to something is left as it is.

    Args:
        found: in own units, on Makima's samples, with the minimum-jerk law.
        drive: gives a plan with such a law the one that is wanted.
    """
    if not found.certificate.proved:
        return found
    for radius in RADII:
        rigging = smoothed_rigging(found.rigging, radius)
        better = plan_along(
            found.scenario, found.waypoints, rigging.law, rigging.end_path, rigging.elbow_up,
            found.settings,
        )  # fmt: skip
        if better.certificate.proved and (better := drive(better)).feasible:
            return better
    return drive(found)


def smoothed_rigging(rigging: Rigging, radius: float) -> Rigging:
    """The system along the smoothest path whose points moved so far at most; unchecked.

    Ends that move go along with the load as the plain rule of their drive mode makes them.
    """
    points = rigging.law.path.points
    planes = NOWHERE if rigging.moves else room_around(rigging, radius, KEPT)
    path = smoothed(points, radius, planes)
    ends = rigging.end_path
    if moving(rigging.scenario.drive):
        before, after = (ends_beside(rigging.scenario, each) for each in (points, path))
        ends = ends + (after - before)
    law = TimeLaw.through(np.asarray(path), rigging.law.duration)
    return Rigging(rigging.scenario, law, ends, rigging.elbow_up)
