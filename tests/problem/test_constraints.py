"""Violation counts against counts made by hand."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.problem.constraints import count_violations
from jaxsusp.problem.fitness import waypoint_stability
from jaxsusp.scenario.world import cast_world
from jaxsusp.suspension.levelload import tensions_at
from jaxsusp.vec3 import Vec3


def variant(scenario: js.Scenario, **limits) -> js.Scenario:
    return scenario.model_copy(update={"limits": scenario.limits.model_copy(update=limits)})


def straight(scenario):
    return np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1].ravel()


def tensions_on_the_line(scenario):
    line = np.linspace(scenario.task.start, scenario.task.goal, 40)
    return np.asarray(js.tensions(scenario, line)), line


@pytest.mark.parametrize("limit", [(1.0, 35.0), (30.0, 100.0)])
def test_every_sample_and_cable_outside_the_tension_limits_counts(scenarios, limit):
    scenario = variant(scenarios[0], tension=limit)
    tensions, _ = tensions_on_the_line(scenario)
    expected = ((tensions < limit[0]) | (tensions > limit[1])).sum()
    assert expected > 0
    assert (
        int(js.Problem.from_scenario(scenario, search="box").terms(straight(scenario)).violations)
        == expected
    )


def test_every_sample_and_cable_outside_the_length_limits_counts(scenarios):
    scenario = variant(scenarios[0], cable_length=(7.0, 8.0))
    _, line = tensions_on_the_line(scenario)
    ends = np.array([robot.end for robot in scenario.robots])
    lengths = np.linalg.norm(ends[None] - (line + np.array([0, 0, 0.15]))[:, None], axis=-1)
    expected = ((lengths < 7) | (lengths > 8)).sum()
    assert expected > 0
    assert (
        int(js.Problem.from_scenario(scenario, search="box").terms(straight(scenario)).violations)
        == expected
    )


def test_the_workspace_may_be_left_by_a_millimetre(scenarios):
    problem = js.Problem.from_scenario(scenarios[0], waypoints=1, samples=3, search="box")
    inside = problem.terms(jnp.asarray([3.5009, 0.0, 2.0]))
    outside = problem.terms(jnp.asarray([3.5011, 0.0, 2.0]))
    assert int(outside.violations) - int(inside.violations) == 1


def test_the_stability_limit_counts_samples_and_zero_switches_it_off(scenarios):
    x = straight(scenarios[0])
    unlimited = js.Problem.from_scenario(scenarios[0], search="box")
    assert int(unlimited.terms(x).violations) == 0
    limited = js.Problem.from_scenario(variant(scenarios[0], stability=0.7), search="box")
    world = limited.fitness.world
    _, line = tensions_on_the_line(scenarios[0])
    factor = np.asarray(waypoint_stability(world, jnp.asarray(line.ravel())))
    expected = (factor < 0.7).sum()
    assert 0 < expected < 40
    assert int(limited.terms(x).violations) == expected


def test_a_stack_with_a_stability_limit_changes_nothing_for_those_without(scenarios):
    """S_cmin = 0 means no limit even where S_c is checked for another scenario of the stack."""
    x = np.tile([3.4, 3.4, 5.4], 5).astype(np.float32)  # far outside: S_c = 0
    for checked in (False, True):
        problem = js.Problem.from_scenario(scenarios[0], with_stability=checked, search="box")
        counts = int(problem.terms(x).violations)
        reference = counts if not checked else reference
        assert counts == reference


def test_a_singular_configuration_counts_as_a_violation(scenarios):
    """A load at the height of the ends: the cables are coplanar and no tension is finite."""
    problem = js.Problem.from_scenario(scenarios[0], search="box")
    world = cast_world(problem.fitness.world, np.float64)
    at_ends = Vec3(jnp.asarray([0.3]), jnp.asarray([0.2]), jnp.asarray([7.0 - 0.15]))
    _, tensions = tensions_at(world, at_ends)
    assert not np.isfinite(np.array(tensions)).any()
    lengths = cable_lengths(cable_vectors(at_ends, world.bodies.attachments, world.bodies.ends))
    assert int(count_violations(world, at_ends, lengths, tensions, False)) == 3 + 1  # and too high


def test_what_single_precision_finds_admissible_is_so_in_double(scenarios):
    """Waypoints at the tension limit: no candidate that float32 passes is refused by float64."""
    rng = np.random.default_rng(0)
    problem = js.Problem.from_scenario(scenarios[0], waypoints=1, samples=3, search="box")
    x = rng.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (20000, 3))
    terms = jax.jit(problem.fitness.terms)
    single, double = (terms(jnp.asarray(np.float32(x.T), d)) for d in (jnp.float32, jnp.float64))
    for name in ("violations", "collisions"):
        clean = np.asarray(getattr(single, name)) == 0
        assert clean.any()
        assert (np.asarray(getattr(double, name))[clean] == 0).all()
