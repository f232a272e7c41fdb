"""Can the load be held all along some way?  Tensions at rest, at the centres of cells.

A hint and no proof: between the centres tensions are other ones, a passage narrower than a cell is
not seen, and a load that swings can for a moment be where it could not rest.
"""

from typing import NamedTuple

import numpy as np

from jaxsusp.freespace.cells.subdivision import Cells
from jaxsusp.freespace.cells.ways import shortest, widest
from jaxsusp.scenario.scenario import Scenario
from jaxsusp.suspension.cableloads import cable_loads

HOOK, SEPARATE = 32, 8
"""Cells along the longest side; with separate attachments every cell costs an equilibrium."""

_HOPELESS = 1e9  # N, where there is no equilibrium


class Weakest(NamedTuple):
    """The place of a way where tensions are furthest outside their limits."""

    place: np.ndarray  # m
    tensions: np.ndarray  # N, one per cable
    excess: float  # N beyond a limit; negative: so much inside all of them


def least_excess(scenario: Scenario, cells: Cells) -> Weakest:
    """The weakest place of the way by cells that are not BLOCKED along which it is best.

    Minimax of the excess over the limits of tension, load at rest; start and goal count as they
    are, every other cell at its centre.

    Args:
        scenario: the task, ends as given.
        cells: which cells are BLOCKED; they join start and goal.
    """
    low, high = scenario.limits.tension
    places = cells.centers
    places[cells.start], places[cells.goal] = scenario.task.start, scenario.task.goal
    static = cable_loads(scenario, places.reshape(-1, 3)).static
    tensions = static.reshape(*places.shape[:3], -1)
    excess = np.nan_to_num(np.maximum(tensions - high, low - tensions).max(axis=-1), nan=_HOPELESS)
    values = np.where(cells.open, -np.minimum(excess, _HOPELESS), -2 * _HOPELESS)
    best = widest(values, cells.start, cells.goal)
    way = shortest(values >= best, cells.size, cells.start, cells.goal)
    at = tuple(way[values[tuple(way.T)].argmin()])
    return Weakest(places[at], tensions[at], -best)
