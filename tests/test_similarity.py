"""The same task elsewhere, in another size, turned or mirrored has the same answers."""

from dataclasses import replace
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest
from elsewhere import turned, turned_points
from scipy.stats import ranksums

import jaxsusp as js
from jaxsusp.report.plan.tables import simulation_table
from jaxsusp.report.plan.words import how_followed
from jaxsusp.scenario.ownunits import Frame, in_words, restated
from jaxsusp.verify.simulation import TRACKING

FRAMES = {
    "surveyed": Frame(1.0, 1.0, (350000.0, 5500000.0, 0.0)),
    "bench": Frame(0.05, 0.05**3, (3.0, 1.0, 1.0)),
    "site": Frame(20.0, 20.0**3, (-1e7, 1e7, 500.0)),
}
TURNS = {"quarter": (1, False), "half": (2, False), "mirrored": (0, True), "both": (3, True)}


@pytest.fixture(scope="module")
def scenario() -> js.Scenario:
    """Scenario 1 with ends on the grid of own units, so that its copies are its equals."""
    scenario = js.load_scenario("scenario-1")
    rounded = {"base": (-4.330127, -2.5, 0.0), "end": (-5.1961524, -3.0, 7.0)}
    left = scenario.robots[1].model_copy(update=rounded)
    x = {name: (-place[0], *place[1:]) for name, place in rounded.items()}
    right = scenario.robots[2].model_copy(update=x)
    return scenario.model_copy(update={"robots": (scenario.robots[0], left, right)})


@pytest.fixture(scope="module")
def space(scenario) -> js.FreeSpace:
    return js.free_space(scenario, cache=False)


@pytest.fixture(scope="module")
def plan(scenario) -> js.Plan:
    return js.plan(scenario, "pso", runs=2, iterations=60, population=20)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_a_free_space_is_the_same_anywhere(scenario, space, frame):
    found = js.free_space(restated(scenario, frame), cache=False)
    np.testing.assert_allclose(found.own.b, space.b, atol=1e-7 + 1e-8 / frame.length)
    assert found.coverage == space.coverage
    np.testing.assert_allclose(found.polyline, frame.place(space.polyline), rtol=1e-9)
    assert found.length == pytest.approx(frame.length * space.length, rel=1e-6)
    assert found.contains(frame.place(space.d)).all()
    assert [each.bends for each in found.routes] == [each.bends for each in space.routes]
    ends = found.polyline[[0, -1]]
    for one, other in zip(js.routes(found, *ends), found.routes, strict=True):
        assert one.length == pytest.approx(other.length, rel=1e-6)


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_a_free_space_turns_with_its_task(scenario, space, turn):
    found = js.free_space(turned(scenario, *turn), cache=False)
    assert found.coverage == space.coverage
    np.testing.assert_allclose(found.d, turned_points(space.d, *turn), atol=1e-4)
    for one, other in zip(found.routes, space.routes, strict=True):
        assert one.length == pytest.approx(other.length, rel=1e-4)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_a_plan_is_the_same_anywhere(scenario, plan, frame):
    """Found by a search in float32, run by run the same, with everything that follows from it."""
    moved = restated(scenario, frame)
    found = js.plan(moved, "pso", runs=2, iterations=60, population=20)
    assert found.feasible
    assert found.scenario is moved
    assert found.settings["fitness"] == pytest.approx(plan.settings["fitness"], rel=1e-6)
    near = 1e-6 * frame.length + 4e-9
    np.testing.assert_allclose(found.waypoints, frame.place(plan.waypoints), atol=near)
    for name, unit in {"tensions": "N", "lengths": "m", "velocity": "m/s", "times": "s"}.items():
        known = frame.number(getattr(plan, name), unit)
        np.testing.assert_allclose(getattr(found, name), known, rtol=1e-4, atol=1e-6 * known.max())
    assert found.clearance == pytest.approx(frame.length * plan.clearance, rel=1e-4)
    for one, other in zip(found.report, plan.report, strict=True):
        assert (one.name, one.ok, one.about) == (other.name, other.ok, other.about)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_a_plan_is_verified_anywhere(scenario, plan, frame):
    moved = js.plan_through(restated(scenario, frame), frame.place(plan.waypoints))
    found, known = js.verify_plan(moved), js.verify_plan(plan)
    assert found.reasons == known.reasons == ()
    assert found.simulation.tension_error == pytest.approx(known.simulation.tension_error, rel=0.02)
    assert found.simulation.tracking_error == pytest.approx(
        frame.length * known.simulation.tracking_error, rel=0.02
    )
    assert found.simulation.times[-1] == pytest.approx(frame.number(40.0, "s"))


def test_a_fast_plan_far_away_is_the_one_that_was_saved(scenario, plan, tmp_path):
    """Rounding of places far from the world's origin grows with the third power of haste."""
    frame = Frame(1.3, 1.7, (4.1e6, 2.2e6, 10.0))
    points = frame.place(plan.waypoints)
    moved = js.plan_through(restated(scenario, frame), points, duration=2.0)
    moved.save(tmp_path / "plan.json")
    found = js.verify_plan(js.load_plan(tmp_path / "plan.json"), simulation=False)
    assert [reason for reason in found.reasons if "differs" in reason] == []
    bent = replace(moved, jerk=moved.jerk * 1.01)
    told = js.verify_plan(bent, simulation=False).reasons
    assert any(reason.startswith("jerk differs") for reason in told)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_what_is_wrong_with_a_plan_is_wrong_anywhere(scenario, frame):
    line = np.linspace(scenario.task.start, scenario.task.goal, 7)[1:-1]
    known = js.plan_through(scenario, line)
    found = js.plan_through(restated(scenario, frame), frame.place(line))
    assert len(found.reasons) == len(known.reasons) > 0
    for one, other in zip(found.certificate.contacts, known.certificate.contacts, strict=True):
        assert one.bodies == other.bodies
        assert one.time == pytest.approx(frame.number(other.time, "s"), rel=1e-4)


