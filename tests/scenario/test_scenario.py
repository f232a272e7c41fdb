"""Scenario files: what loads, what it becomes, and the sentence for everything that does not."""

import math
import pickle
import tomllib
from importlib.resources import files

import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.builtin import scenarios
from jaxsusp.scenario.models import Task
from jaxsusp.scenario.scenario import Scenario, load_scenario
from jaxsusp.scenario.toml import value_text

MINIMAL = """\
payload = { mass = 10, radius = 0.1, height = 0.3 }
task = { start = [0, 2, 1], goal = [0, -2, 3] }
robots = [
    { base = [0, 5, 0], links = [4, 3, 2], end = [0, 6, 7] },
    { base = [-4.33, -2.5, 0], links = [4, 3, 2], end = [-5.2, -3, 7] },
    { base = [4.33, -2.5, 0], links = [4, 3, 2], end = [5.2, -3, 7] },
]
"""

TOWER = '[[obstacles]]\nname = "tower"\nkind = "box"\ncenter = [2, -1, 1.8]\nsize = [1, 1, 3.6]\n'


def complaint(text, source="my.toml"):
    """The one line that a text is refused with."""
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(text, source)
    (line,) = caught.value.problems
    assert str(caught.value) == line
    return line


def changed(old, new, text=MINIMAL):
    assert old in text
    return text.replace(old, new, 1)


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


def mesh_table(**keys):
    lines = [f"{key} = {value_text(value)}" for key, value in keys.items()]
    return "\n".join(["[[obstacles]]", 'kind = "mesh"', "center = [2, 2, 0.4]", *lines, ""])


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


