"""The smallest set of obstacles whose removal opens a way: minimum constraint removal (Hauser 2014).

Exact in the cells of a subdivision: every BLOCKED cell knows the obstacles that hold it as a whole,
and a set of obstacles opens the cells that no other obstacle holds. Sets grow, the smallest first,
by what holds a cell beside those that a set opens up to: the smallest set that will do is reached
by such steps, because every way through its cells leaves the part known so far across one of them.
As a BLOCKED cell is a proof, fewer obstacles than are found never suffice.
"""

import heapq

import numpy as np
from scipy import ndimage

from jaxsusp.freespace.cellways import reached
from jaxsusp.freespace.forbidden import Forbidden
from jaxsusp.freespace.polyhedra import Point
from jaxsusp.freespace.subdivision import FINEST, NAMED, Cells, subdivide

MOST_SETS = 200
"""Sets of obstacles that are looked at before giving up."""


def least_removal(
    forbidden: Forbidden, lower: Point, upper: Point, start: Point, goal: Point, cells: Cells
) -> tuple[set[int] | None, Cells]:
    """Obstacles to take away, and the cells that say so.

    Where cells that were fine enough to prove a task blocked do not prove that what is left after
    the removal is blocked, but finer ones do, the search begins again with those.

    Args:
        forbidden: everything that is forbidden.
        lower: corner of the box that is looked at (m).
        upper: the opposite corner (m).
        start: a position (m).
        goal: another (m).
        cells: that prove that no way joins them.

    Returns:
        Numbers of obstacles, and the cells they were found in; None where there are too many sets
        to look at, or obstacles beyond those that cells tell apart are among them.
    """
    along = max(cells.blocked.shape)
    while True:
        cells = subdivide(forbidden, lower, upper, start, goal, along, all_obstacles=True)
        found = smallest_opening(cells)
        if found is None or NAMED in found:
            return None, cells
        left = subdivide(forbidden.without(found), lower, upper, start, goal, FINEST)
        finer = max(left.blocked.shape)
        if left.verdict != "blocked" or finer <= max(cells.blocked.shape):
            return found, cells
        along = finer


def smallest_opening(cells: Cells) -> set[int] | None:
    """The smallest set of obstacles without which start and goal are joined; None: given up.

    Of sets of one size, the first by the numbers of the obstacles.
    """
    labels = cells.blocked
    first = int(labels[cells.start] | labels[cells.goal])  # these must go in any case
    queue = [(first.bit_count(), first)]
    seen = {first}
    for _ in range(MOST_SETS):
        if not queue:
            return None
        _, gone = heapq.heappop(queue)
        opened = reached((labels & ~np.uint64(gone)) == 0, cells.start)
        if opened[cells.goal]:
            return {bit for bit in range(NAMED + 1) if gone >> bit & 1}
        border = ndimage.binary_dilation(opened, np.ones((3, 3, 3), bool)) & ~opened
        for more in np.unique(labels[border] & ~np.uint64(gone)).tolist():
            if (larger := gone | more) not in seen:
                seen.add(larger)
                heapq.heappush(queue, (larger.bit_count(), larger))
    return None
