"""Where the points of a path may go without load or cables coming too close to anything.

At a point of the path MuJoCo gives the distance of two bodies and the direction n of the nearest
points, and a plane with normal n parts the two. However the load shifts, they stay apart as long as
the extreme points of either stay on their side: one half-space for the shift per end of the bodies,
as in the certificate (`verify.certificate`). Between the points nothing is said; whoever moves a
path checks it again.
"""

import numpy as np

from jaxsusp.suspension.rigging import Rigging
from jaxsusp.trajectory.smoothing import NOWHERE, Planes
from jaxsusp.verify.gauge import Gauge
from jaxsusp.verify.pairs import System


def room_around(rigging: Rigging, radius: float, margin: float = 0.0) -> Planes:
    """Half-spaces for shifts of the points of a path whose ends stay, in own units.

    Args:
        rigging: the system along its path.
        radius: shifts of more than this along any axis do not matter (m).
        margin: kept beyond what is required, where there is so much (m).
    """
    u = rigging.law.path.marks[0]
    gauge = Gauge(System(rigging))
    system = gauge.system
    points = system.locate(rigging.law.path.curve(u), rigging.ends_at(u))
    moving = np.flatnonzero(gauge.moving)
    pair, row = np.tile(moving, len(u)), np.repeat(np.arange(len(u)), len(moving))
    value, normal = gauge.measure(pair, points[row])
    near = value - gauge.required[pair] < 2 * np.sqrt(3) * radius + margin
    pair, row, normal = pair[near], row[near], normal[near]
    found = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        a, b = gauge.span_one[pair, i], gauge.span_other[pair, j]
        along = system.along[a] - system.along[b]
        apart = ((points[row, a] - points[row, b]) * normal).sum(axis=-1)
        reached = _reach(system, gauge.one[pair], -normal) + _reach(
            system, gauge.other[pair], normal
        )
        least = gauge.required[pair] + margin - (apart - reached)
        found.append(Planes(row, along[:, None] * normal, least))
    if not found:
        return NOWHERE
    columns = Planes(*(np.concatenate(each) for each in zip(*found, strict=True)))
    matter = np.abs(columns.normal).sum(axis=1) * radius > -columns.least
    return Planes(*(each[matter] for each in columns))


def _reach(system: System, body: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """How far bodies go beyond their points, each along its own direction (m)."""
    found = np.empty(len(body))
    for index in np.unique(body):
        rows = body == index
        found[rows] = system.bodies[index].reach(normal[rows])
    return found
