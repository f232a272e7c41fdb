"""A problem for what all searches do with a suspension; quick to compile, and so only once."""

from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

import jaxsusp as js
from jaxsusp.problem.suspension import Suspension

SIZES = {"runs": 2, "iterations": 5, "population": 10}


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Drawn:
    """A fitness that draws every waypoint to a place of its own.

    S_c, by which SDBO moves, is the suspension's own.
    """

    suspension: Suspension
    goal: Any

    def __call__(self, x: jax.Array) -> jax.Array:
        return ((x - self.goal) ** 2).sum()

    def stability(self, x: jax.Array) -> jax.Array:
        return self.suspension.stability(x)


def drawn(scenario: js.Scenario, goal: np.ndarray | None = None) -> js.Problem:
    """In the free space, to places (waypoints, 3); without any to the straight line."""
    problem = js.Problem.from_scenario(scenario, dtype=np.float32)
    goal = problem.reference if goal is None else np.float32(goal).ravel()
    return problem.with_fitness(Drawn(problem.fitness, goal))
