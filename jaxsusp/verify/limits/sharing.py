"""More than three cables at a hook over intervals of time: which of their balances is meant.

The tensions are those nearest to the middle of their limits among all that balance the load within
the limits (`mechanics.tensiondistribution`). With the cables that are at a limit known, they are
the solution of three linear equations. Over an interval the cables at a limit may change: some are
surely there, others possibly. With only the sure ones held at their limits the solution is nearer
to the middle than the tensions that are meant, with the possible ones as well it is further away
(or not within the limits); both solutions are orthogonal to their difference, and so the tensions
meant are no further from the second than the first is.
"""

from typing import NamedTuple

import numpy as np

from jaxsusp._types import Bool
from jaxsusp.suspension.levelload import DOUBLE_PRECISION_TENSION
from jaxsusp.verify.limits.strips import Strip, cross, dot

_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


class Held(NamedTuple):
    """Cables at their limits, (rows, K) each."""

    low: Bool[np.ndarray, "rows cables"]
    high: Bool[np.ndarray, "rows cables"]

    @property
    def any(self) -> Bool[np.ndarray, "rows cables"]:
        """Cables at one or the other."""
        return self.low | self.high


def shared(units: Strip, force: Strip, limits: tuple[float, float]) -> Strip:
    """Tensions of more than three cables at a hook (N), (rows, K).

    Nothing is known where no tensions within the limits were found to balance the load.

    Args:
        units: from the hook to the ends, of length one, (rows, K, 3).
        force: that the cables supply (N), (rows, 3).
        limits: T_lo, T_hi (N).
    """
    low, high = limits[0] + DOUBLE_PRECISION_TENSION, limits[1] - DOUBLE_PRECISION_TENSION
    system = _System(units, force, low, high)
    nobody = np.zeros(units.middle.shape[:2], bool)
    free = system.solve(Held(nobody, nobody))
    kept = ((free.lower >= low) & (free.upper <= high)).all(axis=1)
    if kept.all():
        return free
    rows = np.flatnonzero(~kept)
    found = Strip(*(each.copy() for each in (free.middle, free.slope, free.rest)))
    its_force = force if len(force.middle) == 1 else force[rows]  # the weight is one for all
    there = _at_limits(_System(units[rows], its_force, low, high))
    for mine, its in zip((found.middle, found.slope, found.rest), there, strict=True):
        mine[rows] = its
    return found


def _at_limits(system: "_System") -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where cables are at their limits, or may come to be there."""
    low, high = system.low, system.high
    held = system.held_in_the_middle()
    pull = system.solve(held)
    sure = Held(held.low & (pull.upper < low), held.high & (pull.lower > high))
    maybe = Held(
        held.low | (~held.any & (pull.lower < low)), held.high | (~held.any & (pull.upper > high))
    )
    (far, solved), (near, pull) = system.tensions(maybe), system.tensions(sure)
    within = (far.lower >= low) & (far.upper <= high) & np.isfinite(solved.rest)  # it balances
    pulled = (~sure.low | (pull.upper < low)) & (~sure.high | (pull.lower > high))
    fine = (within & pulled & ~(maybe.low & maybe.high)).all(axis=1, keepdims=True)
    settled = (sure.any == maybe.any).all(axis=1, keepdims=True)
    apart = near - far
    most = np.maximum(np.abs(apart.lower), np.abs(apart.upper))
    distance = np.sqrt((most**2).sum(axis=1, keepdims=True))
    between = Strip.between(
        np.clip(far.lower - distance, low, high), np.clip(far.upper + distance, low, high)
    )
    found = far.or_where(np.broadcast_to(settled, most.shape), between)
    return found.middle, found.slope, np.where(fine, found.rest, np.inf)


class _System:
    """The equations: T_k = T_mid + u_k·λ of cables that are off their limits."""

    def __init__(self, units: Strip, force: Strip, low: float, high: float):
        self.units, self.force, self.low, self.high = units, force, low, high
        self.middle = (low + high) / 2

    def solve(self, held: Held) -> Strip:
        """T_mid + u_k·λ of all cables, with some held at their limits."""
        units = self.units
        free = (~held.any).astype(float)[..., None]
        fixed = np.where(held.low, self.low, np.where(held.high, self.high, self.middle))
        wanted = self.force - (units * fixed[..., None]).sum(1)
        taking_part = units * free
        matrix = (taking_part[..., :, None] * units[..., None, :]).sum(1)
        facets = cross(matrix[:, _NEXT], matrix[:, _AFTER])
        per_volume = dot(matrix[:, 0], facets[:, 0]).inverse()
        slope = (facets * wanted[..., None]).sum(1) * per_volume[:, None]
        return dot(units, slope[:, None]) + self.middle

    def tensions(self, held: Held) -> tuple[Strip, Strip]:
        """The tensions, those at their limits included, and what `solve` gives."""
        pull = self.solve(held)
        fixed = Strip.still(np.where(held.low, self.low, self.high))
        return fixed.or_where(held.any, pull), pull

    def held_in_the_middle(self) -> Held:
        """Cables at their limits in the middles of intervals, by Newton's method."""
        still = _System(
            Strip.still(self.units.middle), Strip.still(self.force.middle), self.low, self.high
        )
        held = Held(*np.zeros((2, *self.units.middle.shape[:2]), bool))
        for _ in range(2 * held.low.shape[1]):
            pull = still.solve(held).middle
            found = Held(pull < self.low, pull > self.high)
            if (found.low == held.low).all() and (found.high == held.high).all():
                break
            held = found
        return held
