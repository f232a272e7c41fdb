"""Scenario files that do not load, and the sentence for each."""

import pickle

import pytest
from pydantic import ValidationError
from statements import MINIMAL, TOWER, changed, complaint

from jaxsusp.errors import ScenarioError
from jaxsusp.scenario.models import Task
from jaxsusp.scenario.scenario import Scenario, load_scenario


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
            "known are mass, radius, height, size, file, scale, yaw_deg, attachments, "
            "center_of_mass",
        ),
        (
            "height = 0.3",
            'height = 0.3, "heavy\\nload" = 3',
            'payload."heavy\\nload" = 3 is not a known key; '
            "known are mass, radius, height, size, file, scale, yaw_deg, attachments, "
            "center_of_mass",
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
def test_two_obstacles_of_one_name_are_refused():
    """Without names they are told apart by their numbers."""
    other = changed("[2, -1, 1.8]", "[-2, -1, 1.8]", TOWER)
    assert complaint(MINIMAL + TOWER + other) == (
        'my.toml: obstacles[1].name = "tower" is also the name of obstacles[0]; '
        "give each obstacle a name of its own, or none"
    )
    nameless = changed('name = "tower"', "", TOWER)
    again = changed('name = "tower"', "", other)
    assert len(Scenario.from_toml(MINIMAL + nameless + again).obstacles) == 2


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


def test_an_error_survives_pickling():
    error = ScenarioError("one; a", "two; b")
    assert str(pickle.loads(pickle.dumps(error))) == "one; a\ntwo; b"
