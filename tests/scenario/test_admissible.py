"""Start, goal and ends: which tasks are refused although every single value is fine."""

import jax
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.admissible import _surrounded
from jaxsusp.scenario.scenario import Scenario

CLEARANCE, CABLE, RADIUS, HEIGHT = 0.05, 0.01, 0.1, 0.3
START, ENDS = (0.0, 1.0, 2.0), ((0, 6, 7), (-5, -3, 7), (5, -3, 7))
BASES = ((0, 5, 0), (-4, -2.5, 0), (4, -2.5, 0))


def text(start=START, goal=(0, -1, 2), ends=ENDS, payload="", limits="", obstacles=""):
    robots = "\n".join(
        f"[[robots]]\nbase = {list(base)}\nlinks = [4, 3, 2]\nend = {list(end)}"
        for base, end in zip(BASES, ends, strict=True)
    )
    return f"""
[payload]
mass = 10
radius = {RADIUS}
height = {HEIGHT}
{payload}
[limits]
clearance = {CLEARANCE}
cable_radius = {CABLE}
{limits}
[task]
start = {list(start)}
goal = {list(goal)}
{robots}
{obstacles}
"""


def obstacle(name="", **keys):
    lines = (f"{key} = {value!r}" for key, value in keys.items())
    return "\n".join(["[[obstacles]]", f'name = "{name}"', *lines, ""])


def complaints(**changes):
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(text(**changes), "my.toml")
    for line in caught.value.problems:
        assert line.startswith("my.toml: ")
    return [line.removeprefix("my.toml: ") for line in caught.value.problems]


def loads(**changes):
    """Whether the scenario is admissible."""
    try:
        Scenario.from_toml(text(**changes))
    except ScenarioError:
        return False
    return True


@pytest.mark.fast
def test_the_plain_task_is_admissible():
    assert loads()


@pytest.mark.fast
def test_an_end_is_in_reach_up_to_the_stretched_arm():
    assert loads(ends=[(0, 9, 7), *ENDS[1:]])  # 3-4-5: exactly 5 m from the shoulder at (0, 5, 4)
    assert complaints(ends=[(0, 9.001, 7), *ENDS[1:]]) == [
        "robots[0].end = [0.0, 9.001, 7.0] is out of reach: 5.001 m from the shoulder, and the arm "
        "reaches 1 to 5 m; move the end or the base, or change the links"
    ]
    assert complaints(ends=[(0, 5.5, 4.5), *ENDS[1:]], goal=START) == [
        "robots[0].end = [0.0, 5.5, 4.5] is out of reach: 0.7071 m from the shoulder, and the arm "
        "reaches 1 to 5 m; move the end or the base, or change the links"
    ]


def test_ends_closer_than_the_separation_are_refused():
    assert complaints(limits="separation = 11") == [
        "robots[1].end = [-5.0, -3.0, 7.0] is 10.3 m from robots[0].end, less than "
        "limits.separation = 11 m; move them apart",
        "robots[2].end = [5.0, -3.0, 7.0] is 10.3 m from robots[0].end, less than "
        "limits.separation = 11 m; move them apart",
        "robots[2].end = [5.0, -3.0, 7.0] is 10 m from robots[1].end, less than "
        "limits.separation = 11 m; move them apart",
    ]
    assert loads(limits="separation = 10")


def test_a_start_or_goal_outside_the_workspace_is_refused():
    assert complaints(start=(0, 1, 0.1), goal=(0, -1, 5.6)) == [
        "task.start[2] = 0.1 is outside the workspace, whose z is 0.2 to 5.5 m; move it inside, or "
        "give a [workspace] table, which was left out",
        "task.goal[2] = 5.6 is outside the workspace, whose z is 0.2 to 5.5 m; move it inside, or "
        "give a [workspace] table, which was left out",
    ]
    assert loads(start=(0, 1, 0.2), goal=(0, -1, 5.5))


def test_ends_not_above_the_load_are_refused():
    low = [(0, 6, 5), *ENDS[1:]]
    assert complaints(goal=(0, -1, 4.9), ends=low) == [
        "task.goal = [0.0, -1.0, 4.9] puts the lower end of the cable of robots[0] at z = 5.05 m, "
        "not below the upper end at z = 5 m; lower it or raise the end"
    ]
    assert loads(goal=(0, -1, 4.8), ends=low)


