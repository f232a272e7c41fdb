"""What people see of a plan: figures, tables, files and views, whatever its suspension."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from scipy.spatial.transform import Rotation

import jaxsusp as js
from jaxsusp.cli.records import as_record
from jaxsusp.planning.ranking import with_settings
from jaxsusp.report.drawing import scene as scene3d
from jaxsusp.report.drawing.painting import refine
from jaxsusp.report.drawing.solids import Camera
from jaxsusp.report.drawing.style import CABLES, INK, legend, picture, subscript
from jaxsusp.report.plan import figures as planfigures
from jaxsusp.report.plan import film as pictures
from jaxsusp.report.plan import folder as planfolder
from jaxsusp.report.plan.scene import POSES, Stills, plan_view, scene
from jaxsusp.report.plan.tables import ends_table, limits_table, simulation_table
from jaxsusp.report.plan.words import summary
from jaxsusp.report.render import to_markdown, to_rich
from jaxsusp.verify.constraints import Check
from jaxsusp.verify.simulation import Simulation

END_DRIVEN = [[-1.03, 0.75, 0.8], [-2.1, 0.91, 0.56], [-2.2, 0.24, 1.3], [-0.72, -0.44, 2.04]]
BASE_DRIVEN = [[-1.74, 0.71, 0.47], [-2.5, 0.97, 1.02], [-2.4, 1.04, 2.03], [-0.7, 0.48, 2.82]]
RIM = [[-1.0, 0.9, 1.05], [-0.57, 1.45, 1.32], [0.15, 1.07, 1.64], [0.65, 0.53, 1.83]]


@pytest.fixture(scope="module")
def end_driven() -> js.Plan:
    return js.plan_through(js.load_scenario("end-driven"), END_DRIVEN)


@pytest.fixture(scope="module")
def base_driven() -> js.Plan:
    return js.plan_through(js.load_scenario("base-driven"), BASE_DRIVEN)


@pytest.fixture(scope="module")
def rim() -> js.Plan:
    return js.plan_through(js.load_scenario("rim"), RIM)


def lines(axes, color, marker="None"):
    """Lines of one colour, and with one marker."""
    return [
        line
        for line in axes.get_lines()
        if to_hex(line.get_color()).upper() == color.upper() and line.get_marker() == marker
    ]


def spots(axes, marker, face):
    """Where markers are."""
    found = [line.get_xydata() for line in axes.get_lines()
             if line.get_marker() == marker and line.get_markerfacecolor() == face]  # fmt: skip
    return np.concatenate(found) if found else np.empty((0, 2))


def test_cables_hang_from_where_the_ends_are(end_driven):
    stills = Stills.of(end_driven)
    lengths = np.linalg.norm(stills.ends - stills.lower, axis=-1)
    np.testing.assert_allclose(lengths, np.tile(end_driven.lengths[0], (POSES, 1)), atol=1e-6)
    np.testing.assert_allclose(stills.chains[:, :, 3], stills.ends, atol=1e-9)
    steps = np.linalg.norm(np.diff(stills.center, axis=0), axis=1)
    assert steps.max() < 1.5 * steps.min()


def test_the_scene_shows_ways_of_ends_that_move(end_driven):
    _, top = scene(end_driven).axes
    np.testing.assert_allclose(spots(top, "o", "white"), end_driven.ends[0, :, :2], atol=1e-6)
    np.testing.assert_allclose(spots(top, "o", INK), end_driven.ends[-1, :, :2], atol=1e-6)
    for k, color in enumerate(CABLES[:3]):
        ways = [line.get_xydata() for line in lines(top, color) if line.get_linewidth() == 1.6]
        drawn = np.concatenate(ways)
        off = np.linalg.norm(end_driven.ends[:, k, None, :2] - drawn, axis=-1).min(axis=1)
        assert off.max() < 0.02


def test_the_scene_shows_bases_that_roll(base_driven):
    _, top = scene(base_driven).axes
    feet = base_driven.rigging.bases_at(base_driven.ends[[0, -1]])[..., :2]
    np.testing.assert_allclose(spots(top, "s", "white"), feet[0], atol=1e-6)
    np.testing.assert_allclose(spots(top, "s", INK), feet[1], atol=1e-6)
    assert np.linalg.norm(feet[1] - feet[0], axis=-1).min() > 1


def test_a_load_that_turns_is_drawn_turned_with_its_cables(rim):
    stills = Stills.of(rim)
    angles = Rotation.from_matrix(stills.posture[[0, -1]]).as_euler("ZYX")[:, ::-1]
    np.testing.assert_allclose(angles, rim.angles[[0, -1]], atol=1e-9)
    assert np.abs(angles).max() > np.deg2rad(3)
    local = np.einsum("pji,pkj->pki", stills.posture, stills.lower - stills.center[:, None])
    given = np.array(rim.scenario.payload.attachments)
    np.testing.assert_allclose(local, np.tile(given, (POSES, 1, 1)), atol=1e-12)
    lengths = np.linalg.norm(stills.ends - stills.lower, axis=-1)
    np.testing.assert_allclose(lengths[[0, -1]], rim.lengths[[0, -1]], atol=1e-6)


def test_every_plan_has_the_figures_that_show_something(end_driven, rim):
    assert list(planfolder.figures_of(end_driven)) == ["kinematics", "scene", "cables", "ends"]
    assert list(planfolder.figures_of(rim)) == ["kinematics", "scene", "cables", "posture"]


def test_new_figures_are_written_with_the_others(end_driven, tmp_path, monkeypatch):
    monkeypatch.setattr(planfolder, "FIGURES", {"ends": planfigures.ends})
    written = [path.name for path in planfolder.write_plan(end_driven, tmp_path)]
    assert written[-1] == "end-driven.ends.png"
    text = (tmp_path / "end-driven.plan.md").read_text()
    assert "## Ends of the cables, moved by arms" in text
    assert "change of length" in text


def test_the_report_that_is_passed_on_says_what_became_of_the_plan(
    end_driven, tmp_path, monkeypatch
):
    def told(plan: js.Plan) -> str:
        planfolder.write_plan(plan, tmp_path)
        return (tmp_path / "end-driven.plan.md").read_text()

    monkeypatch.setattr(planfolder, "FIGURES", {})
    fine = replace(end_driven, feasible=True, reasons=())
    text = told(fine)
    assert text.startswith(
        "# end-driven\n\nend-driven: the plan is feasible and certified clear at every instant.\n\n"
        "Driven in 40 s.\n\n"
        "Not played: whether a swinging load follows, `jaxsusp verify` tells.\n\n"
        "## Constraint report (Eq. 22)\n"
    )
    found = {"fitness": 90.0, "algorithm": "routed", "way": "searched", "attempts": 1}
    played = {"simulated": True, "tracking_error_m": 2.5e-4, "tension_error": 1e-3}
    text = told(with_settings(fine, **found, **played))
    assert "Fitness 90.00, path " in text
    assert (
        "Played in simulation: a swinging load stays within 0.25 mm of the plan (allowed are 10 "
        "mm), its tensions within 0.10 % (allowed are 2 %)." in text
    )
    assert "Played in simulation.\n" in told(with_settings(fine, simulated=True))
    broken = replace(end_driven, feasible=False, reasons=("a wall is hit", "it is too late"))
    assert (
        "end-driven: the plan is infeasible:\n  - a wall is hit\n  - it is too late\n\nDriven in "
        "40 s.\n\nNot played: only plans that keep their limits are.\n" in told(broken)
    )


@pytest.mark.fast
def test_a_plan_of_an_older_version_is_told_as_far_as_it_goes():
    said = summary(js.load_plan("tests/files/scenario-1-0.1.0.plan.json"))
    assert said[0] == "scenario-1: the plan is feasible and certified clear at every instant."
    assert "Driven in 40 s." in said


def test_the_figure_of_arms_shows_ways_joint_angles_and_reach(end_driven):
    axes = planfigures.ends(end_driven).axes
    assert len(axes) == 9
    ends, joints = end_driven.ends, np.rad2deg(end_driven.joints)
    for k in range(3):
        way, turns, reach = axes[3 * k : 3 * k + 3]
        last = [line.get_ydata()[-1] for line in way.get_lines()]
        np.testing.assert_allclose(last, ends[-1, k] - ends[0, k], atol=1e-6)
        last = [line.get_ydata()[-1] for line in turns.get_lines()]
        np.testing.assert_allclose(np.exp(1j * np.deg2rad(last)),
                                   np.exp(1j * np.deg2rad(joints[-1, k])), atol=1e-6)  # fmt: skip
        distance, *bounds = (line.get_ydata() for line in reach.get_lines())
        assert [bound[0] for bound in bounds] == [1.0, 5.0]
        assert 1 < distance.min() < distance.max() < 5


def test_joint_limits_are_drawn(end_driven):
    limits = {"joint_limits_deg": (((-170.0, 170.0), (-20.0, 120.0), (-150.0, 150.0)),)}
    given = end_driven.scenario.model_copy(
        update={"limits": end_driven.scenario.limits.model_copy(update=limits)}
    )
    turns = planfigures.ends(replace(end_driven, scenario=given)).axes[1]
    assert [line.get_ydata()[0] for line in turns.get_lines()[3:]] == [
        *(-170, 170, -20, 120, -150, 150)
    ]


def test_the_figure_of_bases_shows_their_ways_and_speeds(base_driven):
    axes = planfigures.ends(base_driven).axes
    ends = base_driven.ends
    for k in range(3):
        way, speed = axes[2 * k : 2 * k + 2]
        last = [line.get_ydata()[-1] for line in way.get_lines()]
        np.testing.assert_allclose(last, (ends[-1, k] - ends[0, k])[:2], atol=1e-6)
        (line,) = speed.get_lines()
        times, rates = line.get_xdata(), line.get_ydata()
        length = np.linalg.norm(np.diff(ends[:, k], axis=0), axis=1).sum()
        assert np.trapezoid(rates, times) == pytest.approx(length, rel=5e-3)


def test_the_figure_of_the_posture_shows_angles_and_limit(rim):
    left, right = planfigures.posture(rim).axes
    for i, line in enumerate(left.get_lines()):
        seen = np.interp(rim.times, line.get_xdata(), line.get_ydata())
        np.testing.assert_allclose(seen, np.rad2deg(rim.angles[:, i]), atol=0.01)
    turn, limit = right.get_lines()
    assert limit.get_ydata()[0] == rim.scenario.limits.posture_deg
    (check,) = (each for each in rim.report if each.name.startswith("turn"))
    assert turn.get_ydata().max() == pytest.approx(check.value, abs=1e-6)


@pytest.mark.fast
@pytest.mark.parametrize(("count", "across"), [(3, 3), (4, 4), (5, 3), (6, 3), (8, 4), (9, 3)])
def test_panels_of_many_cables_stay_readable(count, across):
    figure, grid = planfigures._per_cable(count, "cable", ["length (m)", "tension (N)"])
    assert figure.get_figwidth() <= 13
    assert [len(panels) for panels in grid] == [count, count]
    columns = {axes.get_subplotspec().colspan.start for axes in figure.axes}
    assert len(columns) == across
    assert grid[1][0].get_title(loc="left") == ""
    assert grid[0][-1].get_title(loc="left").endswith(f"cable {count}")
    grid[0][0].set_ylim(0, 7)
    assert {axes.get_ylim() for axes in grid[0]} == {(0, 7)}


def test_a_table_of_ends_that_arms_move(end_driven):
    table = ends_table(end_driven)
    assert table["start"][1] == "-5.196, -3.000, 6.500"
    length = np.linalg.norm(np.diff(end_driven.position, axis=0), axis=1).sum()
    np.testing.assert_allclose(table["way"], length, rtol=5e-3)  # the ends move as the load does
    shoulders = end_driven.rigging.bases + np.array([0, 0, 4])
    reach = np.linalg.norm(end_driven.ends - shoulders, axis=-1)
    np.testing.assert_allclose(table["near"], reach.min(axis=0), atol=0.01)
    np.testing.assert_allclose(table["far"], reach.max(axis=0), atol=0.01)
    rates = np.diff(end_driven.joints, axis=0) / np.diff(end_driven.times)[:, None, None]
    assert (table["turning"] >= np.rad2deg(np.abs(rates).max(axis=(0, 2)))).all()
    assert "greatest from shoulder (m)" in to_markdown(table)


def test_a_table_of_ends_that_bases_move(base_driven):
    table = ends_table(base_driven)
    np.testing.assert_allclose(table["reach"], np.sqrt(10), atol=1e-4)
    times, k = base_driven.times, base_driven.ends.argmax() % 3
    rates = np.linalg.norm(np.diff(base_driven.ends[:, k], axis=0), axis=1) / np.diff(times)
    assert table["rolling"][k] == pytest.approx(rates.max(), rel=0.05)
    assert "bases that roll" in table.attrs["title"]


def test_a_table_of_ends_that_stay(rim):
    table = ends_table(rim)
    np.testing.assert_allclose(table[["x", "y", "z"]], rim.ends)
    np.testing.assert_allclose(table["reach"], np.sqrt(10), atol=1e-4)
    assert table.attrs["title"] == "Ends of the cables"


def test_tables_say_of_which_robot_a_limit_is(end_driven):
    table = limits_table(end_driven.report)
    assert table["of"][table["limit"] == "reach"].tolist() == ["robot 1", "robot 2", "robot 3"]


@pytest.mark.fast
def test_it_is_told_line_by_line_how_a_limit_is_known_to_be_kept():
    line = Check("least tension", 5.0, 1.0, np.inf, "N", 3.0, "cable 1")
    proved = line._replace(proved=True, bound=4.9)
    broken = line._replace(value=0.5)
    table = limits_table((proved, line, broken))
    assert table["kept"].tolist() == ["proved", "sampled", "broken"]
    captions = [
        limits_table(report).attrs["caption"]
        for report in ((proved, proved), (proved, line), (line,), (proved, broken))
    ]
    assert captions[0] == "All limits are kept, proved at every instant."
    assert captions[1].startswith("All limits are kept: 1 proved at every instant, 1 where")
    assert captions[2] == "All limits are kept where they were looked at."
    assert captions[3] == "1 limit is broken."


@pytest.mark.fast
def test_rounding_is_shown_as_zero_unless_a_limit_is_broken():
    report = (
        Check("lift of a base", 1.4e-14, -np.inf, 1e-3, "m", 1.0, "robot 1", 1e-9),
        Check("greatest tension", 100 - 1e-9, -np.inf, 100.0, "N", 1.0, "cable 1", 1e-9),
        Check("greatest tension", 100 + 5e-9, -np.inf, 100.0, "N", 1.0, "cable 1", 1e-9),
    )
    lifted, kept, broken = to_markdown(limits_table(report)).splitlines()[2:5]
    assert "| 0 m |" in lifted
    assert "| +0 |" in kept
    assert "-5.000e-09" in broken


def test_the_simulation_is_set_against_the_limits(end_driven):
    planned = np.full((3, 3), 155.0)
    seen = Simulation(
        np.array([0.0, 8.0, 16.0]), np.full((3, 3), [2e-3, 0, 0]), np.array([0, 4.0, 1]),
        np.full((3, 3), 160.0), np.zeros((3, 3)), planned, ((3.0, "1 wall"),),
    )  # fmt: skip
    table = simulation_table(seen, end_driven.scenario.limits)
    assert table["value"][:2].tolist() == ["2.00 mm", "3.23 %"]
    assert table["allowed"].tolist() == ["≤ 10 mm", "≤ 2 %", "≤ 10 °", "≤ 150 N", "none"]
    assert table["ok"].tolist() == [True, False, True, False, False]
    assert "2 s after" in table.attrs["caption"]
    assert to_rich(table).row_count == 5


def test_a_record_holds_the_ways_of_ends(end_driven):
    record = as_record(end_driven, [])
    assert np.shape(record["ends_m"]) == end_driven.ends.shape == (40, 3, 3)


def test_scenes_of_comparisons_hang_cables_from_ends_that_have_moved():
    scenario = js.load_scenario("base-driven")
    start, goal = scene3d._ends(scenario)
    np.testing.assert_allclose(start, [robot.end for robot in scenario.robots], atol=1e-9)
    hook = np.array([0, 0, scenario.payload.height / 2])
    loads = scenario.task.start + hook, scenario.task.goal + hook
    lengths = [np.linalg.norm(cables, axis=1) for cables in (start - loads[0], goal - loads[1])]
    np.testing.assert_allclose(*lengths, atol=1e-6)


def test_rendered_pictures_hold_the_whole_system(base_driven):
    view, stills = plan_view(base_driven), Stills.of(base_driven)
    points = stills.chains.reshape(-1, 3)
    points = points - (points.min(axis=0) + points.max(axis=0)) / 2
    depth = pictures._distance(points, view) - points @ view.towards
    upright = np.tan(np.deg2rad(pictures.FIELD / 2))
    share = np.abs(view.project(points)) / depth[:, None] / upright
    share[:, 0] *= pictures.HEIGHT / pictures.WIDTH
    assert share.max() == pytest.approx(1 - pictures.BORDER)


@pytest.mark.fast
def test_views_keep_posts_and_cables_aside():
    curve = [np.array([[-1.0, 0, 1], [0, 0, 1], [1, 0, 1]])]
    free = scene3d.best_view([], curve)
    foot, up = 4 * free.towards * [1, 1, 0], np.array([0, 0, 6.0])
    post = np.array([foot, foot + up])
    beside = scene3d.best_view([], curve, [post])
    assert not scene3d._covered(curve[0], refine(post, 40), beside).any()
    assert scene3d._covered(curve[0], refine(post, 40), free).any()
    along = np.array([np.zeros(3), 5 * free.towards])
    across = scene3d.best_view([], curve, lines=[along])
    assert np.linalg.norm(across.project(along[1])) > 2


@pytest.mark.fast
def test_a_post_behind_a_curve_does_not_cover_it():
    eye = Camera(-np.pi / 2, 0.0)  # looks north
    point = np.zeros((1, 3))
    assert scene3d._covered(point, np.array([[0.1, -3, 0]]), eye).all()
    assert not scene3d._covered(point, np.array([[0.1, 3, 0], [0.6, -3, 0]]), eye).any()


@pytest.mark.fast
def test_numbers_below_the_line():
    assert (subscript(7), subscript(12)) == ("₇", "₁₂")


@pytest.mark.fast
def test_a_long_legend_takes_two_rows():
    figure = picture(6.0, 3.0)
    legend(figure, figure.subplots().plot(np.zeros((2, 11)), label=list("abcdefghijk")))
    assert figure.legends[0]._ncols == 6
