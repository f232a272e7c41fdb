"""Lists of obstacles that can be touched from where change no count, and spare most tests."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.geometry.collisions import Bodies, count_collisions
from jaxsusp.geometry.nearby import Nearby, count_nearby, nearby_of
from jaxsusp.geometry.obstacles import Obstacles, pack
from jaxsusp.problem import suspension
from jaxsusp.problem.problem import Problem, stack_problems
from jaxsusp.scenario.world import build_world, cast_world, obstacle_counts
from jaxsusp.vec3 import Vec3

LOWER, UPPER = Vec3(-3.5, -3.5, 0.2), Vec3(3.5, 3.5, 5.5)
MANY, SAMPLES, BATCH = 40, 12, 400


def drawn_obstacles(random: np.random.Generator) -> Obstacles:
    """As many of every kind, small ones anywhere, some of them beyond the workspace."""

    def rows(*sizes: float) -> np.ndarray:
        centers = random.uniform(-1, 1, (MANY, 3)) * [4, 4, 3] + [0, 0, 2.8]
        return np.column_stack([centers, *(random.uniform(0.02, s, MANY) for s in sizes)])

    boxes = np.column_stack([rows(0.3, 0.2, 0.6), random.uniform(-np.pi, np.pi, MANY)])
    return pack(boxes, rows(0.2, 0.8), rows(0.3), counts=(MANY + 10, MANY, MANY))


def drawn_bodies(random: np.random.Generator, cables: int, hook: bool) -> Bodies:
    angle = 2 * np.pi * np.arange(cables) / cables
    ends = Vec3(6 * np.cos(angle), 6 * np.sin(angle), random.uniform(6, 8, cables))
    held = np.array([[0, 0, 0.15]])
    if not hook:
        held = random.uniform(-0.1, 0.2, (cables, 3))
    sizes = (np.array(each) for each in (0.1, 0.15, 0.01, 0.05))
    return Bodies(*sizes, Vec3(*held.T), ends)


def drawn_ways(random: np.random.Generator, dtype: type) -> Vec3:
    """Polylines with steps of all lengths; some rest, leave the workspace, or are no numbers."""
    length = np.exp(random.uniform(np.log(0.01), np.log(2), BATCH))
    steps = random.normal(size=(SAMPLES, 3, BATCH)) * length
    begin = random.uniform(-1, 1, (3, BATCH)) * [[3.5], [3.5], [2.6]] + [[0], [0], [2.8]]
    way = begin + np.cumsum(steps, axis=0)
    way[4:6, :, :20] = way[4:5, :, :20]
    way[3, 1, 20] = np.nan
    way[:, :, 21] = 1e9
    return Vec3(*(jnp.asarray(way[:, i], dtype) for i in range(3)))


COUNT, COUNT_NEARBY = jax.jit(count_collisions), jax.jit(count_nearby)


@pytest.mark.parametrize(("cables", "hook", "dtype"), [(3, True, np.float32), (4, False, float)])
def test_the_count_is_that_of_all_tests(cables, hook, dtype):
    random = np.random.default_rng(cables)
    obstacles, bodies = drawn_obstacles(random), drawn_bodies(random, cables, hook)
    lists = nearby_of(bodies, obstacles, LOWER, UPPER)
    given = cast_world((bodies, obstacles), dtype)
    for _ in range(5):
        ways = drawn_ways(random, dtype)
        expected = np.asarray(COUNT(ways, *given))
        assert expected.max() > 30
        assert (expected == 0).any()
        found = COUNT_NEARBY(ways, *given, cast_world(lists, dtype))
        np.testing.assert_array_equal(found, expected)
    empty = cast_world(lists._replace(first=np.zeros_like(lists.first)), dtype)
    assert (COUNT_NEARBY(ways, *given, empty) == 0).all()  # the lists are all that is looked at
    finest = np.diff(lists.first, axis=-1)[..., : 32**3].mean(axis=-1)
    assert finest.max() < MANY / 6
    assert (lists.first[..., -1] - lists.first[..., -2] == MANY).all()  # elsewhere, all


def without_lists(problem: Problem) -> Problem:
    return problem.with_fitness(replace(problem.fitness, nearby=None))


@pytest.fixture
def crowded(monkeypatch) -> list[Problem]:
    """Two scenes of six and ten obstacles, as if they were many."""
    monkeypatch.setattr(suspension, "FEW", 5)
    scenes = [js.load_scenario(name) for name in ("scenario-1", "scenario-5")]
    counts = obstacle_counts(scenes)
    return [
        Problem.from_scenario(scene, search="box", world=build_world(scene, counts))
        for scene in scenes
    ]


def test_the_fitness_is_the_same_to_the_bit_where_scenes_are_stacked(crowded):
    x, stacked = crowded[0].sample(jax.random.key(1), 60), stack_problems(crowded)
    assert len(stacked.fitness.nearby.numbers) == 2
    found = jax.jit(jax.vmap(Problem.evaluate, in_axes=(0, None)))(stacked, x)
    every = jax.jit(Problem.evaluate)
    for row, alone in zip(found, crowded, strict=True):
        np.testing.assert_array_equal(row, every(without_lists(alone), x))
    mixed = stack_problems([crowded[0], without_lists(crowded[1])])
    assert mixed.fitness.nearby is None


def test_gradients_pass_by_the_lists(crowded):
    problem = crowded[0]
    assert isinstance(problem.fitness.nearby, Nearby)
    x = problem.sample(jax.random.key(2), 1)[0]
    slopes = [jax.jit(jax.grad(p.fitness))(x) for p in (problem, without_lists(problem))]
    np.testing.assert_allclose(*slopes, rtol=1e-12)
    assert np.isfinite(slopes[0]).all()
    assert slopes[0].any()


def test_few_obstacles_and_moving_ends_have_none():
    assert Problem.from_scenario("scenario-6", search="box").fitness.nearby is None
    assert Problem.from_scenario("base-driven", search="box").fitness.nearby is None
