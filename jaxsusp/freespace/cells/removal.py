"""The fewest obstacles whose removal opens a way: minimum constraint removal (Hauser 2014).

Exact in the cells of a subdivision: every BLOCKED cell knows the obstacles that hold it as a whole,
and a set of obstacles opens the cells that no other obstacle holds. Sets grow, the smallest first,
by what holds a cell beside those that a set opens up to: the smallest set that will do is reached
by such steps, because every way through its cells leaves the part known so far across one of them.
As a BLOCKED cell is a proof, fewer obstacles than are found never suffice.
"""

import heapq
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from jaxsusp.freespace.cells.forbidden import Errand, Forbidden
from jaxsusp.freespace.cells.subdivision import NAMED, Cells, subdivide
from jaxsusp.freespace.cells.ways import reached

MOST_SETS = 200
"""Sets of obstacles that are looked at before giving up."""


class Removal(NamedTuple):
    """Obstacles to take away."""

    obstacles: set[int] | None  # None: given up
    opens: bool  # whether a way is proved to exist without them
    cells: Cells  # that prove that fewer do not suffice


def least_removal(forbidden: Forbidden, errand: Errand, cells: Cells) -> Removal:
    """The fewest obstacles to take away where cells prove that no way joins two positions.

    Where finer cells prove that what is left after the removal is blocked as well, the search
    begins again with those.

    Args:
        forbidden: everything that is forbidden.
        errand: what is to be joined.
        cells: the proof.

    Returns:
        Numbers of obstacles; none where there are too many sets to look at, or obstacles that
        cells do not tell apart are among them.
    """
    along = max(cells.blocked.shape)
    while True:
        cells = subdivide(forbidden, errand, along, all_obstacles=True)
        found = smallest_opening(cells)
        if found is None or NAMED in found:
            return Removal(None, False, cells)
        left = subdivide(forbidden.without(found), errand)
        finer = max(left.blocked.shape)
        if left.verdict != "blocked" or finer <= max(cells.blocked.shape):
            return Removal(found, left.verdict == "open", cells)
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
