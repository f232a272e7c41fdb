"""The page of `jaxsusp show` in a real browser, without a network."""

from dataclasses import replace

import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.ellipsoid import Ellipsoid
from jaxsusp.freespace.iris import Region
from jaxsusp.freespace.polyhedra import HalfSpaces
from jaxsusp.freespace.space import assemble
from jaxsusp.scenario.ownunits import Frame, restated

pytestmark = pytest.mark.pages

HOSTILE = "</script><script>window.hacked = 1</script><img src=x onerror=window.hacked=1>"
PHONE = {"viewport": {"width": 390, "height": 844}}


def picture(shown) -> bytes:
    """The scene as it is, when it has been drawn, and no field before it has the focus."""
    shown.page.evaluate("document.activeElement.blur()")
    shown.page.mouse.move(5, 5)
    shown.page.wait_for_timeout(150)
    return shown.page.locator("#view").screenshot()


def test_the_slider_puts_the_load_where_the_plan_has_it(visit, file, plan):
    shown = visit(file)
    for time in (0.0, 11.3, 20.0, 40.0):
        shown.seek(time)
        step = 40 / 400
        nearest = round(time / step) * step
        there = plan.at(np.array([nearest])).position[0]
        np.testing.assert_allclose(shown.state["load"], there, atol=2e-6)
    shown.page.evaluate("window.jaxsusp.seek(11.337)")
    there = plan.at(np.array([11.337])).position[0]
    np.testing.assert_allclose(shown.state["load"], there, atol=1e-4)


def test_curves_follow_with_their_values(visit, file, plan):
    shown = visit(file)
    shown.seek(20.0)
    tensions = plan.loads_at(np.array([20.0])).tensions[0]
    panel = shown.page.locator(".curve").first
    assert panel.locator("b").all_inner_texts() == [f"{tension:.2f}" for tension in tensions]
    assert "at least 1.00, at most 100" in panel.locator("canvas").get_attribute("aria-label")


def test_a_click_into_a_curve_goes_there(visit, file):
    shown = visit(file)
    box = shown.page.locator(".curve div").first.bounding_box()
    shown.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert 17 < shown.state["time"] < 18.5  # half of the panel, which has numbers on its left


def test_layers_are_switched(visit, file):
    shown = visit(file)
    shown.page.locator("#layers summary").click()
    before = picture(shown)
    shown.page.get_by_label("Warning areas").check()
    assert "warning" not in shown.state["hidden"]
    warned = picture(shown)
    assert warned != before
    shown.page.get_by_label("Shadows for cable 1").check()
    assert picture(shown) != warned
    shown.page.get_by_label("Shadows for cable 1").uncheck()
    shown.page.get_by_label("Warning areas").uncheck()
    assert picture(shown) == before


def test_plans_are_switched_and_shown_together(visit, file, refused):
    shown = visit(file)
    shown.seek(20.0)
    assert shown.page.locator("#verdict").inner_text().startswith("Feasible")
    assert not shown.page.locator("#reasons").is_visible()
    alone = picture(shown)
    shown.page.get_by_label("Show plan 2 beside the chosen one").check()
    assert shown.state["beside"] == ["plan 2"]
    assert picture(shown) != alone
    shown.page.get_by_label("plan 2 infeasible").check()
    assert shown.state["track"] == "plan 2"
    assert shown.state["beside"] == []
    there = refused.at(np.array([20.0])).position[0]
    np.testing.assert_allclose(shown.state["load"], there, atol=2e-6)
    assert shown.page.locator("#verdict").inner_text() == "Infeasible"
    assert shown.page.locator("#reasons li").all_inner_texts() == list(refused.reasons)


def test_the_tightest_moment_is_one_click_away(visit, file, refused):
    """Of a plan that hits something it is a moment at which it does."""
    shown = visit(file)
    shown.page.get_by_label("plan 2 infeasible").check()
    shown.page.locator("#tightest").click()
    worst = min(refused.report, key=lambda each: each.margin if each.unit == "m" else np.inf)
    assert shown.state["time"] == pytest.approx(worst.time, abs=1e-6)
    first = shown.page.locator("#limits tbody tr").first
    assert first.get_attribute("class") == "broken tightest"
    first.get_by_role("button").click()
    assert shown.state["time"] == pytest.approx(worst.time, abs=1e-6)


