"""Problems of one shape: one compiled program serves all scenarios, and variants of them."""

import jax

import jaxsusp as js
from jaxsusp.scenario.world import build_world

COUNTS = (6, 3, 1)
"""Places that hold the obstacles of each of the six scenarios."""

terms = jax.jit(js.Problem.terms)


def problem_of(scenario: js.Scenario, **settings) -> js.Problem:
    """Its waypoints anywhere in the workspace."""
    world = build_world(scenario, COUNTS)
    return js.Problem.from_scenario(scenario, search="box", world=world, **settings)
