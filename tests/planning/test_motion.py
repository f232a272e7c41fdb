"""How plans move: smooth paths, shortest durations within limits, and calm arrivals."""

import re
from dataclasses import replace

import numpy as np
import pytest
from plans import EXAMPLES, LOW

import jaxsusp as js
from jaxsusp.planning import refusal
from jaxsusp.planning.motion import drive
from jaxsusp.planning.motion.bounds import bounds
from jaxsusp.planning.motion.demands import swing_period
from jaxsusp.planning.motion.pace import shortest
from jaxsusp.planning.motion.smooth import RADII
from jaxsusp.planning.ranking import with_settings
from jaxsusp.planning.refusal import explained
from jaxsusp.planning.waypoints import sample_path
from jaxsusp.report.drawing.style import CABLES
from jaxsusp.report.plan.pace import pace
from jaxsusp.report.plan.words import how_calm, how_fast, how_limited, is_paced
from jaxsusp.scenario.ownunits import Frame, in_words, restated
from jaxsusp.suspension.cableloads import cable_loads
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.verify.constraints import INSTANTS
from jaxsusp.verify.simulation import simulate


def changed(scenario: js.Scenario, **tables) -> js.Scenario:
    content = scenario.model_dump()
    for table, values in tables.items():
        content[table] = {**content[table], **values}
    return js.Scenario.model_validate(content)


@pytest.fixture(scope="module")
def plan(scenarios) -> js.Plan:
    return js.plan_through(scenarios[0], LOW)


@pytest.fixture(scope="module")
def fast(scenarios) -> js.Plan:
    settings = {"duration": "shortest", "simulated": True}
    return js.plan_through(scenarios[0], LOW, duration="shortest", settings=settings)


def peaks(law: TimeLaw) -> np.ndarray:
    motion = law.at(np.linspace(0, law.duration, 4001))
    return np.array(
        [np.linalg.norm(each, axis=1).max() for each in (motion.acceleration, motion.jerk)]
    )


# Smooth paths


def test_a_plan_runs_on_a_path_that_bends_less_and_keeps_everything(plan):
    searched = sample_path(plan.scenario, plan.waypoints, 40)
    before, after = peaks(TimeLaw.through(searched, 40.0)), peaks(plan.law)
    assert plan.feasible
    assert after[1] < before[1] / 2
    assert after[0] < before[0]
    assert 1e-3 < np.abs(plan.path - searched).max() <= RADII[0] + 1e-9
    np.testing.assert_array_equal(plan.path[[0, -1]], searched[[0, -1]])


# Shortest durations


def winding(scenario: js.Scenario, seed: int) -> Rigging:
    """A random way through the workspace, whatever stands in it."""
    random = np.random.default_rng(seed)
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1]
    path = sample_path(scenario, line + random.uniform(-0.4, 0.4, line.shape), 40)
    law = TimeLaw.through(path, 40.0)
    return Rigging(scenario, law, ends_beside(scenario, path), np.zeros(3, bool))


LIMITS = (
    {"acceleration": 0.4, "speed": 0.7},
    {"jerk": 0.3, "cable_speed": 0.4},
    {"tension": [5.0, 90.0]},
    {},
)


@pytest.mark.parametrize("seed", range(20))
def test_shortest_laws_keep_every_limit_between_their_bound_and_the_nominal_law(scenarios, seed):
    """On random paths; looked at where nothing of the optimisation looks, at random instants."""
    stated = LIMITS[seed % len(LIMITS)]
    scenario = changed(scenarios[0], limits=stated)
    rigging, limits = winding(scenario, seed), scenario.limits
    found = shortest(rigging, followed=seed % 2 == 0)
    assert found is not None
    law = found.law
    assert found.bound.duration <= law.duration <= rigging.law.duration
    times = np.sort(np.random.default_rng(seed).uniform(0, law.duration, INSTANTS))
    motion = law.at(times)
    for name in ("acceleration", "jerk"):
        if (most := getattr(limits, name)) is not None:
            assert np.linalg.norm(getattr(motion, name), axis=1).max() <= most
    if limits.speed is not None:
        assert np.linalg.norm(motion.velocity, axis=1).max() <= limits.speed
    low, high = limits.tension
    loads = cable_loads(scenario, motion.position, motion.acceleration)
    assert low <= loads.tensions.min()
    assert loads.tensions.max() <= high
    sideways = np.linalg.norm(motion.acceleration[:, :2], axis=1)
    tilt = np.rad2deg(np.arctan2(sideways, 9.81 + motion.acceleration[:, 2]))
    assert tilt.max() <= limits.posture_deg
    if limits.cable_speed is not None:
        later, step = law.at(times + 1e-4), 1e-4
        rate = (cable_loads(scenario, later.position).lengths - loads.lengths) / step
        assert np.abs(rate).max() <= limits.cable_speed * (1 + 1e-4)