def test_all_of_it_works_from_the_keyboard(visit, file):
    shown = visit(file)
    keys = shown.page.keyboard
    keys.press("ArrowRight")
    assert shown.state["time"] == pytest.approx(0.2)
    keys.press("End")
    assert shown.state["time"] == pytest.approx(40.0)
    keys.press("Home")
    keys.press(" ")
    assert shown.state["playing"]
    for _ in range(200):
        shown.page.wait_for_timeout(20)
        if shown.state["time"] > 0.5:
            break
    keys.press(" ")
    assert not shown.state["playing"]
    assert 0.5 < shown.state["time"] < 40
    keys.press("t")
    at = float(shown.page.locator("#tightest").inner_text().split()[1])
    assert shown.state["time"] == pytest.approx(at, abs=0.06)
    reached = []
    for _ in range(12):
        keys.press("Tab")
        reached.append(shown.page.evaluate("document.activeElement.id"))
        outline = "getComputedStyle(document.activeElement).outlineStyle"
        assert shown.page.evaluate(outline) == "solid"
    assert {"view", "play", "time", "speed", "tightest"} <= set(reached)
    shown.page.locator("#play").focus()
    keys.press("Enter")
    assert shown.state["playing"]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_phone(visit, file, scheme):
    shown = visit(file, color_scheme=scheme, has_touch=True, **PHONE)
    assert shown.page.evaluate("document.documentElement.scrollWidth") <= 390
    for name in ("#view", "#play", "#time", "#tightest"):
        box = shown.page.locator(name).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 390
    assert shown.page.locator("#play").bounding_box()["y"] < 844
    paper = shown.page.evaluate("getComputedStyle(document.body).backgroundColor")
    light = sum(map(int, paper.strip("rgb()").split(","))) > 3 * 128
    assert light == (scheme == "light")


def test_names_are_only_names(visit, plan, tmp_path):
    obstacles = [each.model_copy(update={"name": HOSTILE}) for each in plan.scenario.obstacles]
    scenario = plan.scenario.model_copy(update={"name": HOSTILE, "obstacles": tuple(obstacles)})
    reasons = (f"load hits {HOSTILE}",)
    hostile = replace(plan, scenario=scenario, feasible=False, reasons=reasons)
    page = js.show(hostile, path=tmp_path / "hostile.html")
    assert HOSTILE not in page.text
    shown = visit(tmp_path / "hostile.html")
    assert shown.page.evaluate("window.hacked") is None
    assert shown.page.locator("#title").inner_text() == HOSTILE
    assert shown.page.locator("#reasons li").inner_text() == reasons[0]
    frame = shown.context.new_page()  # as in a notebook
    frame.set_content(page._repr_html_())
    frame.frame_locator("iframe").locator("#play").wait_for()
    assert frame.evaluate("window.hacked || frames[0].hacked") is None


def test_nothing_that_is_added_to_a_page_runs(browser, file, tmp_path):
    """Not even where a name got through: only the page's own code is allowed to."""
    text = file.read_text().replace("</body>", "<script>window.hacked = 1</script></body>")
    (tmp_path / "added.html").write_text(text)
    page = browser.new_page()
    page.goto((tmp_path / "added.html").as_uri())
    assert page.evaluate("[window.hacked, Boolean(window.jaxsusp)]") == [None, True]
    page.close()


