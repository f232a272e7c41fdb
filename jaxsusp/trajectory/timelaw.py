"""When the load is where: a smooth path driven from rest to rest (Fig. 8)."""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly, PPoly

from jaxsusp._types import Float
from jaxsusp.trajectory.smoothpath import SmoothPath


class Motion(NamedTuple):
    """Position and its derivatives with respect to time (m, m/s, m/s², m/s³)."""

    position: Float[np.ndarray, "times xyz"]
    velocity: Float[np.ndarray, "times xyz"]
    acceleration: Float[np.ndarray, "times xyz"]
    jerk: Float[np.ndarray, "times xyz"]


def minimum_jerk_law(length: float, duration: float) -> PPoly:
    """The rest-to-rest law of least jerk, one piece of degree 5: arc length (m) over time (s).

    s(τ) = 10 τ³ - 15 τ⁴ + 6 τ⁵ of the length (Flash & Hogan 1985): velocity and acceleration vanish
    at both ends, and the greatest speed is 15/8 of the mean.

    Args:
        length: of the path (m).
        duration: time from rest to rest (s).
    """
    powers = np.array([6.0, -15.0, 10.0, 0.0, 0.0, 0.0])
    scale = length / duration ** np.arange(5.0, -1.0, -1.0)
    return PPoly((powers * scale)[:, None], np.array([0.0, duration]), extrapolate=False)


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """A path by arc length, driven from rest to rest by a piecewise polynomial law.

    Args:
        path: where the load goes.
        law: arc length s(t) (m) over time (s): from 0 at time 0 to the path's length at the end,
            never back, C2, at rest and without acceleration at both ends.
    """

    path: SmoothPath
    law: PPoly

    @classmethod
    def least_jerk(cls, path: SmoothPath, duration: float) -> "TimeLaw":
        """A path driven with the minimum-jerk law: one piece of degree 5."""
        return cls(path, minimum_jerk_law(path.length, duration))

    @classmethod
    def through(cls, points: Float[np.ndarray, "samples xyz"], duration: float) -> "TimeLaw":
        """The smooth path through given points (m), driven with the minimum-jerk law."""
        return cls.least_jerk(SmoothPath(points), duration)

    @classmethod
    def passing(
        cls,
        path: SmoothPath,
        times: Float[np.ndarray, "breaks"],
        arc: Float[np.ndarray, "breaks"],
        speed: Float[np.ndarray, "breaks"],
        acceleration: Float[np.ndarray, "breaks"],
    ) -> "TimeLaw":
        """The law in pieces of degree 5 that passes given states: arc length, ṡ and s̈ (SI).

        Two states and the time between them decide such a piece, so that the law is C2 whatever
        the states are; least jerk is the piece between two states of rest.
        """
        states = np.stack([arc, speed, acceleration], axis=1)
        law = PPoly.from_bernstein_basis(BPoly.from_derivatives(times, states, orders=5))
        return cls(path, PPoly(law.c, law.x, extrapolate=False))

    @property
    def states(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Times of the breaks, with the arc length, ṡ and s̈ there (SI), see `passing`."""
        times = self.law.x
        arc, speed, acceleration = (np.asarray(self.law(times, nu=order)) for order in range(3))
        return times, arc, speed, acceleration

    @property
    def duration(self) -> float:
        """Time from rest to rest (s)."""
        return float(self.law.x[-1])

    def restated(self, path: SmoothPath, length: float, time: float) -> "TimeLaw":
        """The same motion in other units.

        Args:
            path: the path in these units.
            length: what an arc length is multiplied by.
            time: what a time is multiplied by.
        """
        powers = np.arange(len(self.law.c) - 1, -1, -1.0)[:, None]
        law = PPoly(self.law.c * length / time**powers, self.law.x * time, extrapolate=False)
        return TimeLaw(path, law)

    def at(self, times: Float[np.ndarray, "times"]) -> Motion:
        """Where the load is and how it moves at given times (s), at rest before and after."""
        times = np.asarray(times, np.float64)
        inside = np.clip(times, 0, self.duration)
        moving = (inside == times).astype(np.float64)
        s1, s2, s3 = ((moving * self.law(inside, nu=order))[:, None] for order in (1, 2, 3))
        u = self.parameter(inside)
        along, bend, twist = self.path.by_arc(u)
        return Motion(
            self.path.curve(u),
            along * s1,
            along * s2 + bend * s1**2,
            along * s3 + 3 * bend * s1 * s2 + twist * s1**3,
        )

    def parameter(self, times: Float[np.ndarray, "times"]) -> Float[np.ndarray, "times"]:
        """Where on the path, by its parameter u, the load is at given times (s)."""
        inside = np.clip(np.asarray(times, np.float64), 0, self.duration)
        return self.path.parameter(np.clip(self.law(inside), 0, self.path.length))

    @cached_property
    def _clock(self) -> tuple[np.ndarray, np.ndarray]:
        times = np.linspace(0, self.duration, 20001)
        return np.maximum.accumulate(self.law(times)), times

    def time_of(self, u: Float[np.ndarray, "*batch"] | float) -> Float[np.ndarray, "*batch"]:
        """The time (s) at which the load passes parameter u of the path, to within 1 ms."""
        return np.asarray(np.interp(np.asarray(self.path.arc(np.asarray(u))), *self._clock))