def test_a_shortest_plan_is_fast_followed_and_told(plan, fast):
    assert fast.feasible, fast.reasons
    assert fast.settings["least_time"] < fast.law.duration < plan.law.duration / 3
    assert simulate(fast.rigging).problems(fast.scenario.limits) == []
    assert js.verify_plan(fast, simulation=False).ok
    assert f"Driven in {fast.law.duration:.2f} s instead of the 40 s" in how_fast(fast)
    assert how_fast(plan) == "Driven in 40 s."
    assert is_paced(fast)
    assert not is_paced(plan)


def test_a_shortest_plan_tells_the_limits_that_its_figure_shows_shares_of(plan, fast):
    figure, told = pace(fast), how_limited(fast)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert how_limited(plan) == ""
    assert all(label.removesuffix(": share of the room that a load at rest leaves") in told
               for label in labels)  # fmt: skip
    most = {}
    for name, color in (("jerk", CABLES[1]), ("tilt", CABLES[2])):
        label = next(each for each in labels if each.startswith(name))
        assert ", so that a swinging load follows (" in label
        curve = next(each for each in figure.axes[0].get_lines() if each.get_color() == color)
        most[name] = float(re.search(r"≤ ([\d.]+)", label)[1]) * curve.get_ydata().max() / 100
    assert most["jerk"] == pytest.approx(peaks(fast.law)[1], rel=0.01)
    tilt = next(each.value for each in fast.report if each.name == "tilt of the load")
    assert most["tilt"] == pytest.approx(tilt, rel=0.02)
    assert "(limits.posture_deg = 10°)" in told


@pytest.mark.fast
def test_limits_of_a_law_are_told_with_where_they_come_from(scenarios):
    """Those that are not stated by a closed form, in another size as well."""
    stated = changed(scenarios[0], limits={"speed": 0.7, "cable_speed": 0.4, "jerk": 0.3})
    words = [each.words for each in bounds(stated, True)]
    assert words[:3] == [
        "speed of the load ≤ 0.7 m/s (limits.speed)",
        "speed of a cable ≤ 0.4 m/s (limits.cable_speed)", "jerk ≤ 0.3 m/s³ (limits.jerk)",
    ]  # fmt: skip
    assert words[-1] == "tension within [1, 100] N (limits.tension)"
    assert "tilt ≤ 10° (limits.posture_deg)" in [each.words for each in bounds(stated, False)]
    frame = Frame(0.05, 0.05**3, (3.0, 1.0, 1.0))
    for size, scenario in ((1.0, scenarios[0]), (0.05, restated(scenarios[0], frame))):
        half, radius = scenario.payload.height / 2, scenario.payload.radius
        aside = 0.8 * 0.01 * size / half
        period = 2 * np.pi * np.sqrt((radius**2 / 4 + half**2 / 3 + half**2) / (9.81 * half))
        jerk, tilt = (each.value for each in bounds(scenario, True)[:2])
        assert float(tilt.removesuffix("°")) == pytest.approx(np.rad2deg(np.arcsin(aside)), 0.01)
        known = 9.81 * np.tan(np.arcsin(aside)) / period
        assert float(jerk.removesuffix(" m/s³")) == pytest.approx(known, rel=0.01)


def test_a_saved_plan_moves_as_before(fast, tmp_path):
    fast.save(tmp_path / "fast.json")
    loaded = js.load_plan(tmp_path / "fast.json")
    times = np.linspace(0, fast.law.duration, 50)
    for one, other in zip(fast.at(times), loaded.at(times), strict=True):
        np.testing.assert_array_equal(one, other)
    assert loaded.law.duration == fast.law.duration