def test_it_is_exact_in_survey_coordinates(visit, plan, tmp_path):
    frame = Frame(0.05, 0.02, (350_000.0, 5_500_000.0, 120.0))
    moved = plan.stated(restated(plan.scenario, frame))
    js.show(moved, path=tmp_path / "far.html")
    shown = visit(tmp_path / "far.html")
    half = moved.law.duration / 2
    shown.page.evaluate(f"window.jaxsusp.seek({half})")
    there = moved.at(np.array([half])).position[0]
    np.testing.assert_allclose(shown.state["load"], there, atol=1e-6 * frame.length + 4e-9)
    ticks = shown.page.locator("#labels .axis").all_inner_texts()
    assert ticks == ["x − 350000 (m)", "y − 5500000 (m)", "z (m)"]


@pytest.fixture(scope="module")
def roomy(plan):
    """Forty boxes as the free space of the plan's scenario."""
    low, high = np.array(plan.scenario.workspace.lower), np.array(plan.scenario.workspace.upper)
    rng = np.random.default_rng(0)
    regions = []
    for corner in rng.uniform(low, high - 2.0, (40, 3)):
        box = HalfSpaces.box(corner, corner + 2.0)
        regions.append(Region(box, Ellipsoid.ball(corner + 1.0, 1.0)))
    bodies = bodies_of(plan.scenario)
    return assemble(
        regions, adjacency=np.eye(40, dtype=bool), route=np.array([0]), coverage=0.5, bound=0.0,
        polyline=np.array([plan.scenario.task.start, plan.scenario.task.goal]),
        bodies=tuple(body.faces for body in bodies), body_names=tuple(body.name for body in bodies),
    )  # fmt: skip


MEASURE = """new Promise((done) => {
  const before = jaxsusp.frames, began = performance.now(), steps = [];
  const step = () => {
    jaxsusp.seek(20 * (performance.now() - began) / 2000);
    steps.push(jaxsusp.script);
    if (performance.now() - began < 2000) return requestAnimationFrame(step);
    const rate = (jaxsusp.frames - before) / ((performance.now() - began) / 1000);
    steps.sort((a, b) => a - b);
    done([rate, steps[Math.floor(steps.length / 2)], steps.at(-1), jaxsusp.calls]);
  };
  step();
})"""


def test_forty_regions_are_few_draw_calls(visit, plan, roomy, tmp_path, capsys):
    """Frames and script time depend on the machine: they are told, not judged."""
    page = js.show(plan, roomy, path=tmp_path / "roomy.html")
    assert len(page.text) < 6e6
    shown = visit(tmp_path / "roomy.html")
    bare = picture(shown)
    shown.page.locator("#layers summary").click()
    shown.page.get_by_label("Free regions (40)").check()
    assert picture(shown) != bare
    rate, middle, most, calls = shown.page.evaluate(MEASURE)
    with capsys.disabled():
        print(f"\n40 regions: {rate:.0f} frames/s, {middle:.1f} ms a step (most {most:.1f} ms)")
    assert calls <= 30


def test_a_free_space_alone_says_what_is_missing(visit, roomy, tmp_path):
    js.show(roomy, path=tmp_path / "space.html")
    shown = visit(tmp_path / "space.html")
    assert "no robots and no obstacles" in shown.page.locator("#notes").inner_text()
    assert not shown.page.locator("#transport").is_visible()


def test_a_scenario_without_a_plan_hangs_at_start_and_goal(visit, scenarios, tmp_path):
    js.show(scenarios[0], path=tmp_path / "scene.html")
    shown = visit(tmp_path / "scene.html")
    assert shown.state["beside"] == ["at the goal"]
    np.testing.assert_allclose(shown.state["load"], scenarios[0].task.start, atol=1e-6)
    assert not shown.page.locator("#transport").is_visible()


def test_a_task_that_cannot_be_says_why(visit, scenarios, tmp_path):
    text = scenarios[0].to_toml().replace("goal = [0.0, -2.0", "goal = [0.0, -9.0")
    task = js.Scenario.from_toml(text, task_checked=False)
    assert task.troubles
    js.show(task, path=tmp_path / "blocked.html")
    shown = visit(tmp_path / "blocked.html")
    told = shown.page.locator("#verdict").inner_text()
    assert told == "Start or goal is no place for the load"
    assert shown.page.locator("#reasons li").all_inner_texts() == list(task.troubles)