@pytest.mark.parametrize("turn", TURNS.values(), ids=TURNS)
def test_a_plan_turns_with_its_task(scenario, plan, turn):
    other = turned(scenario, *turn)
    found = js.plan_through(other, turned_points(plan.waypoints, *turn))
    assert found.feasible
    np.testing.assert_allclose(found.tensions, plan.tensions, rtol=1e-6)
    assert found.clearance == pytest.approx(plan.clearance, rel=1e-4)
    x = found.waypoints.reshape(-1)
    terms = js.Problem.from_scenario(other, search="box").terms(jnp.asarray(x))
    assert float(terms.total) == pytest.approx(plan.settings["fitness"], rel=1e-4)


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_a_comparison_is_the_same_anywhere(scenario, frame):
    settings = {"algorithms": "pso", "runs": 3, "iterations": 8, "population": 10}
    known = js.compare([scenario], **settings)
    found = js.compare([restated(scenario, frame)], **settings)
    np.testing.assert_array_equal(found["history"], known["history"])
    np.testing.assert_allclose(found["fitness"], known["fitness"], rtol=1e-6)
    places = known["x"].values.reshape(-1, 3)
    near = 1e-6 * frame.length + 4e-9
    np.testing.assert_allclose(found["x"].values.reshape(-1, 3), frame.place(places), atol=near)
    units = ("m", "m", "m", "N m/s²", "1/m", "1")
    factors = np.array([frame.factor(unit) for unit in units])
    np.testing.assert_allclose(found["terms"], known["terms"] * factors, rtol=1e-5)


def test_a_search_of_the_benchmark_itself_is_the_same_in_distribution():
    """Its files keep digits that copies of them lose to the grid: other runs, of one kind."""
    asked = js.load_scenario("scenario-1")
    settings = {"algorithms": "pso", "runs": 40, "iterations": 40, "population": 10}
    one, other = (
        js.compare([each], **settings)["fitness"].values.ravel()
        for each in (asked, restated(asked, FRAMES["surveyed"]))
    )
    assert not np.array_equal(one, other)
    assert ranksums(one, other).pvalue > 0.001


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_a_workspace_is_the_same_anywhere(scenario, frame):
    known = js.workspace(scenario, 0.5)
    found = js.workspace(restated(scenario, frame), 0.5 * frame.length)
    np.testing.assert_array_equal(found.admissible, known.admissible)
    np.testing.assert_array_equal(found.clear, known.clear)
    np.testing.assert_allclose(found.tensions, frame.number(known.tensions, "N"), rtol=1e-4)
    assert found.volume(found.usable) == pytest.approx(
        frame.length**3 * known.volume(known.usable), rel=1e-6
    )


def test_a_default_spacing_goes_with_the_size(scenario):
    site = restated(scenario, Frame(3.5, 43.0, (0.0, 0.0, 0.0)))
    found = js.workspace(site)
    assert 3.4e5 > found.clear.size > 2e5


@pytest.mark.parametrize("frame", FRAMES.values(), ids=FRAMES)
def test_refusals_are_the_same_anywhere_and_told_in_si_units(scenario, frame):
    heavy = scenario.payload.model_copy(update={"mass": 22.0})
    weak = scenario.model_copy(update={"payload": heavy})
    with pytest.raises(js.ImpossibleTaskError) as known:
        js.plan(weak)
    with pytest.raises(js.ImpossibleTaskError) as found:
        js.plan(restated(weak, frame))
    place = frame.place(scenario.task.start)
    text = str(found.value)
    assert text.split(" (")[0] == str(known.value).split(" (")[0]
    assert in_words(place) in text
    high = weak.limits.tension[1]
    assert f"limits.tension[1] = {frame.number(high, 'N'):g} N" in text


def test_a_rig_for_the_bench_is_planned_and_followed():
    """Half a kilogram on cables of half a metre; its weight is a twentieth of the benchmark's."""
    lab = js.load_scenario(Path(__file__).with_name("files") / "lab.toml")
    found = js.plan(lab, "taut")
    assert found.feasible
    assert found.settings["simulated"]
    again = js.verify_plan(found)
    assert again.reasons == ()
    off = found.settings["tracking_error_m"]
    assert off == pytest.approx(again.simulation.tracking_error, rel=1e-6)
    allowed = 1e3 * lab.units.length * TRACKING
    assert f"{1e3 * off:.2g} mm of the plan (allowed are {allowed:.4g} mm)" in how_followed(found)
    assert f"≤ {allowed:.4g} mm" in list(simulation_table(again.simulation, lab.limits)["allowed"])
    assert again.simulation.tension_error < 0.01
    assert again.simulation.swing < 1