# What does not load, and the sentence for it.


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "mass = 10",
            "mass = 0",
            "payload.mass = 0 must be greater than 0; give the mass in kg",
        ),
        (
            "mass = 10, ",
            "",
            "payload.mass is missing; give the mass in kg",
        ),
        (
            "mass = 10",
            "mass = true",
            "payload.mass = true must be a number; give the mass in kg",
        ),
        (
            "mass = 10",
            'mass = "10 kg"',
            'payload.mass = "10 kg" must be a number; give the mass in kg',
        ),
        (
            "mass = 10",
            "mass = nan",
            "payload.mass = nan must be finite; give the mass in kg",
        ),
        (
            "mass = 10",
            "mass = 1e10",
            "payload.mass = 10000000000.0 must be at most 1e+09 in magnitude; give the mass in kg",
        ),
        (
            "radius = 0.1",
            "raduis = 0.1, radius = 0.1",
            'payload.raduis = 0.1 is not a known key; did you mean "radius"?',
        ),
        (
            "height = 0.3",
            "height = 0.3, colour = 3",
            "payload.colour = 3 is not a known key; "
            "known are mass, radius, height, attachments, center_of_mass",
        ),
        (
            "height = 0.3",
            'height = 0.3, "heavy\\nload" = 3',
            'payload."heavy\\nload" = 3 is not a known key; '
            "known are mass, radius, height, attachments, center_of_mass",
        ),
        (
            "height = 0.3",
            'height = 0.3, attachments = "hok"',
            'payload.attachments = "hok" is not one of the choices; '
            'give "hook", or one [x, y, z] in m from the centre per cable',
        ),
        (
            "height = 0.3",
            "height = 0.3, attachments = [[0, 0, 1], [0, 0, 1], [0, 0, inf]]",
            "payload.attachments[2][2] = inf must be finite; "
            'give "hook", or one [x, y, z] in m from the centre per cable',
        ),
        (
            "start = [0, 2, 1]",
            "start = [0, 2]",
            "task.start[2] is missing; give the first position [x, y, z] of the load in m",
        ),
        (
            "start = [0, 2, 1]",
            "start = [0, 2, 1, 3]",
            "task.start = [0, 2, 1, 3] has 4 entries, more than 3; "
            "give the first position [x, y, z] of the load in m",
        ),
        (
            "start = [0, 2, 1]",
            "start = 1979-05-27",
            "task.start = 1979-05-27 must be a list; "
            "give the first position [x, y, z] of the load in m",
        ),
        (
            "    { base = [0, 5, 0], links = [4, 3, 2], end = [0, 6, 7] },\n",
            "",
            "robots has only 2 of at least three entries; "
            "give one [[robots]] table with base, links and end per robot, three or more",
        ),
        (
            "links = [4, 3, 2]",
            "links = [4, -3, 2]",
            "robots[0].links[1] = -3 must be greater than 0; "
            "give the lengths of the column and of the two links in m",
        ),
        (
            "{ base = [0, 5, 0], links = [4, 3, 2], end = [0, 6, 7] }",
            "7",
            "robots[0] = 7 must be a table; "
            "give one [[robots]] table with base, links and end per robot, three or more",
        ),
        (
            "payload",
            'name = ""\npayload',
            'name = "" must not be empty; give a name in quotes',
        ),
        (
            "payload",
            "name = 7\npayload",
            "name = 7 must be text in quotes; give a name in quotes",
        ),
        (
            "payload",
            'drive = "rope"\npayload',
            'drive = "rope" is not one of the choices; '
            'give the drive mode, "cable", "end", "base" or "hybrid"',
        ),
        (
            "payload",
            "limits = 3\npayload",
            "limits = 3 must be a table; give a [limits] table",
        ),
        (
            "payload",
            "obstacle = []\npayload",
            'obstacle = [] is not a known key; did you mean "obstacles"?',
        ),
        (
            "payload",
            "obstacles = {}\npayload",
            "obstacles must be a list; "
            "give one [[obstacles]] table per box, cylinder, sphere or mesh, with its kind",
        ),
        (
            "payload",
            "limits = { tension = [100, 1] }\npayload",
            "limits.tension = [100, 1] must be [low, high] with low below high; "
            "give the least and greatest tension of a cable in N",
        ),
        (
            "payload",
            "limits = { tension = [-1, 1] }\npayload",
            "limits.tension[0] = -1 must be at least 0; "
            "give the least and greatest tension of a cable in N",
        ),
        (
            "payload",
            "limits = { cable_length = [2, 2] }\npayload",
            "limits.cable_length = [2, 2] must be [low, high] with low below high; "
            "give the least and greatest length of a cable in m",
        ),
        (
            "payload",
            "limits = { joint_limits_deg = [[[0, 1], [0, 1], [1, 0]]] }\npayload",
            "limits.joint_limits_deg[0][2] = [1, 0] must be [low, high] with low below high; "
            "give three [low, high] pairs in degrees per robot, or once for all robots",
        ),
        (
            "payload",
            "limits = { cable_radius = 0 }\npayload",
            "limits.cable_radius = 0 must be greater than 0; give the radius of a cable in m",
        ),
        (
            "payload",
            "limits = { stability = 2 }\npayload",
            "limits.stability = 2 must be at most 1; "
            "give the least stability factor S_c, from 0 (no limit) to 1",
        ),
        (
            "payload",
            "limits = { posture_deg = 181 }\npayload",
            "limits.posture_deg = 181 must be at most 180; "
            "give the greatest tilt of the load in degrees",
        ),
        (
            "payload",
            "limits = { safety_factor = 0.5 }\npayload",
            "limits.safety_factor = 0.5 must be at least 1; "
            "give the ultimate over the greatest tension of a cable, 1 or more",
        ),
        (
            "payload",
            "limits = { clearance = -0.05 }\npayload",
            "limits.clearance = -0.05 must be at least 0; "
            "give the width in m of the warning area around obstacles",
        ),
        (
            "payload",
            "workspace = { lower = [0, 4, 0] }\npayload",
            "workspace.upper[1] = 3.5 must be greater than workspace.lower[1] = 4; "
            "give the corners in m",
        ),
        (
            "payload",
            "fitness = { weights = [1, 1, 1, 1, 1, -1] }\npayload",
            "fitness.weights[5] = -1 must be at least 0; give six weights, of the terms f1 to f6",
        ),
        (
            "payload",
            "fitness = { weights = [1, 1, 1, 1, 1] }\npayload",
            "fitness.weights[5] is missing; give six weights, of the terms f1 to f6",
        ),
        (
            "payload",
            "fitness = { kappa = 0x" + "F" * 5000 + " }\npayload",
            "fitness.kappa = 0x" + "f" * 58 + "… is too large; "
            "give the penalty per collision or violation",
        ),
    ],
)
def test_a_bad_value_is_refused_in_one_sentence(old, new, line):
    assert complaint(changed(old, new)) == f"my.toml: {line}"