def test_a_load_that_does_not_follow_is_driven_more_slowly(fast, monkeypatch):
    monkeypatch.setattr("jaxsusp.verify.simulation.TENSION", 0.01)  # asked for
    monkeypatch.setattr(drive, "TENSION", 0.01)
    wanted = drive.Wanted(shortest=True)
    assert simulate(fast.rigging).problems(fast.scenario.limits)
    slower = drive.followed(fast, wanted)
    assert slower.feasible
    again = simulate(slower.rigging)
    assert slower.settings["tracking_error_m"] == pytest.approx(again.tracking_error, rel=1e-6)
    assert slower.settings["tension_error"] == pytest.approx(again.tension_error, rel=1e-6)
    assert 1.01 * fast.law.duration < slower.law.duration < 2 * fast.law.duration
    assert simulate(slower.rigging).problems(fast.scenario.limits) == []


def test_ends_that_move_are_driven_in_the_least_duration_that_will_do():
    scenario = js.load_scenario("end-driven")
    nominal = js.plan_through(scenario, EXAMPLES["end-driven"])
    found = js.plan_through(scenario, EXAMPLES["end-driven"], duration="shortest")
    assert found.feasible
    assert "least_time" not in found.settings
    assert found.law.duration < nominal.law.duration
    law = TimeLaw.least_jerk(found.law.path, found.law.duration / 1.05)
    hasty = Rigging(found.scenario, law, found.end_path, found.rigging.elbow_up)
    assert not drive.plan_along(
        found.scenario, found.waypoints, law, found.end_path, hasty.elbow_up
    ).feasible


# What cannot be


def test_limits_of_motion_are_lines_of_the_report(scenarios):
    slow = changed(
        scenarios[0],
        limits={"speed": 0.1, "acceleration": 0.01, "jerk": 0.001, "cable_speed": 0.05},
    )
    found = js.plan_through(slow, LOW)
    reasons = " ".join(found.reasons)
    for text in ("speed of load is 0.2", "acceleration of load is", "jerk of load is",
                 "speed of a cable of cable"):  # fmt: skip
        assert text in reasons
    calmer = js.plan_through(slow, LOW, duration="shortest")
    assert calmer.feasible
    assert calmer.law.duration > 40


def test_tensions_that_leave_no_room_are_named_with_the_place(plan):
    greatest = float(plan.loads_at(np.linspace(0, 40, INSTANTS)).static.max())
    tight = changed(plan.scenario, limits={"tension": (1.0, greatest - 0.5)})
    found = js.plan_through(tight, LOW, duration="shortest")
    assert not found.feasible
    assert found.reasons[0].startswith("limits.tension = [1, ")
    assert "leaves no room to accelerate: at (" in found.reasons[0]
    assert found.settings["no_law"] == "limits.tension"


@pytest.fixture
def unknown(monkeypatch):
    """Nothing is known that rules a plan out."""
    answer = refusal.Refusal("unknown", "nothing is known")
    monkeypatch.setattr(refusal, "why_not", lambda *_, **__: answer)


@pytest.mark.usefixtures("unknown")
@pytest.mark.parametrize("field", ["speed", "cable_speed"])
def test_the_limit_that_leaves_no_law_is_named_with_what_it_would_take(plan, field):
    """And tensions, which leave room, are not."""
    slow = changed(plan.scenario, limits={field: 1e-9})
    found = js.plan_through(slow, LOW, duration="shortest")
    times = np.linspace(0, 40, INSTANTS)
    motion, step = found.at(times), 1e-4  # with the law that would have to be stretched
    speed = np.linalg.norm(motion.velocity, axis=1)
    if field == "cable_speed":
        later = cable_loads(plan.scenario, motion.position + step * motion.velocity).lengths
        now = cable_loads(plan.scenario, motion.position).lengths
        speed = np.abs((later - now) / step).max(axis=1)
    takes, place = 40 * speed.max() / 1e-9, in_words(motion.position[speed.argmax()])
    assert not found.feasible
    assert found.reasons[0].startswith(f"limits.{field} = 1e-09 m/s: no shortest law that keeps it")
    assert f"would take about {takes:.3g} s; it asks most at {place}; raise it" in found.reasons[0]
    assert not any("tension" in reason for reason in found.reasons)
    told = explained(found, "given")
    assert told.reasons == found.reasons, "that nothing else is known is no help"


