"""Which cells of the workspace are forbidden as a whole, and which are clear as a whole: a proof.

Cells are halved along every axis, level by level (an octree): BLOCKED is a cell inside one
forbidden convex body, FREE one that meets none, MIXED any other, which is looked at again in its
parts (Brooks & Lozano-Pérez 1985). Two cells are neighbours if they share as much as a corner, so
no way can slip between them: where start and goal are not connected by cells that are not BLOCKED,
no way exists at all; where they are connected by FREE cells, one does.
"""

from itertools import product
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, UInt64

from jaxsusp.freespace.cells.forbidden import Errand, Forbidden, forbidden_of
from jaxsusp.freespace.cells.ways import Cell, cell_of, joined
from jaxsusp.freespace.polyhedra import Point
from jaxsusp.mechanics.drives import moving
from jaxsusp.scenario.ownunits import Frame
from jaxsusp.scenario.scenario import Scenario

COARSEST, FINEST = 8, 128
"""Cells along the longest side of the workspace, at first and at most."""

PAIRS = 600_000
"""Pairs of a cell and a body near its surface up to which cells are halved: a second or two."""

NAMED = 63
"""Obstacles that are told apart in a cell; those beyond share the last bit."""

_EIGHT = np.array([*product((0, 1), repeat=3)])


class Cells(NamedTuple):
    """Equal cells that fill a box."""

    lower: Point  # corner of the box, m
    size: Point  # of a cell, m
    blocked: UInt64[np.ndarray, "x y z"]  # which obstacles hold the whole cell, a bit each
    free: Bool[np.ndarray, "x y z"]  # whether it is clear as a whole
    start: Cell
    goal: Cell

    @property
    def diagonal(self) -> float:
        """Diagonal of a cell (m).

        Where load and cables keep more than this beyond what is required, the cell is FREE: its
        centre, half a diagonal away at most, keeps more than half, and so its whole ball does.
        """
        return float(np.linalg.norm(self.size))

    @property
    def open(self) -> Bool[np.ndarray, "x y z"]:
        """Cells that are not BLOCKED."""
        return self.blocked == 0

    @property
    def verdict(self) -> str:
        """No way exists: "blocked"; one does: "open"; or "undecided" at this size of cells."""
        if not joined(self.open, self.start, self.goal):
            return "blocked"
        return "open" if joined(self.free, self.start, self.goal) else "undecided"

    @property
    def centers(self) -> Float[np.ndarray, "x y z 3"]:
        """Centres of the cells (m)."""
        return self.lower + (np.moveaxis(np.indices(self.blocked.shape), 0, -1) + 0.5) * self.size

    def words(self, frame: Frame) -> str:
        """The size of the cells, in words."""
        return f"{frame.number(float(self.size.max()), 'm'):.2g} m"


def subdivide(
    forbidden: Forbidden, errand: Errand, finest: int = FINEST, all_obstacles: bool = False
) -> Cells:
    """Cells at the first size that decides, or at the finest that is affordable.

    Args:
        forbidden: what to look for.
        errand: the box to look in, and what is to be joined.
        finest: cells along the longest side at most.
        all_obstacles: go on to the finest, and find every obstacle that holds a cell instead of
            the first.
    """
    lower, sides = errand.lower, errand.upper - errand.lower
    count = np.maximum(1, np.ceil(COARSEST * sides / sides.max() - 1e-9)).astype(int)
    index = np.indices(count).reshape(3, -1).T
    pairs = np.repeat(index, len(forbidden), axis=0), np.tile(np.arange(len(forbidden)), len(index))
    blocked, along = np.zeros(count, np.uint64), COARSEST
    while True:
        size = sides / blocked.shape
        pairs = _look(forbidden, lower, size, blocked, *pairs, all_obstacles)
        near = np.zeros(blocked.shape, bool)
        near[tuple(pairs[0].T)] = True
        ends = (cell_of(place, lower, size, blocked.shape) for place in errand[2:])
        cells = Cells(lower, size, blocked, ~near & (blocked == 0), *ends)
        done = not all_obstacles and cells.verdict != "undecided"
        if done or 2 * along > finest or 8 * len(pairs[1]) > PAIRS:
            return cells
        along *= 2
        blocked = blocked.repeat(2, 0).repeat(2, 1).repeat(2, 2)
        parts = (2 * pairs[0][:, None] + _EIGHT).reshape(-1, 3)
        pairs = parts, np.repeat(pairs[1], 8)


def proved_blocked(scenario: Scenario) -> bool:
    """Whether it is proved that no way joins start and goal within the workspace."""
    forbidden = forbidden_of(scenario, not moving(scenario.drive))
    return subdivide(forbidden, Errand.of(scenario)).verdict == "blocked"


def _look(forbidden, lower, size, blocked, index, body, all_obstacles):
    """Note what cells are inside of; the pairs that their parts must be looked at for."""
    half = np.linalg.norm(size) / 2
    room = forbidden.room(lower + (index + 0.5) * size, body)
    near = room <= half
    index, body, room = index[near], body[near], room[near]
    inside = np.flatnonzero(room <= 0)
    for corner in _EIGHT:  # most are out at the first or second
        places = lower + (index[inside] + corner) * size
        inside = inside[forbidden.room(places, body[inside], inner=True) <= 0]
    bits = np.uint64(1) << np.minimum(forbidden.owner[body], NAMED).astype(np.uint64)
    np.bitwise_or.at(blocked, tuple(index[inside].T), bits[inside])
    known = blocked[tuple(index.T)]
    rest = (known & bits if all_obstacles else known) == 0
    return index[rest], body[rest]
