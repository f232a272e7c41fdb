"""Scenario files: what loads, and what it becomes."""

import math
import tomllib
from importlib.resources import files

import pytest
import trimesh
from statements import MINIMAL, changed, mesh_table

from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.scenario import Scenario, load_scenario

# What the six built-in scenarios are, stated apart from their files; they stay as they are.

BOX, CYLINDER, SPHERE = "box", "cylinder", "sphere"
OBSTACLES = [
    ("low wall", BOX, (-0.46, 0.46, 0.81), (1.40, 0.38, 1.62)),
    ("tower south-east", BOX, (1.14, -1.06, 1.83), (0.76, 0.54, 3.66)),
    ("pillar north-west", CYLINDER, (-1.52, 0.98, 1.745), (0.15, 3.49)),
    ("hanging ball", SPHERE, (-0.88, -0.34, 2.62), (0.39,)),
    ("tower south", BOX, (-0.85, -1.63, 1.78), (0.44, 0.50, 3.56)),
    ("crate west", BOX, (-1.40, -0.38, 0.57), (0.66, 1.16, 1.14)),
    ("pillar south-west", CYLINDER, (-2.01, -1.13, 1.68), (0.16, 3.36)),
    ("overhead beam", BOX, (1.14, -0.37, 3.17), (1.82, 0.26, 0.30)),
    ("crate north-east", BOX, (2.05, 1.82, 0.37), (1.16, 1.16, 0.74)),
    ("pillar north", CYLINDER, (0.47, 0.92, 2.06), (0.29, 4.12)),
]
LOW, HIGH = ((0, 2, 1), (0, -2, 3)), ((-2, 2, 2), (2, -2, 4))


def row(obstacle):
    """An obstacle as a row of the table."""
    match obstacle.kind:
        case "box":
            assert obstacle.yaw_deg == 0
            size = obstacle.size
        case "cylinder":
            size = (obstacle.radius, obstacle.height)
        case "sphere":
            size = (obstacle.radius,)
    return obstacle.name, obstacle.kind, obstacle.center, size


@pytest.mark.fast
def test_there_are_six_benchmark_scenarios():
    assert scenarios() == tuple(f"scenario-{i}" for i in range(1, 7))


@pytest.mark.parametrize(
    ("number", "count", "task"),
    [(1, 6, LOW), (2, 6, HIGH), (3, 8, LOW), (4, 8, HIGH), (5, 10, LOW), (6, 10, HIGH)],
)
def test_a_benchmark_scenario_is_the_one_specified(number, count, task):
    scenario = load_scenario(f"scenario-{number}")
    assert scenario.name == f"scenario-{number}"
    assert scenario.drive == "cable"
    assert (scenario.task.start, scenario.task.goal, scenario.task.duration) == (*task, 40)
    assert [row(obstacle) for obstacle in scenario.obstacles] == OBSTACLES[:count]

    payload, limits, robots = scenario.payload, scenario.limits, scenario.robots
    assert (payload.mass, payload.radius, payload.height) == (10, 0.1, 0.3)
    assert (payload.attachments, payload.center_of_mass) == ("hook", (0, 0, 0))
    assert (limits.tension, limits.cable_length) == ((1, 100), (0.5, 15))
    assert (limits.clearance, limits.cable_radius, limits.separation) == (0.05, 0.01, 0.5)
    assert (limits.posture_deg, limits.stability, limits.safety_factor) == (10, 0, 1.5)
    assert limits.joint_limits_deg is None
    assert scenario.workspace.lower == (-3.5, -3.5, 0.2)
    assert scenario.workspace.upper == (3.5, 3.5, 5.5)
    assert (scenario.fitness.weights, scenario.fitness.kappa) == ((1,) * 6, 1000)

    x, y = 2.5 * math.sqrt(3), 2.5
    assert [robot.base for robot in robots] == [(0, 5, 0), (-x, -y, 0), (x, -y, 0)]
    for robot in robots:
        assert robot.links == (4, 3, 2)
        assert (robot.link_radius, robot.column_radius) == (0.08, 0.12)
        assert robot.end == pytest.approx((1.2 * robot.base[0], 1.2 * robot.base[1], 7), abs=1e-15)


