"""Cables at a hook over intervals of time, as strips: lengths, tensions, stability, tilt."""

from functools import cached_property

import numpy as np

from jaxsusp.mechanics.statics import GRAVITY
from jaxsusp.scenario.world import attachments_of
from jaxsusp.verify.limits.passage import Passage
from jaxsusp.verify.limits.sharing import shared
from jaxsusp.verify.limits.strips import Strip, cross, dot, heading, least, norm, stacked

_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


class Cables:
    """What the cables of a load at a hook carry during intervals; K cables.

    Args:
        passage: the motion over the intervals.
    """

    def __init__(self, passage: Passage):
        self._passage, self._scenario = passage, passage.rigging.scenario

    @cached_property
    def _hook(self) -> Strip:
        return self._passage.position + attachments_of(self._scenario)[0]

    @cached_property
    def _vectors(self) -> Strip:
        """From the hook to the ends (m), (rows, K, 3)."""
        return self._passage.ends - self._hook[:, None]

    @cached_property
    def lengths(self) -> Strip:
        """l_k (m), (rows, K)."""
        return norm(self._vectors)

    @cached_property
    def speeds(self) -> Strip:
        """dl_k/dt (m/s), (rows, K)."""
        passage = self._passage
        velocity = passage.velocity[:, None]
        away = passage.end_velocity - velocity if passage.rigging.moves else -velocity
        return dot(self._vectors, away) * self.lengths.inverse()

    @cached_property
    def tensions(self) -> Strip:
        """T_k with inertia (N), (rows, K)."""
        mass = self._scenario.payload.mass
        return self._balance(self._passage.acceleration * mass + self._weight)

    @cached_property
    def static(self) -> Strip:
        """T_k of a load at rest in the same place (N), (rows, K)."""
        return self._balance(Strip.still(self._weight[None]))

    @property
    def _weight(self) -> np.ndarray:
        return np.array([0.0, 0.0, self._scenario.payload.mass * GRAVITY])

    @cached_property
    def _facets(self) -> tuple[Strip, Strip]:
        """Of three cables: cross products of the two others, and one over their volume."""
        vectors = self._vectors
        facets = cross(vectors[:, _NEXT], vectors[:, _AFTER])
        return facets, dot(vectors[:, 0], facets[:, 0]).inverse()

    def _balance(self, force: Strip) -> Strip:
        """Tensions that balance a force (N): see `mechanics.statics.force_tensions`."""
        if self._passage.rigging.cables > 3:
            return shared(self._units, force, self._scenario.limits.tension)
        facets, per_volume = self._facets
        return self.lengths * dot(facets, force[:, None]) * per_volume[:, None]

    @cached_property
    def _units(self) -> Strip:
        """u_k, (rows, K, 3)."""
        return self._vectors * self.lengths.inverse()[..., None]

    @cached_property
    def ratio(self) -> Strip:
        """C_t = T_min/T_max with inertia, (rows, 1); nothing is known where T_max can be zero."""
        return _ratio(self.tensions)[:, None]

    @cached_property
    def tilt(self) -> Strip:
        """At which a hanging load rides the acceleration (°), (rows, 1)."""
        acceleration = self._passage.acceleration
        sideways = norm(acceleration[:, :2])
        return heading(acceleration[:, 2] + GRAVITY, sideways)[:, None] * (180 / np.pi)

    @cached_property
    def stability(self) -> Strip:
        """S_c of a load at rest, (rows, 1): see `mechanics.stability`."""
        scenario, tensions = self._scenario, self.static
        low, high = scenario.limits.tension
        top, floor = least(self._passage.ends[..., 2]), scenario.workspace.lower[2]
        below = (top - self._passage.position[:, 2]) * (top - floor).inverse()
        margins = least(stacked([least(tensions - low), least(high - tensions)]))
        first = least(self._inside()).cube_root() + _ratio(tensions).cube_root()
        second = below.cube_root() + (margins * (2 / (high - low))).cube_root()
        return (first * second * 0.25)[:, None]

    def _inside(self) -> Strip:
        """How far inside the polygon of the ends the hook is: 1 - ρ is the least of these."""
        passage, ends, hook = self._passage, self._passage.ends, self._hook[:, None, :2]
        if passage.rigging.cables > 3:
            if passage.rigging.moves:
                return _unknown(hook[..., 0])
            slopes, offsets = passage.course.gauge
            return dot(hook, slopes) + offsets
        one, two, three = ends[:, 0, :2], ends[:, 1, :2], ends[:, 2, :2]
        per_area = _wedge(two - one, three - one).inverse()
        shares = _wedge(ends[:, _NEXT, :2] - hook, ends[:, _AFTER, :2] - hook)
        return shares * per_area[:, None] * 3.0


def _ratio(tensions: Strip) -> Strip:
    return least(tensions) * (-least(-tensions)).inverse()


def _unknown(strip: Strip) -> Strip:
    return Strip(strip.middle, strip.slope, np.full_like(strip.middle, np.inf))


def _wedge(a: Strip, b: Strip) -> Strip:
    """a_x b_y - a_y b_x of vectors in the last axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
