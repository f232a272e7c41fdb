"""Fresh scenes: blocked, solvable, the same for the same seed, and admissible files."""

import jax
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.cells.forbidden import Errand, forbidden_of
from jaxsusp.freespace.cells.passage import narrowest_place
from jaxsusp.scenario.world import build_world
from jaxsusp.studies import random_scenario
from jaxsusp.studies.narrowing import ENDS, POSTS
from jaxsusp.studies.random_scenario import _range_of, blocked, passable, solvable


@jax.jit
def collisions(problem: js.Problem, x: jax.Array) -> jax.Array:
    return problem.terms(x).collisions


@pytest.fixture(scope="module", params=[(0, 3), (2, 10)], ids=str)
def scene(request) -> js.Scenario:
    return js.random_scenario(*request.param)


def test_it_is_blocked_and_solvable(scene):
    assert blocked(scene)
    assert solvable(scene)
    world = build_world(scene, (10, 10, 10))
    problem = js.Problem.from_scenario(scene, search="box", world=world)
    line = np.linspace(scene.task.start, scene.task.goal, 7)[1:-1].reshape(-1)
    assert int(collisions(problem, line)) > 0


def test_it_tells_how_narrow_it_is(scene):
    """A trajectory without collisions exists, so there is some room."""
    found = js.passage(scene, js.free_space(scene, coverage=0.1))
    assert found.width > 0
    assert found.only in (True, False)


def test_it_is_a_file_like_any_other(scene, tmp_path):
    path = tmp_path / f"{scene.name}.toml"
    path.write_text(scene.to_toml())
    assert js.load_scenario(path) == scene
    assert {obstacle.kind for obstacle in scene.obstacles} <= {"box", "cylinder", "sphere"}


def test_a_seed_gives_one_scene():
    first, again, other = (js.random_scenario(seed, 3) for seed in (2, 2, 4))
    assert first == again
    assert first.obstacles != other.obstacles
    assert len(other.obstacles) == 3


def test_scenes_are_those_of_ever():
    """Best known values are kept by a scene's whole content."""
    assert js.best_known(js.random_scenario(0, 5)) is not None


@pytest.mark.parametrize(
    ("seed", "obstacles", "robots", "passage"),
    [(1, 6, 4, (0.1, 0.3)), (0, 2, 3, (0.2, 0.4)), (0, 12, 3, (0.4, 0.8))],
)
def test_robots_and_passage_are_as_asked(seed, obstacles, robots, passage):
    """What is narrow lies between start and goal, by the wall, and not at one of them."""
    scene = js.random_scenario(seed, obstacles, robots=robots, passage=passage)
    low, high = passage
    assert scene.name == f"random-{seed}-{obstacles}-robots-{robots}-passage-{low}-{high}"
    assert (len(scene.robots), len(scene.obstacles)) == (robots, obstacles)
    forbidden, errand = forbidden_of(scene), Errand.of(scene)
    found = narrowest_place(forbidden, errand)
    assert low <= 2 * found.room <= high
    assert forbidden.least(np.array([scene.task.start, scene.task.goal])).min() > ENDS * high
    if len(scene.obstacles) == POSTS:
        for post in range(POSTS):  # neither alone makes it narrow
            alone = scene.model_copy(update={"obstacles": scene.obstacles[post : post + 1]})
            assert 2 * narrowest_place(forbidden_of(alone), errand).room > high
    assert blocked(scene)
    assert passable(scene, found.ways)


@pytest.mark.fast
def test_a_width_that_no_scene_has_is_told(monkeypatch):
    monkeypatch.setattr(random_scenario, "ATTEMPTS", 1)
    monkeypatch.setattr(random_scenario, "PATIENCE", 2)
    monkeypatch.setattr(random_scenario, "_draw", lambda *_: None)
    with pytest.raises(js.InputError, match="scene 5 to 6 m wide in 2 attempts; choose another"):
        js.random_scenario(0, 3, passage=(5.0, 6.0))


@pytest.mark.fast
def test_a_series_is_the_same_for_every_count_and_gets_harder(scenarios, monkeypatch):
    def draw(seed, obstacles):
        return scenarios[0].model_copy(update={"name": f"random-{seed}-{obstacles}"})

    monkeypatch.setattr(random_scenario, "random_scenario", draw)
    told = []
    five = js.random_scenarios(5, lambda name, number: told.append((number, name)))
    names = ["random-0-5", "random-1-5", "random-2-6", "random-3-6", "random-4-7"]
    assert [scene.name for scene in five] == names
    assert told == [*enumerate(names)]
    assert js.random_scenarios(3) == five[:3]
    assert js.random_scenarios(0) == ()


def test_open_and_hopeless_scenes_are_told_apart(scenarios):
    open_field = scenarios[0].model_copy(update={"obstacles": ()})
    assert not blocked(open_field)
    assert blocked(scenarios[4])
    flat = scenarios[0].workspace.model_copy(update={"upper": (3.5, 3.5, 1.2)})
    walled = scenarios[0].model_copy(update={"workspace": flat})
    assert not solvable(
        walled.model_copy(
            update={"task": walled.task.model_copy(update={"goal": (0.0, -2.0, 1.0)})}
        )
    )


@pytest.mark.fast
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((-1,), "seed = -1"),
        ((0, 0), "obstacles = 0: give a whole number from 1 to 1000"),
        ((0, 1001), "obstacles = 1001"),
        ((0, 5, "benchmark", 2), "robots = 2: give a whole number from 3 to 12"),
        ((0, 1, "benchmark", 3, (0.1, 0.2)), "obstacles = 1: a passage is the gap of a wall of 2"),
    ],
)
def test_bad_numbers_are_refused(arguments, message):
    with pytest.raises(js.InputError, match=message):
        js.random_scenario(*arguments)


@pytest.mark.fast
@pytest.mark.parametrize("count", [-1, 1993])
def test_bad_counts_are_refused(count):
    with pytest.raises(js.InputError, match=f"count = {count}: give a whole number from 0"):
        js.random_scenarios(count)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("passage", "message"),
    [
        *[(each, "give two numbers in m") for each in (0.3, "ab", (None, 1), ([0.1], 0.2), (0.2,))],
        *[
            (each, "give two numbers in m")
            for each in ((0.1, 0.2, 0.3), (False, True), (0.1, "x", 0.2))
        ],
        *[(each, "give a least width") for each in ((0.2, 0.1), (float("nan"), 1.0), (-1, 1))],
        ((0.1, float("inf")), "give a least width"),
    ],
)
def test_a_range_of_passage_is_two_numbers_that_rise(passage, message):
    with pytest.raises(js.InputError, match=message):
        _range_of(passage)


@pytest.mark.fast
@pytest.mark.parametrize("passage", [(0, 1), [0.1, 5], np.array([0.1, 0.2]), (np.float32(0), 1)])
def test_any_two_numbers_are_a_range(passage):
    assert _range_of(passage) == (float(passage[0]), float(passage[1]))