def test_a_hook_outside_the_polygon_of_the_ends_is_refused():
    near = [(0, 3, 6), (-4, -1, 7), (4, -1, 7)]
    assert complaints(goal=(0, -1.1, 2), ends=near) == [
        "task.goal = [0.0, -1.1, 2.0] puts the hook outside the polygon of the cables' ends, "
        "seen from above; move it or the ends"
    ]
    assert not loads(goal=(0, -1, 2), ends=near)  # on its boundary
    assert loads(goal=(0, -0.9, 2), ends=near)


def test_with_separate_attachments_the_centre_of_mass_must_be_in_the_polygon():
    near = [(0, 3, 6), (-4, -1, 7), (4, -1, 7)]
    rim = "attachments = [[0, 0.1, 0.1], [-0.1, -0.1, 0.1], [0.1, -0.1, 0.1]]"
    assert loads(goal=(0, -0.9, 2), ends=near, payload=rim)
    payload = f"{rim}\ncenter_of_mass = [0, -0.2, 0]"
    assert complaints(goal=(0, -0.9, 2), ends=near, payload=payload) == [
        "task.goal = [0.0, -0.9, 2.0] puts the centre of mass outside the polygon of the cables' "
        "ends, seen from above; move it or the ends"
    ]


@pytest.mark.fast
def test_the_attachments_must_be_as_many_as_the_robots():
    assert complaints(payload="attachments = [[0, 0, 0.1], [0, 0, 0.1]]") == [
        'payload.attachments has 2 entries for 3 robots; give one [x, y, z] per robot, or "hook"'
    ]
    assert complaints(payload="attachments = []") == [
        "payload.attachments = [] has 0 entries for 3 robots; "
        'give one [x, y, z] per robot, or "hook"'
    ]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("attachments", "where"),
    [
        ("[[0, 0.1, 0.1], [0, 0, 0.1], [0, -0.2, 0.1]]", "on one line"),
        ("[[0.1, 0, 0.1], [0.1, 0, 0.1], [0.1, 0, 0.1]]", "at one point"),
    ],
)
def test_attachments_on_one_line_are_refused(attachments, where):
    assert complaints(payload=f"attachments = {attachments}") == [
        f"payload.attachments are all {where}, about which nothing holds the load; "
        'spread them, or give "hook"'
    ]


@pytest.mark.parametrize("center", ["[0.01, 0.0, 0.0]", "[0.0, -0.2, -0.1]", "[0.0, 0.0, 0.2]"])
def test_a_hook_that_is_not_straight_above_the_centre_of_mass_is_refused(center):
    assert complaints(payload=f"center_of_mass = {center}") == [
        f"payload.center_of_mass = {center} is not straight below the hook, so the load would "
        "tilt or turn over; give [0, 0, z] below half the height, or one attachment per cable"
    ]
    assert loads(payload="center_of_mass = [0, 0, -0.1]")


def test_joint_limits_are_given_once_or_per_robot():
    triple = "[[0, 1], [0, 1], [0, 1]]"
    assert loads(limits=f"joint_limits_deg = [{triple}]")
    assert loads(limits=f"joint_limits_deg = [{triple}, {triple}, {triple}]")
    assert complaints(limits=f"joint_limits_deg = [{triple}, {triple}]") == [
        "limits.joint_limits_deg has 2 entries for 3 robots; "
        "give three [low, high] pairs per robot, or once for all"
    ]


def test_a_load_in_a_warning_area_is_refused_once():
    floor = obstacle("slab", kind="box", center=[0, 1, 1.7], size=[1, 1, 0.21])
    assert complaints(obstacles=floor) == [
        "task.start = [0.0, 1.0, 2.0] puts the load into the warning area of "
        'obstacles[0] "slab"; move it or the obstacle'
    ]


def ball_on_cable(k, attachment):
    """A ball in the middle of the cable of robot k at the start."""
    middle = (np.add(START, attachment) + ENDS[k]) / 2
    return obstacle("ball", kind="sphere", center=middle.tolist(), radius=0.2)


def test_a_cable_in_a_warning_area_is_named():
    far = obstacle(kind="sphere", center=[3, 3, 0.5], radius=0.2)
    assert complaints(obstacles=far + ball_on_cable(2, (0, 0, HEIGHT / 2))) == [
        "task.start = [0.0, 1.0, 2.0] puts the cable of robots[2] into the warning area of "
        'obstacles[1] "ball"; move it, the end or the obstacle'
    ]


