"""Where the load must not be: what blocks it, the nearest place for it, and how that is shown."""

import json

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.report import freespace, workspace


def moved(**places) -> dict:
    """scenario-1 with start or goal elsewhere."""
    document = js.load_scenario("scenario-1").model_dump(exclude_none=True)
    return document | {"name": "blocked", "task": document["task"] | places}


def unchecked(document: dict) -> js.Scenario:
    return js.Scenario.model_validate(document, context={"task_checked": False})


@pytest.fixture(scope="module")
def blocked() -> js.Scenario:
    """The start in the low wall, the goal outside the workspace."""
    return unchecked(moved(start=(-0.46, 0.46, 0.81), goal=(0.0, -4.0, 3.0)))


@pytest.fixture(scope="module")
def cells(blocked) -> js.Workspace:
    return js.workspace(blocked, 0.25)


@pytest.fixture(scope="module")
def space(blocked) -> js.FreeSpace:
    return js.free_space(blocked, coverage=0.8)


def away(found: js.Misplaced) -> float:
    """From where it is blocked to the nearest place for it (m)."""
    assert found.nearest is not None
    return float(np.linalg.norm(np.array(found.nearest) - found.at))


def is_admissible(document: dict, **places) -> bool:
    js.Scenario.model_validate(document | {"task": document["task"] | places})
    return True


@pytest.mark.parametrize("kind", ["cells", "space"])
def test_the_nearest_place_is_admissible_and_near(blocked, kind, request):
    start, goal = js.misplaced(blocked, request.getfixturevalue(kind))
    assert (start.place, goal.place) == ("task.start", "task.goal")
    assert {*start.reasons, *goal.reasons} == {*blocked.troubles}
    assert is_admissible(moved(start=start.nearest, goal=goal.nearest))
    assert 0.5 < away(start) < 0.9
    assert 0.99 < away(goal) < 1.3
    assert goal.nearest is not None
    assert f"task.goal = [{goal.nearest[0]:g}, " in goal.words
    assert goal.words.endswith(" m away.")


def test_of_the_map_no_usable_cell_is_nearer(blocked, cells):
    (start, _) = js.misplaced(blocked, cells)
    centres = np.stack(np.meshgrid(*cells.axes, indexing="ij"), axis=-1)[cells.usable]
    least = np.linalg.norm(centres - start.at, axis=1).min()
    assert away(start) < least + 2e-3


def test_of_the_free_space_none_of_many_free_places_is_much_nearer(blocked, space):
    start, _ = js.misplaced(blocked, space)
    around = np.random.default_rng(0).normal(size=(4000, 3))
    around *= 0.9 * away(start) / np.linalg.norm(around, axis=1, keepdims=True)
    points = np.add(start.at, around)
    held = np.array([body.excess(points) > 0 for body in space.bodies]).all(axis=0)
    assert not (held & (points[:, 2] > 0.2)).any()


def test_both_maps_know_of_the_same_place(blocked, cells, space):
    for one, other in zip(js.misplaced(blocked, cells), js.misplaced(blocked, space), strict=True):
        assert np.linalg.norm(np.subtract(one.nearest, other.nearest)) < 0.2


def test_a_blocked_task_has_its_space_covered_and_no_route(blocked, space):
    assert not space.connected
    assert space.coverage > 0.7
    assert len(space.d) > 3
    assert space.reason.count("has no free space around it") == 2
    with pytest.raises(js.ScenarioError):
        js.Problem.from_scenario(blocked, space=space)


def test_a_place_with_room_where_the_load_cannot_hang_is_on_no_route():
    """Above the ends of separate cables, of which the regions do not know."""
    document = js.load_scenario("rim").model_dump(exclude_none=True)
    document["workspace"]["upper"] = (3.5, 3.5, 9.0)
    document["task"]["goal"] = (0.0, -2.0, 8.0)
    scenario = unchecked(document)
    space = js.free_space(scenario, coverage=0.5, limit=20, routes=False)
    assert not space.connected
    assert "not below the upper end" in space.reason
    (goal,) = js.misplaced(scenario, space)
    assert is_admissible(document, goal=goal.nearest)


def test_pictures_mark_what_is_blocked(blocked, cells, space):
    marks = js.misplaced(blocked, space)
    for figure, planes in (
        (workspace.slices(cells, marks), 6),
        (freespace.slices(blocked, space, marks), 2),
        (freespace.view(blocked, space, marks), 2),
    ):
        for axes in figure.axes[:planes]:
            kinds = [
                line.get_marker() for line in axes.get_lines() if np.size(line.get_xdata()) == 1
            ]
            assert kinds.count("X") == 2
        said = " ".join(text.get_text() for text in figure.texts).replace("\n", " ")
        assert 'puts the load into the warning area of obstacles[0] "low wall"' in said
        assert "The nearest admissible place found is task.goal = " in said
        labels = [text.get_text() for text in figure.legends[0].get_texts()]
        assert "start, goal: no place for the load" in labels
    below = figure.axes[1].get_ylim()[0]
    assert below < -4  # the goal is in the picture


@pytest.fixture
def file(tmp_path):
    scenario = unchecked(moved(start=(-0.46, 0.46, 0.81)))
    path = tmp_path / "blocked.toml"
    path.write_text(scenario.to_toml())
    return path


def test_commands_draw_it_and_say_where_else_to_go(run, file, tmp_path):
    status, out, _ = run("workspace", file, "--spacing", "0.5", "--output", tmp_path / "map")
    said = " ".join(out.split())
    assert status == 0
    assert 'puts the load into the warning area of obstacles[0] "low wall"' in said
    assert "The nearest admissible place found is task.start = [" in said
    options = "--coverage", "0.3", "--output", tmp_path / "space", "--json"
    status, out, _ = run("freespace", file, *options)
    answer = json.loads(out)
    assert status == 1
    assert (answer["connected"], answer["refusal"]) == (False, None)
    (start,) = answer["misplaced"]
    assert start["place"] == "task.start"
    assert is_admissible(moved(start=tuple(start["nearest"])))
    assert len([*(tmp_path / "map").iterdir(), *(tmp_path / "space").iterdir()]) == 6
    status, _, err = run("plan", file, "--output", tmp_path / "plan")
    assert status == 2
    assert f"{file}: task.start = [-0.46, 0.46, 0.81] puts the load into the warning area" in err


def test_the_nearest_place_is_one_where_the_load_can_be_held(blocked, space):
    """A cable that is stretched to its limit where it would be free sends it elsewhere."""
    (found, _), ends = js.misplaced(blocked, space), (1.0, 56.0)
    assert js.tensions(blocked, found.nearest).max() > ends[1]
    limits = blocked.limits.model_copy(update={"tension": ends})
    weaker = blocked.model_copy(update={"limits": limits})
    start = js.misplaced(weaker, space)[0]
    assert away(start) > away(found)
    assert js.tensions(weaker, start.nearest).max() <= ends[1]
