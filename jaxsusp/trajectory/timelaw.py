"""When the load is where: a smooth path driven from rest to rest (Fig. 8)."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from jaxsusp._types import Float
from jaxsusp.trajectory.smoothpath import SmoothPath


class Motion(NamedTuple):
    """Position and its derivatives with respect to time (m, m/s, m/s², m/s³)."""

    position: Float[np.ndarray, "times xyz"]
    velocity: Float[np.ndarray, "times xyz"]
    acceleration: Float[np.ndarray, "times xyz"]
    jerk: Float[np.ndarray, "times xyz"]


def minimum_jerk(share: Float[np.ndarray, "times"]) -> tuple[np.ndarray, ...]:
    """The rest-to-rest law of least jerk and its first three derivatives.

    s(τ) = 10 τ³ - 15 τ⁴ + 6 τ⁵ (Flash & Hogan 1985): velocity and acceleration vanish at both
    ends, and the greatest speed is 15/8 of the mean.

    Args:
        share: τ, elapsed time over duration, in [0, 1].

    Returns:
        s, ds/dτ, d²s/dτ², d³s/dτ³.
    """
    t = share
    return (
        t**3 * (10 + t * (6 * t - 15)),
        30 * t**2 * (1 - t) ** 2,
        60 * t * (1 - t) * (1 - 2 * t),
        60 + 360 * t * (t - 1),
    )


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """A path by arc length, driven with the minimum-jerk law.

    Args:
        path: where the load goes.
        duration: time from rest to rest (s).
    """

    path: SmoothPath
    duration: float

    @classmethod
    def through(cls, points: Float[np.ndarray, "samples xyz"], duration: float) -> "TimeLaw":
        """The law of the smooth path through given points (m)."""
        return cls(SmoothPath(points), duration)

    def at(self, times: Float[np.ndarray, "times"]) -> Motion:
        """Where the load is and how it moves at given times (s), at rest before and after.

        With σ = |p'| and s the arc length, u follows from σ u̇ = ṡ and its derivatives.
        """
        share = np.clip(np.asarray(times, np.float64) / self.duration, 0, 1)
        moving = (share == times / self.duration).astype(np.float64)
        _, *rates = minimum_jerk(share)
        length, u = self.path.length, self.parameter(times)
        s1, s2, s3 = (
            moving * length * rate / self.duration ** (order + 1)
            for order, rate in enumerate(rates)
        )
        p1, p2, p3 = (derivative(u) for derivative in self.path.derivatives)
        speed = np.maximum(np.linalg.norm(p1, axis=-1), 1e-9)
        along = _rows(p1, p2) / speed  # dσ/du
        bend = (_rows(p2, p2) + _rows(p1, p3) - along**2) / speed  # d²σ/du²
        u1 = s1 / speed
        u2 = (s2 - along * u1**2) / speed
        u3 = (s3 - bend * u1**3 - 3 * along * u1 * u2) / speed
        u1, u2, u3 = u1[:, None], u2[:, None], u3[:, None]
        return Motion(
            self.path.curve(u),
            p1 * u1,
            p1 * u2 + p2 * u1**2,
            p1 * u3 + 3 * p2 * u1 * u2 + p3 * u1**3,
        )

    def parameter(self, times: Float[np.ndarray, "times"]) -> Float[np.ndarray, "times"]:
        """Where on the path, by its parameter u, the load is at given times (s)."""
        share = np.clip(np.asarray(times, np.float64) / self.duration, 0, 1)
        return self.path.parameter(self.path.length * minimum_jerk(share)[0])

    @cached_property
    def _clock(self) -> tuple[np.ndarray, np.ndarray]:
        share = np.linspace(0, 1, 20001)
        return minimum_jerk(share)[0], share

    def time_of(self, u: Float[np.ndarray, "*batch"] | float) -> Float[np.ndarray, "*batch"]:
        """The time (s) at which the load passes parameter u of the path, to within 1 ms."""
        reached = np.asarray(self.path.arc(np.asarray(u))) / max(self.path.length, 1e-12)
        return np.asarray(self.duration * np.interp(reached, *self._clock))


def _rows(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return (a * b).sum(axis=-1)
