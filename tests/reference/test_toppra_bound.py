"""The least time on a path against toppra, which finds it by reachability (Pham and Pham 2018).

Accelerations are limited along the axes, on paths that wind.
"""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from toppra.algorithm import TOPPRA
from toppra.constraint import DiscretizationType, JointAccelerationConstraint
from toppra.interpolator import AbstractGeometricPath

from jaxsusp.trajectory.fastest import Demands, least_time
from jaxsusp.trajectory.smoothpath import SmoothPath

MOST = np.array([0.5, 0.7, 0.4])
"""m/s² along x, y and z."""


class ByArc(AbstractGeometricPath):
    """One of our paths by its arc length, as toppra wants it."""

    def __init__(self, path: SmoothPath):
        self.path = path

    @property
    def dof(self):
        """Coordinates."""
        return 3

    @property
    def path_interval(self):
        """First and last arc length."""
        return np.array([0.0, self.path.length])

    def __call__(self, path_positions, order=0):
        """The curve or one of its derivatives."""
        arc = np.atleast_1d(path_positions)
        u = self.path.parameter(arc)
        found = self.path.curve(u) if order == 0 else self.path.by_arc(u)[order - 1]
        return found if np.ndim(path_positions) else found[0]


def winding(seed: int) -> SmoothPath:
    points = np.random.default_rng(seed).uniform(-2, 2, (6, 3))
    return SmoothPath(CubicSpline(np.arange(6), points)(np.linspace(0, 5, 40)))


def demands_of(path: SmoothPath, arc: np.ndarray) -> Demands:
    faces = np.concatenate([np.eye(3), -np.eye(3)])
    return Demands(
        arc, *path.by_arc(path.parameter(arc)), np.full(len(arc), np.inf), np.inf, np.inf, np.inf,
        np.inf, 9.81, np.tile(faces, (len(arc), 1, 1)), np.tile([*MOST, *MOST], (len(arc), 1)),
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(5))
def test_the_bound_is_toppras(seed):
    path = winding(seed)
    limits = JointAccelerationConstraint(
        np.stack([-MOST, MOST], axis=1), discretization_scheme=DiscretizationType.Collocation
    )
    grid = np.linspace(0, path.length, 4001)
    theirs = TOPPRA([limits], ByArc(path), gridpoints=grid, parametrizer="ParametrizeConstAccel")
    found = theirs.compute_trajectory(0, 0)
    ours = least_time(np.linspace(0, path.length, 801), lambda arc: demands_of(path, arc))
    assert found is not None
    assert ours is not None
    assert ours.duration == pytest.approx(found.duration, rel=1e-3)
