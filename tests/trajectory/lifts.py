"""What limits the motion along simple paths, made by hand."""

import numpy as np

from jaxsusp.trajectory.fastest import Demands
from jaxsusp.trajectory.smoothpath import SmoothPath

GRAVITY = 9.81


def demands_of(path: SmoothPath, arc: np.ndarray, **limits) -> Demands:
    """Of a path with the limits that are given and no others."""
    places = len(arc)
    nothing = {
        "square": np.full(places, np.inf), "acceleration": np.inf, "jerk": np.inf,
        "snap": np.inf, "tilt": np.inf, "gravity": GRAVITY,
        "faces": np.zeros((places, 0, 3)), "room": np.zeros((places, 0)),
    }  # fmt: skip
    return Demands(arc, *path.by_arc(path.parameter(arc)), **{**nothing, **limits})


def straight(length: float) -> SmoothPath:
    """Straight up."""
    return SmoothPath(np.linspace([0.0, 0.0, 1.0], [0.0, 0.0, 1.0 + length], 6))


def winding(seed: int) -> SmoothPath:
    """A smooth way of some metres."""
    turns = np.random.default_rng(seed).normal(size=(2, 3, 3))
    s = np.linspace(0, 1, 30)[:, None]
    waves = sum(turns[0, i] * np.sin((i + 1) * np.pi * s) / (i + 1) for i in range(3))
    return SmoothPath(3 * s * turns[1, 0] + waves)
