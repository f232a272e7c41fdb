"""What is said where there is no plan: what is proved, what has to go, what does not hold."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.cells.forbidden import Errand, forbidden_of
from jaxsusp.freespace.cells.subdivision import subdivide
from jaxsusp.freespace.cells.ways import cell_of
from jaxsusp.planning import planner, refusal
from jaxsusp.scenario.models import Box
from jaxsusp.verify.certificate import Contact
from jaxsusp.verify.constraints import Check


@pytest.fixture(scope="module")
def frame() -> js.Scenario:
    return js.load_scenario("scenario-1")


def scene(frame: js.Scenario, *obstacles: Box, up: float = 5.5, **changes) -> js.Scenario:
    """A task at a height of 1 m past other obstacles, under a ceiling."""
    task = frame.task.model_copy(update={"goal": (0.0, -2.0, 1.0)})
    room = frame.workspace.model_copy(update={"upper": (3.5, 3.5, up)})
    return frame.model_copy(
        update={"obstacles": obstacles, "task": task, "workspace": room, "name": "yard", **changes}
    )


def wall(height: float, y: float = 0.0, name: str = "wall") -> Box:
    return Box(name=name, center=(0.0, y, height / 2), size=(8.0, 0.2, height))


def test_a_wall_is_refused_with_its_name_before_any_search(frame, monkeypatch):
    monkeypatch.setattr(planner, "coordinate", lambda *_: pytest.fail("searched"))
    crate = Box(name="crate", center=(2.0, 1.0, 0.5), size=(0.5, 0.5, 0.5))
    walled = scene(frame, wall(2.6), crate, up=2.7)
    with pytest.raises(js.ImpossibleTaskError) as told:
        js.plan(walled)
    assert str(told.value) == (
        "yard: no plan is possible: every way from task.start (0, 2, 1) to task.goal (0, -2, 1) "
        "takes the load or a cable closer than limits.clearance = 0.05 m to an obstacle, as cells "
        'of 0.44 m prove; at least 1 obstacle must go; without obstacles[0] "wall" there is a way; '
        "move obstacles or the task"
    )
    found = js.why_not(walled)
    assert found == ("proved blocked", str(told.value), ('obstacles[0] "wall"',), found.cell)
    assert found.cell == pytest.approx(0.44, abs=0.01)


def test_all_walls_in_a_row_are_named(frame):
    found = js.why_not(scene(frame, wall(2.6, 0.5, "one"), wall(2.6, -0.5, "two"), up=2.7))
    assert found.remove == ('obstacles[0] "one"', 'obstacles[1] "two"')
    assert "at least 2 obstacles must go; without obstacles[0]" in found.text


def test_cables_that_block_what_the_load_could_pass_are_told(frame):
    """Over the wall there is room for the load, but a cable would have to go through it."""
    high = scene(frame, wall(4.0))
    found = js.why_not(high)
    assert found.kind == "proved blocked"
    assert 'the load alone is not blocked: move the ends, let ends = "placed", or' in found.text
    refusal.require_way(high, ends="placed")
    with pytest.raises(js.ImpossibleTaskError, match="takes the load closer than"):
        refusal.require_way(scene(frame, wall(2.6), up=2.7), ends="placed")


def test_what_lies_between_a_proof_and_a_way_is_told_with_its_place(frame):
    """A gap exactly as wide as the load with its clearance."""
    sides = [
        Box(name=name, center=(x, 0.0, 4.0), size=(4.0, 0.2, 8.4))
        for name, x in (("left", -2.15), ("right", 2.15))
    ]
    found = js.why_not(scene(frame, *sides, drive="hybrid"))
    assert found.kind == "no passage wider than"
    assert found.text.startswith("yard: no way keeps the load more than 0.0")
    assert 'obstacles[0] "left" (load)' in found.text
    assert 'obstacles[1] "right" (load)' in found.text


def test_tensions_on_every_way_are_told_with_cable_and_place(frame, monkeypatch):
    """As where start and goal, which are looked at first, can be held."""
    monkeypatch.setattr(refusal, "trouble", lambda *_: None)
    low = scene(frame, wall(1.5))
    heights = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.75]])
    tensions = np.asarray(js.tensions(low, heights)).max(axis=-1)
    start = np.asarray(js.tensions(low, [low.task.start, low.task.goal])).max()
    most = float(max(start, tensions[0]) * 0.3 + tensions[1] * 0.7)
    limits = low.limits.model_copy(update={"tension": (1.0, most)})
    found = js.why_not(low.model_copy(update={"limits": limits}))
    assert found.kind == "tensions"
    assert "on every way found the load passes a place like (" in found.text
    assert f"N, more than limits.tension[1] = {most:g} N (a hint" in found.text
    assert js.why_not(low, ends="placed").kind == "unknown"


def test_regions_that_do_not_connect_prove_nothing(frame):
    """Of a free space that was given up early, cells know better, and so do finer regions."""
    bend = [
        Box(name=name, center=(x, y, 4.0), size=(6.0, 0.2, 8.4))
        for name, x, y in (("one", -1.5, 0.7), ("two", 1.5, -0.7))
    ]
    bent = scene(frame, *bend, drive="hybrid")
    rough = js.free_space(bent, coverage=0.05, limit=2, routes=False)
    assert not rough.connected
    found = js.why_not(bent, space=rough)
    assert found.kind == "regions do not connect"
    assert "a way is known to exist, but 2 convex regions do not join" in found.text
    assert "with coverage = 0.99 they do" in found.text


@pytest.mark.fast
def test_nothing_is_made_up(frame):
    found = js.why_not(scene(frame))
    assert found.kind == "unknown"
    assert "nothing is known that rules a plan out" in found.text
    assert found.kind in refusal.KINDS


def test_what_a_certified_plan_passes_is_not_blocked():
    plan = js.load_plan(Path(__file__).parents[1] / "files" / "scenario-1-0.1.0.plan.json")
    cells = subdivide(forbidden_of(plan.scenario), Errand.of(plan.scenario), all_obstacles=True)
    position = plan.at(np.linspace(0, plan.times[-1], 2000)).position
    passed = {cell_of(place, cells.lower, cells.size, cells.blocked.shape) for place in position}
    assert len(passed) > 100
    assert all(cells.open[cell] for cell in passed)


def test_the_best_attempt_tells_of_robots():
    plan = js.load_plan(Path(__file__).parents[1] / "files" / "scenario-1-0.1.0.plan.json")
    touch = Contact(3.0, ("upper link of robot 1", "column of robot 2"), 0.1, 0.5, 0.08)
    far = Check("reach", 6.0, 1.0, 5.0, "m", None, "robot 3")
    failed = replace(
        plan,
        feasible=False,
        reasons=("as it was",),
        certificate=replace(plan.certificate, contacts=(touch,)),
        report=(*plan.report, far),
    )
    told = refusal.explained(failed, "given")
    assert told.reasons == (
        "scenario-1: in the best attempt reach of robot 3 is 6 m, allowed is 1 to 5 m; in the best "
        "attempt upper link of robot 1 and column of robot 2 come within 0.080 m of each other, "
        "0.5 m are required",
        "as it was",
    )
    assert js.why_not("scenario-1", plan=failed).kind == "reach"
    assert refusal.explained(plan, "given") is plan