@pytest.mark.fast
@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "3.6]",
            "-3.6]",
            'obstacles[1] "tower".size[2] = -3.6 must be greater than 0; '
            "give the full size [x, y, z] in m",
        ),
        (
            "size = [1, 1, 3.6]",
            "",
            'obstacles[1] "tower".size is missing; give the full size [x, y, z] in m',
        ),
        (
            'name = "tower"',
            "",
            "obstacles[1].size = 3 must be a list; give the full size [x, y, z] in m",
        ),
        (
            '"box"',
            '"bocks"',
            'obstacles[1] "tower".kind = "bocks" is not a known kind; did you mean "box"?',
        ),
        (
            '"box"',
            "3",
            'obstacles[1] "tower".kind = 3 is not a known kind; '
            "known are box, cylinder, sphere, mesh",
        ),
        (
            'kind = "box"\n',
            "",
            'obstacles[1] "tower".kind is missing; '
            "give one [[obstacles]] table per box, cylinder, sphere or mesh, with its kind",
        ),
        (
            'kind = "box"',
            'kind = "box"\nbox = 3',
            'obstacles[1] "tower".box = 3 is not a known key; '
            "known are name, kind, center, size, yaw_deg",
        ),
        (
            'kind = "box"',
            'kind = "box"\nradius = 3',
            'obstacles[1] "tower".radius = 3 is not a known key; '
            "known are name, kind, center, size, yaw_deg",
        ),
    ],
)
def test_an_obstacle_is_named_by_number_and_name(old, new, line):
    ball = '[[obstacles]]\nkind = "sphere"\ncenter = [-3, -3, 0]\nradius = 0.1\n'
    tower = changed(old, new, TOWER)
    if "tower" not in tower:
        tower = changed("[1, 1, 3.6]", "3", tower)
    assert complaint(MINIMAL + ball + tower) == f"my.toml: {line}"


