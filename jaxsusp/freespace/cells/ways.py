"""Ways from cell to cell of a grid: whether there is one, the widest, a short one.

Cells are neighbours if they share as much as a corner.
"""

from itertools import product

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from jaxsusp.freespace.polyhedra import Point

Cell = tuple[int, int, int]

_TOUCHING = np.ones((3, 3, 3), bool)
_AHEAD = [step for step in product((-1, 0, 1), repeat=3) if step > (0, 0, 0)]


def cell_of(place: Point, lower: Point, size: Point, shape: tuple[int, ...]) -> Cell:
    """The cell that holds a place, of those of a size (m) from a corner (m) on."""
    x, y, z = np.clip(((place - lower) / size).astype(int), 0, np.array(shape) - 1).tolist()
    return x, y, z


def reached(cells: Bool[np.ndarray, "x y z"], start: Cell) -> Bool[np.ndarray, "x y z"]:
    """Those of the cells that are joined to one of them."""
    parts = _parts(cells)
    return (parts == parts[start]) & cells


def joined(cells: Bool[np.ndarray, "x y z"], start: Cell, goal: Cell) -> bool:
    """Whether cells join two of them."""
    parts = _parts(cells)
    return bool(parts[start] > 0 and parts[start] == parts[goal])


def _parts(cells: Bool[np.ndarray, "x y z"]) -> Int[np.ndarray, "x y z"]:
    """Number of the connected part that each cell belongs to; 0 for all others."""
    parts = np.empty(cells.shape, np.int32)
    ndimage.label(cells, _TOUCHING, output=parts)
    return parts


def widest(values: Float[np.ndarray, "x y z"], start: Cell, goal: Cell) -> float:
    """The greatest value v such that cells of at least v join start and goal (maximin).

    Values are halved in their order; those of the cells on either end bound it from above.
    """
    levels = np.unique(values[values <= min(values[start], values[goal])])
    low, high = 0, len(levels) - 1  # at the lowest, everything is joined
    while low < high:
        middle = (low + high + 1) // 2
        if joined(values >= levels[middle], start, goal):
            low = middle
        else:
            high = middle - 1
    return float(levels[low])


def shortest(
    cells: Bool[np.ndarray, "x y z"], size: Point, start: Cell, goal: Cell
) -> Int[np.ndarray, "steps 3"]:
    """The shortest way of neighbouring cells that join two of them, centre to centre.

    Args:
        cells: those that may be used; they join start and goal.
        size: of a cell (m).
        start: the first cell.
        goal: the last.
    """
    number = np.full(cells.shape, -1)
    index = np.argwhere(cells)
    number[tuple(index.T)] = np.arange(len(index))
    edges = []
    for step in _AHEAD:
        one = tuple(slice(max(0, -s), min(0, -s) or None) for s in step)
        other = tuple(slice(max(0, s), min(0, s) or None) for s in step)
        both = cells[one] & cells[other]
        length = float(np.linalg.norm(step * size))
        edges.append(
            np.stack([number[one][both], number[other][both], np.full(both.sum(), length)])
        )
    rows, columns, lengths = np.concatenate(edges, axis=1)
    pairs = rows.astype(int), columns.astype(int)
    graph = csr_array((lengths, pairs), shape=(len(index),) * 2)
    source, at = number[start], number[goal]
    _, before = dijkstra(graph, directed=False, indices=source, return_predecessors=True)
    way = [at]
    while way[-1] != source:
        way.append(before[way[-1]])
    return index[way[::-1]]
