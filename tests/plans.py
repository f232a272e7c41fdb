"""Waypoints of two good plans, found once, so that tests of plans need no search."""

import numpy as np

LOW = np.array(
    [
        [-0.103, 1.729, 1.346],
        [-0.217, 1.420, 1.742],
        [-0.320, 0.919, 2.283],
        [-0.171, -0.166, 2.944],
        [0.062, -1.174, 3.158],
    ]
)
"""Of scenario-1."""

HIGH = np.array(
    [
        [-1.212, 1.575, 3.134],
        [-0.592, 0.710, 3.357],
        [-0.250, 0.029, 3.356],
        [-0.027, -0.519, 3.349],
        [0.479, -1.421, 3.454],
    ]
)
"""Of scenario-6."""
