"""The least time in which a path can be driven within limits: a second-order cone programme.

Along a path the squared speed b(s) = ṡ² and the acceleration a = s̈ = b'(s)/2 decide all that limits
a motion without jerk: the acceleration p_s a + p_ss b and with it the forces in cables are affine
in (a, b), and the duration ∫ ds/√b is convex (Verscheure et al. 2009, IEEE TAC 54:2318). With a
constant between neighbouring places of a grid, b is linear there and the time an interval takes is
exactly 2 Δs/(√b₀ + √b₁). The optimum changes its acceleration in jumps: it is a bound for laws of
bounded jerk (`jerklimited`) and no law to drive with.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.trajectory.cones import Affine, Programme


class Demands(NamedTuple):
    """What limits a motion at places along a path; SI units, +inf where nothing limits it."""

    arc: Float[np.ndarray, "places"]  # m, rising
    along: Float[np.ndarray, "places xyz"]  # p_s, 1
    bend: Float[np.ndarray, "places xyz"]  # p_ss, 1/m
    twist: Float[np.ndarray, "places xyz"]  # p_sss, 1/m²
    square: Float[np.ndarray, "places"]  # greatest b, (m/s)²
    acceleration: float  # greatest norm, m/s²
    jerk: float  # greatest norm, m/s³
    snap: float  # greatest rate of s⃛, m/s⁴
    tilt: float  # greatest sideways acceleration per (g + upward acceleration)
    gravity: float  # m/s²
    faces: Float[np.ndarray, "places faces xyz"]  # kg: n · acceleration may be …
    room: Float[np.ndarray, "places faces"]  # … at most so much, N


class Profile(NamedTuple):
    """Squared speed and acceleration over arc length."""

    square: Float[np.ndarray, "places"]  # b, (m/s)²
    acceleration: Float[np.ndarray, "intervals"]  # a, m/s²
    duration: float  # s


def least_time(
    edges: Float[np.ndarray, "places"], demanded: Callable[[np.ndarray], Demands]
) -> Profile | None:
    """The fastest motion from rest to rest; None where no motion keeps the limits.

    Limits hold in the middle of every interval, with the acceleration that it has: to second order
    in its length. Speeds are counted in a unit in which they are of order one.

    Args:
        edges: of intervals along the path, from its start to its end (m).
        demanded: gives what limits the motion at arc lengths (m).
    """
    steps, demands = np.diff(edges), demanded((edges[1:] + edges[:-1]) / 2)
    unit = _unit_of_speed(demands)
    if not unit > 0:
        return None
    cones = Cones(demands, unit)
    count = len(steps)
    b = cones.variables(count + 1)
    c, d = cones.roots(b), cones.variables(count)
    cones.inverse_sums(d, c)
    a = b[1:] * (1 / (2 * steps)) + b[:-1] * (-1 / (2 * steps))
    cones.keep((b[1:] + b[:-1]) * 0.5, a, np.arange(count))
    found = cones.minimise(d * (2 * steps))
    if found is None:
        return None
    square = np.maximum(b.at(found), 0) * unit**2
    root = np.sqrt(square)
    time = float((2 * steps / (root[1:] + root[:-1])).sum())
    return Profile(square, np.diff(square) / (2 * steps), time)


def _unit_of_speed(demands: Demands) -> float:
    """A speed of the order of those that the limits allow (m/s): of a motion along a straight."""
    forward = (demands.faces * demands.along[:, None]).sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(forward > 0, demands.room / forward, np.inf)
    push = min(
        float(np.median(most.min(axis=1, initial=np.inf))),
        demands.acceleration,
        demands.tilt * demands.gravity,
        1e3 * demands.gravity,
    )
    length = float(demands.arc[-1] - demands.arc[0])
    return float(np.sqrt(min(max(push, 0) * length, np.nanmin(demands.square))))


class Cones(Programme):
    """A programme over the squared speed along a path, speeds counted in a unit of their own.

    Squared speeds and accelerations are both counted in the unit's square, so that b' = 2 a keeps
    its form.
    """

    def __init__(self, demands: Demands, unit: float):
        super().__init__()
        self.demands, self.unit = demands, unit

    def roots(self, b: Affine) -> Affine:
        """Variables c with c² <= b, and b = 0 at both ends."""
        c = self.variables(len(b))
        ends = np.array([0, len(b) - 1])
        self.equal(b[ends], 0.0)
        self.equal(c[ends], 0.0)
        inner = slice(1, -1)
        self.cone(b[inner] + 1.0, b[inner] + -1.0, c[inner] * 2.0)
        return c

    def inverse_sums(self, d: Affine, c: Affine) -> None:
        """Make d_i (c_i + c_{i+1}) >= 1."""
        both = c[1:] + c[:-1]
        self.cone(d + both, d + both * -1.0, d * 0.0 + 2.0)

    def keep(self, b: Affine, a: Affine, place: np.ndarray) -> None:
        """All limits but jerk, of rows of b and a at places of the grid."""
        demands, unit = self.demands, self.unit**2
        along, bend = demands.along[place], demands.bend[place]
        square = demands.square[place]
        bounded = np.isfinite(square)
        self.atmost(b[bounded], square[bounded] / unit)
        for face in range(demands.faces.shape[1]):
            normal, room = demands.faces[place, face], demands.room[place, face]
            size = np.maximum(np.abs(normal).sum(axis=1), 1e-300)
            forward, sideways = (normal * along).sum(axis=1), (normal * bend).sum(axis=1)
            self.atmost(a * (forward / size) + b * (sideways / size), room / size / unit)
        vector = [a * along[:, axis] + b * bend[:, axis] for axis in range(3)]
        if np.isfinite(demands.acceleration):
            self.cone(a * 0.0 + demands.acceleration / unit, *vector)
        if np.isfinite(demands.tilt):
            tilt = demands.tilt
            self.cone(vector[2] * tilt + tilt * demands.gravity / unit, *vector[:2])