@pytest.mark.usefixtures("unknown")
def test_of_limits_that_a_way_may_miss_it_is_said_last_that_nothing_else_is_known(plan):
    stuck = replace(plan, feasible=False, reasons=("limits.tension = …",))
    told = explained(with_settings(stuck, no_law="limits.tension"), "given")
    assert told.reasons == ("limits.tension = …", "nothing is known")
    assert explained(stuck, "given").reasons == ("nothing is known", "limits.tension = …")


@pytest.mark.fast
@pytest.mark.parametrize("duration", ["fast", 0, -1.0, True, float("nan")])
def test_what_is_no_duration_is_refused(scenarios, duration):
    with pytest.raises(js.InputError, match=r"duration = .*: is no time; give seconds above 0"):
        js.plan_through(scenarios[0], LOW, duration=duration)


@pytest.mark.fast
def test_what_is_too_long_to_be_played_is_refused_with_what_could_be(scenarios):
    with pytest.raises(
        js.InputError, match=r"1e\+09 s: takes too many steps.*at most 20000 s"
    ) as no:
        js.plan(scenarios[0], duration=1e9)
    assert "--no-simulate" in str(no.value)


@pytest.mark.fast
def test_a_limit_of_zero_is_refused(scenarios):
    text = scenarios[0].to_toml().replace("[limits]", "[limits]\nspeed = 0.0")
    with pytest.raises(js.ScenarioError, match=r"limits.speed = 0.*greatest speed of the load"):
        js.Scenario.from_toml(text)


# Calm arrivals


def swing_after(plan: js.Plan, calm_for: float = 3.0) -> float:
    """Greatest tilt (degrees) after the plan has ended, while everything is held."""
    law = plan.law
    times, arc, speed, acceleration = law.states
    held = TimeLaw.passing(
        law.path, np.append(times, times[-1] + calm_for), np.append(arc, arc[-1]),
        np.append(speed, 0.0), np.append(acceleration, 0.0),
    )  # fmt: skip
    rigging = Rigging(plan.scenario, held, plan.end_path, plan.rigging.elbow_up)
    seen = simulate(rigging)
    return float(seen.tilt[seen.times > law.duration].max())


def test_a_calm_plan_leaves_a_tenth_of_the_swing_and_says_so(scenarios, tmp_path):
    plain, calm = (
        js.plan_through(scenarios[0], LOW, duration=8.0, calm=each) for each in (False, True)
    )
    assert plain.law.duration == calm.law.duration == pytest.approx(8.0)
    assert swing_after(calm) < swing_after(plain) / 10
    assert how_calm(plain) == ""
    calm.save(tmp_path / "calm.json")
    assert how_calm(js.load_plan(tmp_path / "calm.json")) == (
        "Shaped over one swing of 0.93 s, so that the load does not swing on at the goal."
    )


def test_the_swing_is_told_in_seconds_whatever_the_size_of_the_task(scenarios):
    frame = Frame(0.05, 0.05**3, (3.0, 1.0, 1.0))
    small = js.plan_through(restated(scenarios[0], frame), frame.place(LOW), calm=True)
    half, radius = small.scenario.payload.height / 2, small.scenario.payload.radius
    period = 2 * np.pi * np.sqrt((radius**2 / 4 + half**2 / 3 + half**2) / (9.81 * half))
    assert small.settings["swing_period_s"] == pytest.approx(period, rel=1e-6)
    assert f"one swing of {period:.2g} s" in how_calm(small)


@pytest.mark.fast
def test_calm_needs_a_hook_and_time(scenarios):
    with pytest.raises(js.InputError, match="calms a load that swings about one hook"):
        js.plan_through("rim", EXAMPLES["rim"], calm=True)
    assert swing_period(scenarios[0].payload) == pytest.approx(0.934, abs=1e-3)
    with pytest.raises(js.InputError, match=r"duration = 1.5 s with calm = True"):
        js.plan_through(scenarios[0], LOW, calm=True, duration=1.5)
