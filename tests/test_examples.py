"""The built-in examples load, and each of them has a plan without a violation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.workunit import stack_scenarios

PLANS = {
    "base-driven": [(-0.14, 1.76, 0.8), (1.34, 3.4, 0.8), (3.4, 2.67, 0.79)],
    "end-driven": [(-0.61, 1.42, 1.0), (-0.19, 3.28, 1.0), (1.61, 3.1, 0.99)],
    "four-robots": [(-1.527, 0.979, 1.533), (-0.642, 0.027, 2.518), (0.67, -0.754, 2.492)],
    "hybrid": [(-1.24, 0.14, 0.88), (0.02, -0.01, 0.97), (1.12, -0.1, 1.02)],
    "rim": [(-0.687, 0.253, 1.235), (-0.277, 0.272, 1.45), (0.379, 0.184, 1.71)],
    "six-robots": [(0.163, 1.231, 1.5), (0.352, 0.336, 2.06), (0.561, -0.797, 2.613)],
}
"""Waypoints that a search found."""


def test_there_is_an_example_of_every_kind():
    found = {name: js.load_scenario(name) for name in js.examples()}
    assert {s.drive for s in found.values()} == {"cable", "end", "base", "hybrid"}
    assert {len(s.robots) for s in found.values()} == {3, 4, 6}
    assert any(s.payload.attachments != "hook" for s in found.values())
    assert all(name == scenario.name for name, scenario in found.items())
    assert not set(found) & set(js.scenarios())


@pytest.mark.parametrize("name", js.examples())
def test_an_example_can_be_planned_and_its_straight_line_cannot(name):
    scenario = js.load_scenario(name)
    problem = js.Problem.from_scenario(scenario, waypoints=3, search="box")
    line = np.linspace(scenario.task.start, scenario.task.goal, 5)[1:-1]
    both = jnp.asarray([line.ravel(), np.ravel(PLANS[name])])
    terms = jax.jit(lambda suspension, x: suspension.terms(x.T))(problem.fitness, both)
    assert int(terms.collisions[0]) > 0
    assert (int(terms.collisions[1]), int(terms.violations[1])) == (0, 0)
    assert float(terms.total[1]) < 200


def test_systems_of_one_shape_share_a_program():
    chosen = [js.load_scenario(name) for name in (*js.examples(), "scenario-1", "scenario-6")]
    groups = stack_scenarios(chosen, waypoints=2, samples=8, search="box")
    assert [group.names for group in groups] == [
        ["base-driven"],
        ["end-driven"],
        ["four-robots"],
        ["hybrid"],
        ["rim"],
        ["six-robots"],
        ["scenario-1", "scenario-6"],
    ]


def test_more_robots_are_compared_like_three():
    ds = js.compare(["four-robots"], "pso", 1, 2, 4, search="box", samples=8)
    assert np.isfinite(ds["fitness"].values).all()


def test_what_cannot_be_planned_says_why():
    rim = js.load_scenario("rim")
    with pytest.raises(js.InputError, match='give drive = "cable", or attachments = "hook"'):
        js.Problem.from_scenario(rim.model_copy(update={"drive": "end"}))
    four = js.load_scenario("four-robots")
    ring = tuple((0.1 * x, 0.1 * y, 0.15) for x, y in ((1, 1), (-1, 1), (-1, -1), (1, -1)))
    separate = four.payload.model_copy(update={"attachments": ring})
    with pytest.raises(js.InputError, match="needs three robots, got 4"):
        js.Problem.from_scenario(four.model_copy(update={"payload": separate}))