def test_separate_attachments_lead_their_cables_elsewhere():
    ball = ball_on_cable(1, (-0.8, -0.8, 0))
    rim = "attachments = [[0, 0.8, 0], [-0.8, -0.8, 0], [0.8, -0.8, 0]]"
    assert loads(obstacles=ball)
    assert complaints(obstacles=ball, payload=rim) == [
        "task.start = [0.0, 1.0, 2.0] puts the cable of robots[1] into the warning area of "
        'obstacles[0] "ball"; move it, the end or the obstacle'
    ]


BEYOND = 1e-6  # m; float32 arithmetic, with its extra margin of 1e-4 m, could not tell


def around(start):
    """Obstacles of every kind that just touch the load's or a cable's warning area from outside."""
    x, y, z = start
    side, top = RADIUS + CLEARANCE, HEIGHT / 2 + CLEARANCE
    hook, end = np.add(start, (0, 0, HEIGHT / 2)), np.array(ENDS[0])
    along = (end - hook) / np.linalg.norm(end - hook)
    across = np.cross(along, (1, 0, 0))
    middle = hook + 2 * along
    return {
        "box beside the load": lambda gap: obstacle(
            kind="box", center=[x + 0.5 + side + gap, y, z], size=[1, 0.1, 0.1]
        ),
        "turned box beside the load": lambda gap: obstacle(
            kind="box", center=[x, y - 0.5 - side - gap, z], size=[1, 0.1, 0.1], yaw_deg=90
        ),
        "cylinder beside the load": lambda gap: obstacle(
            kind="cylinder", center=[x - 0.3 - side - gap, y, z], radius=0.3, height=0.1
        ),
        "cylinder below the load": lambda gap: obstacle(
            kind="cylinder", center=[x, y, z - 0.2 - top - gap], radius=0.3, height=0.4
        ),
        "sphere beside the load": lambda gap: obstacle(
            kind="sphere", center=[x - 0.3 - side - gap, y, z], radius=0.3
        ),
        "sphere beside a cable": lambda gap: obstacle(
            kind="sphere",
            center=(middle + (0.3 + CABLE + CLEARANCE + gap) * across).tolist(),
            radius=0.3,
        ),
    }


@pytest.mark.parametrize("x64", [True, False])
@pytest.mark.parametrize("where", around(START))
def test_the_warning_area_is_as_wide_as_the_clearance_in_any_precision(where, x64):
    place = around(START)[where]
    with jax.enable_x64(x64):
        assert loads(obstacles=place(BEYOND))
        assert not loads(obstacles=place(-BEYOND))


corners = st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=3, max_size=7)


@given(corners, st.tuples(st.floats(-9, 9), st.floats(-9, 9)))
def test_the_polygon_test_agrees_with_the_convex_hull(corners, point):
    corners, point = np.round(corners, 3), np.round(point, 3)
    assume(np.linalg.svd(corners - corners[0], compute_uv=False)[1] > 1e-2)  # not in a line
    facets = ConvexHull(corners).equations
    depth = -(facets[:, :2] @ point + facets[:, 2]).max()
    assume(abs(depth) > 1e-9)
    assert _surrounded(point, corners) == (depth > 0)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("point", "inside"),
    [((0, 0), False), ((2, 0), False), ((1, 0), False), ((1, 1), True), ((3, 3), False)],
)
def test_corners_and_edges_of_the_polygon_are_outside(point, inside):
    triangle = np.array([(0.0, 0.0), (2.0, 0.0), (1.0, 3.0)])
    assert _surrounded(np.array(point, float), triangle) == inside


@pytest.mark.fast
def test_ends_in_a_line_surround_nothing():
    line = np.array([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)])
    assert not _surrounded(np.array([0.5, 0.5]), line)
    assert not _surrounded(np.array([2.0, 1.0]), line)
    assert not _surrounded(line[1], line[[1, 1, 1]])


@pytest.mark.parametrize("drive", ["cable", "end", "hybrid", "base"])
def test_no_obstacle_stands_in_the_column_of_a_robot_whose_base_stays(drive):
    """The column at (0, 5) is 0.12 m wide and keeps 0.05 m: a ball of 0.2 m needs 0.37 m."""

    def ball(away: float) -> str:
        return text(obstacles=obstacle("ball", kind="sphere", center=[0, 5 + away, 2], radius=0.2))

    Scenario.from_toml(f'drive = "{drive}"\n' + ball(0.371))
    if drive == "base":
        Scenario.from_toml(f'drive = "{drive}"\n' + ball(0.369))
        return
    with pytest.raises(ScenarioError, match=r"robots\[0\]\.base = .*column.*obstacles\[0\] \"ball"):
        Scenario.from_toml(f'drive = "{drive}"\n' + ball(0.369))