@pytest.mark.fast
@pytest.mark.parametrize(
    ("keys", "start", "end"),
    [
        ({"file": "gone.stl"}, 'file = "gone.stl" cannot be used (there is no file ', "gone.stl)"),
        ({"file": "empty.obj"}, 'file = "empty.obj" cannot be used (', "empty.obj holds no mesh)"),
        ({"file": "."}, 'file = "." cannot be used (there is no file ', ")"),
        ({"file": "\0"}, 'file = "\\u0000" cannot be used (there is no file ', ")"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_refused(tmp_path, keys, start, end):
    (tmp_path / "empty.obj").write_text("# nothing\n")
    line = complaint(MINIMAL + mesh_table(**keys), tmp_path / "my.toml")
    assert line.startswith(f"{tmp_path}/my.toml: obstacles[0].{start}")
    assert line.endswith(f"{end}; give the path of a mesh file, relative to the scenario file")


def test_a_scenario_built_in_python_is_checked_too():
    scenario = load_scenario("scenario-1")
    tables = {name: getattr(scenario, name) for name in ("payload", "robots", "obstacles")}
    start = scenario.obstacles[0].center
    with pytest.raises(ValidationError, match="puts the load into the warning area of obstacles"):
        Scenario(name="blocked", task=Task(start=start, goal=scenario.task.goal), **tables)


@pytest.mark.fast
def test_every_problem_is_told_at_once():
    text = changed("mass = 10", "mass = -1", changed("links = [4, 3, 2]", "links = 3"))
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(text, "my.toml")
    assert [line.split()[1] for line in str(caught.value).splitlines()] == [
        "payload.mass",
        "robots[0].links",
    ]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("mass = = 3", "is not valid TOML: Invalid value (at line 1, column 8); correct it"),
        ("a = 1\na = 2\n", "is not valid TOML: Cannot overwrite a value (at line 2, column 6)"),
        ("a = " + "[" * 10_000, "is nested too deeply; flatten it"),
    ],
)
def test_broken_toml_is_refused_with_its_line(text, line):
    assert complaint(text).startswith(f"my.toml: {line}")


def test_an_unknown_name_suggests_the_nearest():
    with pytest.raises(ScenarioError) as caught:
        load_scenario("scenaro-3")
    assert str(caught.value) == (
        'scenaro-3: is neither a file nor a built-in scenario; did you mean "scenario-3"? '
        "`jaxsusp scenarios` lists those, or give the path of a TOML file"
    )


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(ScenarioError, match=r"gone\.toml: is neither a file nor a built-in"):
        load_scenario(tmp_path / "gone.toml")
    with pytest.raises(ScenarioError, match="is a folder; give a TOML file in it"):
        load_scenario(tmp_path)
    with pytest.raises(ScenarioError, match=r"cannot be read \(.*\); give a TOML file"):
        load_scenario("a\0b")
    latin = tmp_path / "latin.toml"
    latin.write_bytes('name = "x"\n# à la carte'.encode("latin-1"))
    with pytest.raises(ScenarioError, match=r"latin\.toml: line 2 is not UTF-8; save the file as"):
        load_scenario(latin)


# Whatever the text: a scenario, or sentences.


def inline(value):
    """Any value as TOML, tables within it inline."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{value_text(key)} = {inline(v)}' for key, v in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(inline, value))}]"
    return value_text(value)


def text_of(document):
    return "".join(f"{value_text(key)} = {inline(value)}\n" for key, value in document.items())


def assert_loads_or_explains(text):
    try:
        scenario = Scenario.from_toml(text, "my.toml")
    except ScenarioError as error:
        lines = error.problems
    else:
        assert Scenario.from_toml(scenario.to_toml()) == scenario
        return
    assert lines
    for line in lines:
        assert line.startswith("my.toml: ")
        assert "; " in line
        assert "\n" not in line
        assert not any(junk in line for junk in ("pydantic", "http", "type=", "Input should"))


def numbers(low, high):
    return st.floats(low, high) | st.integers(math.ceil(low), math.floor(high))


def points(low, high):
    return st.lists(numbers(low, high), min_size=3, max_size=3)


OBSTACLE = st.one_of(  # under the floor, where nothing hangs
    st.fixed_dictionaries(
        {"kind": st.just("box"), "center": points(-50, -40), "size": points(0.01, 10)},
        optional={"name": st.text(), "yaw_deg": numbers(-400, 400)},
    ),
    st.fixed_dictionaries(
        {
            "kind": st.just("cylinder"),
            "center": points(-50, -40),
            "radius": numbers(0.01, 10),
            "height": numbers(0.01, 10),
        },
        optional={"name": st.text()},
    ),
    st.fixed_dictionaries(
        {"kind": st.just("sphere"), "center": points(-50, -40), "radius": numbers(0.01, 10)},
        optional={"name": st.text()},
    ),
)


@st.composite
def documents(draw):
    """Valid scenarios: robots on a circle, the load among them."""
    robots = []
    count = draw(st.integers(3, 6))
    for k in range(count):
        angle = 2 * math.pi * k / count
        x, y = math.cos(angle), math.sin(angle)
        robots.append({"base": [5 * x, 5 * y, 0], "links": [4, 3, 2], "end": [6 * x, 6 * y, 7]})
    place = st.tuples(numbers(-2, 2), numbers(-2, 2), numbers(0.5, 5)).map(list)
    optional = {
        "drive": st.sampled_from(["cable", "end", "base", "hybrid"]),
        "name": st.text(min_size=1),
        "obstacles": st.lists(OBSTACLE, max_size=4),
        "fitness": st.fixed_dictionaries(
            {}, optional={"weights": st.lists(numbers(0, 1e9), min_size=6, max_size=6)}
        ),
        "limits": st.fixed_dictionaries(
            {},
            optional={
                "tension": st.tuples(numbers(0, 10), numbers(11, 1e6)).map(list),
                "clearance": numbers(0, 1),
                "joint_limits_deg": st.lists(
                    st.just([[-180, 180]] * 3), min_size=count, max_size=count
                ),
            },
        ),
    }
    size = {"mass": numbers(1e-3, 1e6), "radius": numbers(0.01, 2), "height": numbers(0.01, 2)}
    below = st.tuples(st.just(0), st.just(0), numbers(-0.5, 0)).map(list)
    rim = [[0.1 * robot["base"][0], 0.1 * robot["base"][1], 0.1] for robot in robots]
    required = {
        "payload": st.fixed_dictionaries(
            {**size, "attachments": st.just("hook")}, optional={"center_of_mass": below}
        )
        | st.fixed_dictionaries(
            {**size, "attachments": st.just(rim)}, optional={"center_of_mass": points(-0.5, 0.5)}
        ),
        "task": st.fixed_dictionaries(
            {"start": place, "goal": place}, optional={"duration": numbers(0.1, 1e6)}
        ),
        "robots": st.just(robots),
    }
    return draw(st.fixed_dictionaries(required, optional=optional))


@settings(deadline=None, max_examples=30)  # numbers of robots compile on first use
@given(documents())
def test_any_valid_document_loads_and_comes_back_unchanged(document):
    scenario = Scenario.from_toml(text_of(document))
    again = Scenario.from_toml(scenario.to_toml(), "else/where.toml")
    assert again == scenario
    assert (again.digest, hash(again)) == (scenario.digest, hash(scenario))


@given(st.text())
def test_random_text_is_refused_in_sentences(text):
    assert_loads_or_explains(text)
    assert_loads_or_explains(MINIMAL + text)


ANYTHING = st.recursive(
    st.booleans() | st.integers() | st.floats() | st.text() | st.dates() | st.times(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)


def spots(document):
    """Every (container, key) of a document."""
    keys = document if isinstance(document, dict) else range(len(document))
    for key in keys:
        yield document, key
        if isinstance(document[key], dict | list):
            yield from spots(document[key])


BENCHMARK = load_scenario("scenario-1").to_toml()


@settings(deadline=None, max_examples=100)
@given(st.data())
def test_a_wrong_value_at_any_place_loads_or_is_explained(data):
    document = tomllib.loads(BENCHMARK)
    container, key = data.draw(st.sampled_from(list(spots(document))))
    match data.draw(st.sampled_from(["replace", "remove", "add"])):
        case "replace":
            container[key] = data.draw(ANYTHING)
        case "remove":
            del container[key]
        case "add" if isinstance(container, dict):
            container[data.draw(st.text())] = data.draw(ANYTHING)
        case "add":
            container.append(data.draw(ANYTHING))
    assert_loads_or_explains(text_of(document))


@given(st.text())
def test_a_random_name_is_refused_in_a_sentence(name):
    with pytest.raises(ScenarioError):
        load_scenario(f"no-such-folder/{name}.toml")


def test_an_error_survives_pickling():
    error = ScenarioError("one; a", "two; b")
    assert str(pickle.loads(pickle.dumps(error))) == "one; a\ntwo; b"
