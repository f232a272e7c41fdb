"""Violation counts against counts made by hand."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from padded import problem_of

import jaxsusp as js
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.problem import fitness
from jaxsusp.problem.constraints import count_violations
from jaxsusp.scenario.world import cast_world
from jaxsusp.suspension.levelload import tensions_at
from jaxsusp.vec3 import Vec3

waypoint_stability = jax.jit(fitness.waypoint_stability)


@jax.jit
def violations(problem: js.Problem, x: jax.Array) -> jax.Array:
    """The count alone, which compiles in a fraction of the time of all terms."""
    return problem.terms(x).violations


@jax.jit
def both_counts(problem: js.Problem, x: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Violations and collisions of candidates (dim, n)."""
    terms = problem.fitness.terms(x)
    return terms.violations, terms.collisions


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
    assert violations(problem_of(scenario), straight(scenario)) == expected


def test_every_sample_and_cable_outside_the_length_limits_counts(scenarios):
    scenario = variant(scenarios[0], cable_length=(7.0, 8.0))
    _, line = tensions_on_the_line(scenario)
    ends = np.array([robot.end for robot in scenario.robots])
    lengths = np.linalg.norm(ends[None] - (line + np.array([0, 0, 0.15]))[:, None], axis=-1)
    expected = ((lengths < 7) | (lengths > 8)).sum()
    assert expected > 0
    assert violations(problem_of(scenario), straight(scenario)) == expected


def test_the_workspace_may_be_left_by_a_millimetre(scenarios):
    problem = problem_of(scenarios[0], waypoints=1, samples=3)
    inside, outside = (violations(problem, np.array([x, 0.0, 2.0])) for x in (3.5009, 3.5011))
    assert outside - inside == 1


def test_the_stability_limit_counts_samples_and_zero_switches_it_off(scenarios):
    x = straight(scenarios[0])
    assert violations(problem_of(scenarios[0]), x) == 0
    limited = problem_of(variant(scenarios[0], stability=0.7))
    world = limited.fitness.world
    _, line = tensions_on_the_line(scenarios[0])
    factor = np.asarray(waypoint_stability(world, jnp.asarray(line.ravel())))
    expected = (factor < 0.7).sum()
    assert 0 < expected < 40
    assert violations(limited, x) == expected


def test_a_stack_with_a_stability_limit_changes_nothing_for_those_without(scenarios):
    """S_cmin = 0 means no limit even where S_c is checked for another scenario of the stack."""
    x = np.tile([3.4, 3.4, 5.4], 5).astype(np.float32)  # far outside: S_c = 0
    for checked in (False, True):
        counts = violations(problem_of(scenarios[0], with_stability=checked), x)
        reference = counts if not checked else reference
        assert counts == reference


@pytest.mark.fast
def test_a_singular_configuration_counts_as_a_violation(scenarios):
    """A load at the height of the ends: the cables are coplanar and no tension is finite."""
    problem = problem_of(scenarios[0])
    world = cast_world(problem.fitness.world, np.float64)
    at_ends = Vec3(jnp.asarray([0.3]), jnp.asarray([0.2]), jnp.asarray([7.0 - 0.15]))
    _, tensions = tensions_at(world, at_ends)
    assert not np.isfinite(np.array(tensions)).any()
    lengths = cable_lengths(cable_vectors(at_ends, world.bodies.attachments, world.bodies.ends))
    assert int(count_violations(world, at_ends, lengths, tensions, False)) == 3 + 1  # and too high


def test_what_single_precision_finds_admissible_is_so_in_double(scenarios):
    """Waypoints at the tension limit: no candidate that float32 passes is refused by float64."""
    rng = np.random.default_rng(0)
    problem = problem_of(scenarios[0], waypoints=1, samples=3)
    x = rng.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (20000, 3))
    x = np.float32(x.T)
    single, double = (both_counts(problem, x.astype(dtype)) for dtype in (np.float32, np.float64))
    for lenient, exact in zip(single, double, strict=True):
        clean = np.asarray(lenient) == 0
        assert clean.any()
        assert (np.asarray(exact)[clean] == 0).all()
