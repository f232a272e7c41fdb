"""How narrow it gets, against closed forms."""

import numpy as np
import pytest
from scenes import frame

import jaxsusp as js
from jaxsusp.freespace.cells.forbidden import Errand, forbidden_of
from jaxsusp.freespace.cells.passage import narrowest_place
from jaxsusp.scenario.models import Box, Obstacle

EXACT = 3e-3
"""m; twice what is lost on the way along the line, and what is lost on cables."""


def scene(*obstacles: Obstacle, **changes) -> js.Scenario:
    low = frame().task.model_copy(update={"goal": (0.0, -2.0, 1.0)})
    return frame().model_copy(update={"obstacles": obstacles, "task": low, **changes})


def pillar(left: float, right: float, name: str, thick: float = 0.2) -> Box:
    """A piece of a wall that reaches from below the floor to above the ceiling."""
    center = (left + right) / 2, 0.0, 4.0
    return Box(name=name, center=center, size=(right - left, thick, 8.4))


@pytest.mark.parametrize("gap", [0.34, 0.5, 0.7])
def test_a_gap_in_a_wall_is_as_wide_as_it_leaves_the_load_room(gap):
    """The load is 0.2 m wide and keeps 0.05 m on either side."""
    walls = pillar(-4, -0.3 - gap, "left"), pillar(-0.3, 4, "right")
    scenario = scene(*walls, drive="hybrid")
    place, room, _, most = narrowest_place(forbidden_of(scenario), Errand.of(scenario))
    assert 2 * room == pytest.approx(gap - 0.3, abs=EXACT)
    assert 2 * room <= gap - 0.3 <= 2 * most
    np.testing.assert_allclose(place[0], -0.3 - gap / 2, atol=EXACT)
    assert abs(place[1]) <= 0.1 + EXACT


def test_of_two_gaps_the_wider_one_decides():
    walls = [(-4, -1.4, "left"), (-0.9, 0.8, "middle"), (1.5, 4, "right")]
    walls = [pillar(*each, thick=2.0) for each in walls]
    scenario = scene(*walls, drive="hybrid")
    found = js.passage(scenario, js.free_space(scenario, coverage=0.99))
    assert found.width == pytest.approx(0.7 - 0.3, abs=EXACT)
    assert found.only is False
    assert found.place[0] == pytest.approx(1.15, abs=EXACT)
    assert set(found.between) == {'obstacles[1] "middle" (load)', 'obstacles[2] "right" (load)'}
    assert found.end == ""
    assert "one of several ways" in found.words
    closed = scene(*walls, pillar(0.7, 1.6, "door", 2.0), drive="hybrid")
    found = js.passage(closed, js.free_space(closed))
    assert found.width == pytest.approx(0.5 - 0.3, abs=EXACT)
    assert found.only is True


def test_where_no_way_is_known_it_is_as_wide_as_nothing():
    walls = pillar(-4, -0.5, "left"), pillar(-0.25, 4, "right")
    scenario = scene(*walls, drive="hybrid")
    found = js.passage(scenario, js.free_space(scenario, coverage=0.2, limit=4))
    assert found.width == 0
    assert found.error > 0
    assert found.only is None
    assert "no way that its regions know" in found.words


def test_a_slot_for_a_cable_is_as_wide_as_it_leaves_the_cable_room():
    """Two beams near the end of cable 1, which has to come up between them on the way."""
    beam = {"size": (2.0, 0.1, 0.2)}
    beams = (
        Box(name="west", center=(-1.15, 5.0, 5.9), **beam),
        Box(name="east", center=(1.15, 5.0, 5.9), **beam),
    )
    scenario = scene(*beams)
    place, room, *_ = narrowest_place(forbidden_of(scenario), Errand.of(scenario))
    assert 2 * room == pytest.approx(0.3 - 2 * (0.01 + 0.05), abs=EXACT)
    end, hook = np.array(scenario.robots[0].end), place + np.array([0.0, 0.0, 0.15])
    at_beams = hook + (5.0 - hook[1]) / (end[1] - hook[1]) * (end - hook)
    np.testing.assert_allclose(at_beams[0], 0.0, atol=EXACT)
    assert 5.7 <= at_beams[2] <= 6.1


def test_a_way_that_is_moved_to_more_room_stays_in_the_workspace():
    """Above the wall is room without end, and the top of the workspace is just above it."""
    wall = Box(name="wall", center=(0.0, 0.0, 0.9), size=(8.0, 0.4, 1.8))
    scenario = scene(wall, drive="hybrid")
    box = scenario.workspace.model_copy(update={"upper": (3.5, 3.5, 2.2)})
    scenario = scenario.model_copy(update={"workspace": box})
    found = narrowest_place(forbidden_of(scenario), Errand.of(scenario))
    for way in found.ways:
        assert way[:, 2].max() <= 2.2
    assert found.room <= 2.2 - 1.8
    scenario = scenario.model_copy(
        update={"workspace": box.model_copy(update={"upper": (3.5, 3.5, 3.2)})}
    )
    assert narrowest_place(forbidden_of(scenario), Errand.of(scenario)).room > found.room


def test_the_clearance_could_grow_by_half_of_it():
    """A way is left with somewhat less, and none with more."""
    scenario = scene(pillar(-4, -1.4, "left"), pillar(-0.9, 4, "right"), drive="hybrid")
    _, room, _, most = narrowest_place(forbidden_of(scenario), Errand.of(scenario))

    def rest(grown: float) -> float:
        limits = scenario.limits.model_copy(update={"clearance": 0.05 + grown})
        wider = scenario.model_copy(update={"limits": limits})
        return narrowest_place(forbidden_of(wider), Errand.of(wider)).room

    assert rest(room - 1e-3) >= 0
    assert rest(most + 1e-3) < 0


def test_where_an_end_of_the_task_has_least_room_it_is_named():
    stone = Box(name="stone", center=(0.0, 2.4, 1.0), size=(0.4, 0.2, 0.4))
    scenario = scene(stone, drive="hybrid")
    found = js.passage(scenario)
    assert found.end == "task.start"
    assert found.place == (0.0, 2.0, 1.0)
    assert found.width == pytest.approx(2 * (0.4 - 0.1 - 0.1 - 0.05), abs=EXACT)
    assert "narrowest at task.start (0, 2, 1): 0.29" in found.words
    assert 'by obstacles[0] "stone" (load)' in found.words


@pytest.mark.fast
def test_in_an_open_field_nothing_is_narrow():
    found = js.passage(scene())
    assert np.isinf(found.width)
    assert found.words == "no obstacle narrows the way"