def test_a_benchmark_file_states_every_value():
    for name in scenarios():
        text = (files("jaxsusp.scenario") / f"data/scenarios/{name}.toml").read_text(
            encoding="utf-8"
        )
        assert tomllib.loads(text) == tomllib.loads(load_scenario(name).to_toml())


# What loads.


def test_a_short_file_gets_the_defaults_of_the_benchmark():
    scenario = Scenario.from_toml(MINIMAL, "yard/crane.toml")
    benchmark = load_scenario("scenario-1")
    assert scenario.name == "crane"
    assert scenario.obstacles == ()
    for table in ("limits", "workspace", "fitness"):
        assert getattr(scenario, table) == getattr(benchmark, table)
    assert scenario.task == benchmark.task


@pytest.mark.fast
def test_whole_numbers_stand_for_floats():
    mass = Scenario.from_toml(MINIMAL).payload.mass
    assert (mass, type(mass)) == (10.0, float)


def test_separate_attachments_and_joint_limits_are_read():
    rim = "attachments = [[0, 0.1, 0.15], [-0.09, -0.05, 0.15], [0.09, -0.05, 0.15]]"
    joints = "limits = { joint_limits_deg = [[[-180, 180], [-90, 90], [0, 170]]] }\n"
    scenario = Scenario.from_toml(joints + changed("height = 0.3", f"height = 0.3, {rim}"))
    assert scenario.payload.attachments[1] == (-0.09, -0.05, 0.15)
    assert scenario.limits.joint_limits_deg == (((-180, 180), (-90, 90), (0, 170)),)
    assert Scenario.from_toml(scenario.to_toml()) == scenario


def test_a_file_is_loaded_by_its_path(tmp_path):
    file = tmp_path / "yard.toml"
    file.write_bytes(b"\xef\xbb\xbf" + MINIMAL.replace("\n", "\r\n").encode())  # as Windows does
    assert load_scenario(file) == load_scenario(str(file)) == Scenario.from_toml(MINIMAL, file)


def test_a_mesh_is_found_beside_its_scenario_and_survives_a_copy_elsewhere(tmp_path):
    trimesh.creation.box((10, 20, 30)).export(tmp_path / "crate.stl")
    file = tmp_path / "yard.toml"
    file.write_text(MINIMAL + mesh_table(file="crate.stl", scale=0.02, shape="hull"))
    scenario = load_scenario(file)
    assert scenario.obstacles[0].path == tmp_path / "crate.stl"
    assert Scenario.from_toml(scenario.to_toml(), "elsewhere/yard.toml") == scenario


def test_the_digest_is_of_the_content_not_of_the_place(tmp_path):
    digests = []
    for folder, size in [("one", 1), ("two", 1), ("three", 2)]:
        (tmp_path / folder).mkdir()
        trimesh.creation.box((1, 1, size)).export(tmp_path / folder / "crate.stl")
        file = tmp_path / folder / "yard.toml"
        file.write_text(MINIMAL + mesh_table(file="crate.stl", scale=0.5))
        digests.append(load_scenario(file).digest)
    assert digests[0] == digests[1] != digests[2]


def test_the_digest_ignores_how_a_value_is_written_but_not_the_value():
    digest = Scenario.from_toml(MINIMAL).digest
    assert Scenario.from_toml(changed("[0, 6, 7]", "[-0.0, 6.0, 7e0]")).digest == digest
    assert Scenario.from_toml(changed("mass = 10", "mass = 10.000001")).digest != digest


def test_the_digests_of_the_benchmark_never_move():
    digests = {name: load_scenario(name).digest[:8] for name in scenarios()}
    assert digests == {
        "scenario-1": "41ab5dbc",
        "scenario-2": "adea2c77",
        "scenario-3": "db3019fb",
        "scenario-4": "413319b6",
        "scenario-5": "08cdf869",
        "scenario-6": "fb1d139a",
    }


def test_a_scenario_is_one_line_for_people():
    scenario = load_scenario("scenario-1")
    said = "<Scenario 'scenario-1': 3 robots, 6 obstacles, drive 'cable'>"
    assert repr(scenario) == str(scenario) == said
    one = scenario.model_copy(update={"obstacles": scenario.obstacles[:1]})
    assert "3 robots, 1 obstacle, drive" in repr(one)
