"""What a batch of runs found, whichever kind of optimiser made it."""

from typing import Any, NamedTuple

import numpy as np


class Outcome(NamedTuple):
    """Host arrays with leading axes (scenario, run)."""

    x: np.ndarray  # (S, R, D)
    fitness: np.ndarray  # (S, R)
    history: np.ndarray  # (S, R, T), best fitness after each iteration
    info: Any  # means over the iterations, each (S, R)
    seconds_compile: float
    seconds_run: float
