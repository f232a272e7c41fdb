"""Polishing: never worse, near the optimum where there is a gradient, and counted."""

import functools
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import jaxsusp as js
from jaxsusp.optim.polish import EVALUATIONS, GRADIENT, STEPS, polish
from jaxsusp.problem.search import Polytopes
from jaxsusp.vec3 import Vec3


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Valley:
    """Rosenbrock's function or a quadratic, whose faults are arguments: one program for all."""

    bend: Any  # of the valley: 0 for a quadratic
    wall: Any  # NaN where x[0] is more
    hole: Any  # -inf where x[0] is less

    def __call__(self, x):
        bend, wall, hole = (
            jnp.asarray(each, x.dtype) for each in (self.bend, self.wall, self.hole)
        )
        value = ((1 - x) ** 2).sum() + 100 * bend * ((x[1:] - x[:-1] ** 2) ** 2).sum()
        return jnp.where(x[0] > wall, jnp.nan, jnp.where(x[0] < hole, -jnp.inf, value))


NONE = np.float64(np.inf)
quadratic = Valley(np.float64(0), NONE, -NONE)
rosenbrock = Valley(np.float64(1), NONE, -NONE)
WALLS = [  # of a box of three metres about (-0.5, …, -0.5), as regions are stated
    [*row, row @ np.full(3, -0.5)] for row in np.concatenate([np.eye(3), -np.eye(3)]) / 1.5
]
REGIONS = Polytopes(np.array([WALLS]), Vec3(*np.full((3, 1), -0.5)))


def problem(function, dtype=np.float64, regions=None) -> js.Problem:
    return js.Problem(function, np.full(6, -2, dtype), np.full(6, 2, dtype), regions=regions)


def starts(count: int = 8, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2, 2, (count, 6))


def values(function, x: np.ndarray) -> np.ndarray:
    """Fitness as a search ranks it."""
    found = np.array(problem(function).evaluate(jnp.asarray(x)))
    assert not np.isnan(found).any()
    return found


@given(
    seed=st.integers(0, 2**16),
    function=st.builds(
        lambda bend, wall, hole: Valley(*map(np.float64, (bend, wall, hole))),
        st.sampled_from([0, 1, 1e6]),
        st.floats(-2.5, 2.5) | st.just(np.inf),
        st.floats(-2.5, 0.5) | st.just(-np.inf),
    ),
    confined=st.booleans(),
)
@settings(deadline=None, max_examples=60)
def test_nothing_gets_worse_or_leaves_its_bounds(seed, function, confined):
    """Also beside and within regions of NaN and of -inf, which are no values."""
    searched = problem(function, regions=REGIONS if confined else None)
    x = np.array(searched.repair(jnp.asarray(starts(seed=seed))))
    found = polish(searched, x)
    before, after = values(function, x), values(function, found)
    assert (after <= before * (1 + 1e-12)).all()
    assert (np.abs(found) <= 2).all()
    if confined:
        assert (found <= 1 + 1e-12).all()


def test_a_quadratic_is_minimised():
    x = polish(problem(quadratic), starts())
    assert values(quadratic, x).max() < 1e-8


def test_the_valley_of_rosenbrock_is_followed_to_its_end():
    before = values(rosenbrock, starts())
    after = values(rosenbrock, polish(problem(rosenbrock), starts()))
    assert before.min() > 10
    assert np.median(after) < 0.3
    assert after.max() < 5, "in six dimensions there is a second, local optimum at about 4"


def test_the_end_may_be_at_a_bound_of_a_region():
    """The optimum lies outside; the nearest admissible point is the corner."""
    confined = problem(quadratic, regions=REGIONS)
    x = polish(confined, np.array(confined.repair(jnp.asarray(starts()))))
    assert values(quadratic, x).max() < 1e-3


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_run_does_not_depend_on_the_others(dtype):
    x = starts().astype(dtype)
    together = polish(problem(rosenbrock, dtype), x)
    assert together.dtype == dtype
    backwards = polish(problem(rosenbrock, dtype), x[::-1].copy())[::-1]
    np.testing.assert_array_equal(backwards, together)
    others = np.concatenate([x[:1], np.full((7, 6), np.nan, dtype)])
    np.testing.assert_array_equal(polish(problem(rosenbrock, dtype), others)[0], together[0])


def test_alone_it_is_the_same_to_rounding():
    """One run is another program; rounding moves it along the valley, hardly its value."""
    together = values(quadratic, polish(problem(quadratic), starts()))
    alone = values(quadratic, polish(problem(quadratic), starts()[:1]))
    np.testing.assert_allclose(alone, together[:1], atol=1e-9)


@jax.tree_util.register_dataclass
@dataclass(frozen=True, eq=False)
class Counting:
    """A paraboloid that notes at run time how many points it is asked for, and for what."""

    seen: Counter = field(metadata={"static": True})

    def __call__(self, x):
        return (x**2).sum()

    def population(self, x):
        self.note("fitness", x)
        return (x**2).sum(axis=1)

    def twin(self, x, band):
        @jax.custom_vjp
        def value(x):
            self.note("twin", x)
            return (x**2).sum(axis=1)

        def forward(x):
            self.note("gradient", x)
            return (x**2).sum(axis=1), x

        value.defvjp(forward, lambda x, cotangent: (2 * x * cotangent[:, None],))
        return value(x)

    def note(self, name, x):
        jax.debug.callback(functools.partial(self.seen.update, {name: len(x)}))


class Seen(Counter):
    """Counts that a compiled program may hold."""

    __hash__ = object.__hash__


def test_what_it_costs_is_what_it_evaluates():
    """Counted while it runs: gradients, and all points that are tried or looked at in the end."""
    seen = Seen()
    polish(problem(Counting(seen)), starts(2))
    jax.effects_barrier()
    assert seen["gradient"] == 2 * STEPS
    assert GRADIENT * seen["gradient"] + seen["twin"] + seen["fitness"] == 2 * EVALUATIONS


@pytest.mark.fast
def test_a_search_is_polished_where_it_is_asked_for():
    """History stays; what is polished is not worse, and counted."""
    settings = {"runs": 8, "iterations": 20, "population": 10}
    plain = js.minimize(problem(rosenbrock), "pso", **settings)
    polished = js.minimize(problem(rosenbrock), "pso", **settings, polish=True)
    assert polished.evaluations == plain.evaluations + EVALUATIONS
    np.testing.assert_array_equal(polished.history, plain.history)
    np.testing.assert_array_equal(plain.fitness, plain.history[:, -1])
    assert (polished.fitness < plain.fitness).all()
    np.testing.assert_allclose(values(rosenbrock, polished.x), polished.fitness, rtol=1e-9)


def test_a_suspension_is_polished_in_single_precision_and_stays_clear(scenarios):
    """Along the gradient of the twin, waypoints kept in the free space; boxes alone, to compile."""
    boxes = tuple(each for each in scenarios[0].obstacles if each.kind == "box")
    scenario = scenarios[0].model_copy(update={"obstacles": boxes})
    searched = js.Problem.from_scenario(scenario, 3, 20, dtype=np.float32)
    x = np.array(searched.sample(jax.random.key(0), 6))
    found = polish(searched, x)
    before, after = (np.array(searched.evaluate(jnp.asarray(each))) for each in (x, found))
    assert (after <= before).all()
    assert (after < 0.5 * before).any()
    exactly = js.Problem.from_scenario(scenario, 3, 20, dtype=np.float64)
    clear = after < scenario.fitness.kappa
    assert clear.any()
    assert exactly.evaluate(jnp.asarray(found, np.float64))[clear].max() < scenario.fitness.kappa
