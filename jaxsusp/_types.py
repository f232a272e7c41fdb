"""Axis names that mean the same thing in every signature of the package.

`runs` independent repetitions, `pop` members of a population, `dim` decision variables (D = 3m),
`samples` points of a trajectory in time, `cables` (one per robot, K), `waypoints` (m), `xyz`
Cartesian coordinates, `boxes`/`cylinders`/`spheres` obstacles of one kind. `*batch` is any number
of trailing candidate axes: wherever it appears, time (or the waypoint, or the cable) comes first
and the candidates come last, so that XLA's inner loop runs over candidates.
"""

import jax
import numpy as np
from jaxtyping import Bool, Float, Int, Key

Array = jax.Array | np.ndarray
"""Host arrays are welcome wherever device arrays are."""

__all__ = ["Array", "Bool", "Float", "Int", "Key"]
