"""The planner: from a task to a verified plan, and what it says where there is none."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.optim.batch import run_batch
from jaxsusp.optim.refine import refine
from jaxsusp.planning import feasibility, refusal, steps, strategies
from jaxsusp.planning.motion.smooth import RADII
from jaxsusp.verify.simulation import Simulation, simulate

SMALL = {"runs": 2, "iterations": 60, "population": 20}


@pytest.fixture(scope="module")
def events() -> list:
    return []


@pytest.fixture(scope="module")
def plan(events) -> js.Plan:
    return js.plan("scenario-1", "pso", seed=1, progress=events.append, **SMALL)


@pytest.fixture(scope="module")
def seen(plan) -> Simulation:
    return simulate(plan.rigging)


def heavy(scenario: js.Scenario, mass: float) -> js.Scenario:
    payload = scenario.payload.model_copy(update={"mass": mass})
    return scenario.model_copy(update={"payload": payload})


def test_a_plan_is_feasible_certified_and_says_how_it_was_found(plan, events):
    assert plan.feasible
    assert plan.certificate.proved
    assert plan.clearance >= 0.05
    assert plan.settings["algorithm"] == "pso"
    assert plan.settings["seed"] == 1
    assert plan.settings["simulated"]
    assert plan.position.shape == (40, 3)
    assert plan.joints.shape == (40, 3, 3)
    terms = js.Problem.from_scenario(plan.scenario).terms(jnp.asarray(plan.waypoints.reshape(-1)))
    assert plan.settings["fitness"] == pytest.approx(float(terms.total))
    phases = {"mapping the free space", "searching", "checking", "simulating"}
    assert {event.phase for event in events} == phases


def test_a_plan_keeps_what_simulation_saw_of_it(plan, seen):
    assert plan.settings["tracking_error_m"] == pytest.approx(seen.tracking_error, rel=1e-9)
    assert plan.settings["tension_error"] == pytest.approx(seen.tension_error, rel=1e-9)


def test_taut_ways_alone_make_plans_without_any_search(plan, monkeypatch):
    monkeypatch.setattr(steps, "run_batch", lambda *_: pytest.fail("searched"))
    taut = js.plan("scenario-1", "taut")
    assert taut.feasible
    assert taut.settings["algorithm"] == "taut"
    assert (taut.settings["way"], taut.settings["attempts"]) == ("taut", 1)
    assert plan.settings["way"] == "searched"
    assert taut.settings["fitness"] >= plan.settings["fitness"], "a search has to be better"
    np.testing.assert_allclose(taut.path[1:-1], taut.waypoints, atol=RADII[0])  # near its own curve
    assert js.verify_plan(taut, simulation=False).ok


@pytest.mark.parametrize(
    "settings", [{"ends": "placed"}, {"search": "box"}], ids=["ends", "search"]
)
def test_taut_ways_go_below_given_ends_through_the_free_space(settings):
    with pytest.raises(js.InputError, match='algorithm = "taut" goes through the free space'):
        js.plan("scenario-1", "taut", **settings)


def test_where_no_taut_way_is_known_the_answer_is_a_message(monkeypatch):
    monkeypatch.setattr(strategies, "taut_ways", lambda *_: ())
    with pytest.raises(js.InputError, match=r'scenario-1: .*"taut" finds no way.*that searches'):
        js.plan("scenario-1", "taut")


def test_the_free_space_is_mapped_once_for_taut_ways_and_search():
    events: list = []
    js.plan("scenario-1", "pso", seed=1, progress=events.append, **SMALL)
    assert [event.phase for event in events].count("mapping the free space") == 1


@pytest.mark.parametrize("name", ["scenario-1", "scenario-6"])
def test_what_is_compiled_ahead_is_what_is_searched(name, monkeypatch):
    """Other shapes, or another structure, would be another program: one compiled for nothing."""
    made = []
    monkeypatch.setattr(steps, "compile_batch", lambda *batch: made.append(batch))
    monkeypatch.setattr(steps, "run_batch", lambda *batch: made.append(batch) or run_batch(*batch))
    js.plan(name, "pso", retries=0, **SMALL)
    foreseen, *others = ([*map(jnp.shape, jax.tree.leaves(p))] for p, *_ in made)
    assert len(others) >= 2
    assert all(each == foreseen for each in others)
    assert len({jax.tree.structure(problem) for problem, *_ in made}) == 1
    assert len({str(rest) for _, *rest in made}) == 1


def test_the_same_seed_gives_the_same_plan(plan):
    again = js.plan("scenario-1", "pso", seed=1, **SMALL)
    np.testing.assert_array_equal(again.waypoints, plan.waypoints)


def test_without_success_the_best_attempt_comes_back_with_reasons(monkeypatch, plan):
    """Every candidate is refused: the planner goes through its retries and says why."""
    seen = []

    def stubborn(problem, settings, first, *_):
        waypoints = problem.dim // 3
        seen.append((waypoints, first))
        through_the_wall = np.tile([-0.46, 0.46, 0.8], waypoints)
        return np.stack([through_the_wall, through_the_wall + 0.1])

    monkeypatch.setattr(strategies, "plan_load", stubborn)
    monkeypatch.setattr(strategies, "taut_ways", lambda *_: ())
    failed = js.plan("scenario-1", "pso", retries=3, **SMALL)
    assert not failed.feasible
    assert any("low wall" in reason for reason in failed.reasons)
    assert "nothing is known that rules a plan out" in failed.reasons[0]
    assert failed.settings["attempts"] == 4
    assert len(seen) == 1 + 2 + 4 + 8  # batches double
    assert len({first for _, first in seen}) == len(seen)  # and no run is made twice
    assert [waypoints for waypoints, _ in seen] == [5] * 7 + [7] * 8  # more waypoints at last


SWINGS = "simulated load is off the plan by 1 m, allowed are 0.01 m"


def two_candidates(plan, *_):
    return np.stack([plan.waypoints.reshape(-1), plan.waypoints.reshape(-1) + 1e-3])


def test_a_plan_that_a_swinging_load_does_not_follow_gives_way_to_the_next(monkeypatch, plan, seen):
    verdicts = iter([(SWINGS,), ()])
    monkeypatch.setattr(strategies, "taut_ways", lambda *_: ())
    monkeypatch.setattr(steps, "simulated", lambda found: (seen, next(verdicts)))
    monkeypatch.setattr(strategies, "plan_load", lambda *_: two_candidates(plan))
    found = js.plan("scenario-1", "pso", **SMALL)
    assert found.feasible
    np.testing.assert_allclose(found.waypoints, plan.waypoints + 1e-3)


def test_where_none_is_followed_the_plan_is_infeasible_for_that_reason(monkeypatch, plan, seen):
    asked = []

    def never(found):
        asked.append(found.scenario.task.duration)
        return (SWINGS,)

    monkeypatch.setattr(strategies, "taut_ways", lambda *_: ())
    monkeypatch.setattr(steps, "simulated", lambda found: (seen, never(found)))
    monkeypatch.setattr(refusal, "simulated_problems", never)
    monkeypatch.setattr(strategies, "plan_load", lambda *_: two_candidates(plan))
    found = js.plan("scenario-1", "pso", retries=0, **SMALL)
    assert not found.feasible
    assert found.reasons[-1] == SWINGS
    assert found.certificate.proved
    assert asked[-1] > 100, "more time was tried as well"


def test_too_fast_a_task_is_told_with_the_duration_that_would_do(plan):
    hurried = plan.scenario.task.model_copy(update={"duration": 4.0})
    scenario = plan.scenario.model_copy(update={"task": hurried})
    found = js.plan_through(scenario, plan.waypoints)
    assert any("tilt of the load" in reason for reason in found.reasons)
    told = refusal.unhurried(found)
    enough = float(re.search(r"too short for this way: in ([\d.]+) s", told.reasons[0])[1])
    slower = scenario.model_copy(
        update={"task": hurried.model_copy(update={"duration": enough * 1.01})}
    )
    again = js.plan_through(slower, plan.waypoints)
    assert js.verify_plan(again).ok
    assert told.reasons[1:] == found.reasons


def test_without_simulation_a_plan_says_that_it_was_not_played(monkeypatch, plan):
    monkeypatch.setattr(steps, "simulated", lambda *_: pytest.fail("played"))
    found = js.plan("scenario-1", "pso", seed=1, simulate=False, **SMALL)
    assert found.feasible
    assert found.settings["simulated"] is False


def test_a_task_that_no_tensions_can_hold_is_told_before_any_search(scenarios, monkeypatch):
    monkeypatch.setattr(steps, "run_batch", lambda *_: pytest.fail("searched"))
    with pytest.raises(js.ImpossibleTaskError) as told:
        js.plan(heavy(scenarios[0], 25.0))
    message = str(told.value)
    assert "at task.start (0, 2, 1) cable 1 would have 165.06 N" in message
    assert "limits.tension[1] = 100 N" in message
    assert "nowhere in the workspace" in message
    for ends in ("given", "placed"):
        with pytest.raises(js.ImpossibleTaskError) as told:
            js.plan(heavy(scenarios[0], 35.0), ends=ends)
        assert str(told.value) == (
            "scenario-1: no plan is possible: 3 cables of at most 100 N lift 300 N, and the load "
            "weighs 343.35 N; lighten payload.mass or raise limits.tension[1]"
        )


def test_ends_that_are_too_low_are_told_with_cable_and_place(scenarios):
    content = scenarios[0].model_dump()
    for robot in content["robots"]:
        robot["end"] = (*np.multiply(robot["end"][:2], 1.0), 4.2)
    low = js.Scenario.model_validate(content)
    with pytest.raises(js.ImpossibleTaskError, match=r"task.goal \(0, -2, 3\) cable [23] would"):
        feasibility.require_possible(low)
    assert js.why_not(low).kind == "tensions"
    assert js.why_not(low).text.startswith("scenario-1: no plan is possible: at task.goal (0, -2,")
    feasibility.require_possible(low, ends="placed")
    feasibility.require_possible(scenarios[0])


def test_cables_that_are_too_short_at_the_start_are_told_before_any_search(scenarios, monkeypatch):
    monkeypatch.setattr(steps, "run_batch", lambda *_: pytest.fail("searched"))
    limits = scenarios[0].limits.model_copy(update={"cable_length": (0.5, 4.0)})
    short = scenarios[0].model_copy(update={"limits": limits})
    with pytest.raises(js.ImpossibleTaskError) as told:
        js.plan(short)
    assert str(told.value) == (
        "scenario-1: no plan is possible: at task.start (0, 2, 1) cable 2 would be 9.2856 m long, "
        "more than limits.cable_length[1] = 4 m; move the task or the ends, widen "
        'limits.cable_length, or let ends = "placed"'
    )
    assert js.why_not(short)[:2] == ("lengths", str(told.value))
    feasibility.require_possible(short, ends="placed")


def test_ends_are_led_past_what_fixed_ones_cannot_pass(monkeypatch):
    """The straight way of the example, which no ends that stay can do."""
    # Of which nothing is better:
    monkeypatch.setattr(steps, "refine", lambda problem, x, seed: (x, np.arange(len(x))))
    led = js.plan("hybrid", "pso", "placed", **SMALL)
    assert led.feasible, led.reasons
    assert led.ends.shape == (40, 3, 3)
    np.testing.assert_allclose(led.position[:, 1], 0, atol=1e-6)
    assert np.ptp(led.ends[:, 0, 2]) > 0.5  # robot 1 raises its end on the way
    assert led.settings["fitness"] < 50  # no contact is counted


@pytest.mark.fast
def test_more_ends_than_can_be_led_are_told_before_any_search():
    content = js.load_scenario("six-robots").model_dump() | {"drive": "hybrid"}
    with pytest.raises(js.InputError, match="of at most 4 robots, got 6"):
        js.plan(js.Scenario.model_validate(content), ends="placed")


@pytest.mark.fast
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"ends": "here"}, "ends = 'here'"),
        ({"coordination": "joint"}, "joint"),
        ({"retries": -1}, "retries = -1"),
        ({"runs": 0}, "runs = 0"),
        ({"samples": 2}, "samples = 2"),
        ({"search": "cube"}, "search"),
        ({"algorithm": "psp"}, "did you mean"),
        ({"seed": -1}, "seed"),
    ],
)
def test_bad_settings_are_refused_before_any_search(options, message):
    with pytest.raises(js.InputError, match=message):
        js.plan("scenario-1", **options)


def test_refinement_improves_every_run_and_never_worsens_one():
    def bowl(x):
        return ((x - 0.3) ** 2).sum()

    problem = js.Problem(bowl, -jnp.ones(6), jnp.ones(6))
    start = np.array([[0.9] * 6, [-0.5] * 6, [0.3] * 6])
    end, _ = refine(problem, start, iterations=150, candidates=16)
    before, after = (np.array([float(bowl(x)) for x in each]) for each in (start, end))
    assert (after <= before).all()
    assert (after[:2] < 1e-3).all()
    np.testing.assert_array_equal(end[2], start[2])
