"""Scenario files that do not load, and the sentence for each."""

import pickle

import numpy as np
import pytest
import trimesh
from pydantic import ValidationError
from statements import MINIMAL, TOWER, changed, complaint, mesh_table

from jaxsusp.errors import ScenarioError
from jaxsusp.geometry.meshes import MeshError
from jaxsusp.scenario import models
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


@pytest.mark.fast
@pytest.mark.parametrize(
    ("keys", "start", "end"),
    [
        ({"file": "gone.stl"}, 'file = "gone.stl" cannot be used (there is no file ', "gone.stl)"),
        ({"file": "empty.obj"}, 'file = "empty.obj" cannot be used (', "empty.obj holds no mesh)"),
        ({"file": "\0"}, 'file = "\\u0000" cannot be used (there is no file ', ")"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_refused(tmp_path, keys, start, end):
    (tmp_path / "empty.obj").write_text("# nothing\n")
    line = complaint(MINIMAL + mesh_table(**keys), tmp_path / "my.toml")
    assert line.startswith(f"{tmp_path}/my.toml: obstacles[0].{start}")
    assert line.endswith(f"{end}; give the path of a mesh file, relative to the scenario file")


@pytest.mark.parametrize("table", ["payload", "obstacles[0]"])
@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("", 'file = "" is empty; give the path of a mesh file, relative to the scenario file'),
        (".", 'file = "." cannot be used ({} is a folder); give a mesh file in it'),
        ("point.obj", 'file = "point.obj" cannot be used ({}/point.obj is but one point: all '
         "corners of its triangles are there); export it anew as STL, OBJ, PLY, OFF or glTF"),
        ("part.fbx", 'file = "part.fbx" cannot be used ({}/part.fbx cannot be read as a mesh: '
         ".fbx is no format that is read); give a file of STL, OBJ, PLY, OFF or glTF, with its "
         "suffix"),
    ],
)  # fmt: skip
def test_what_a_mesh_needs_is_the_end_of_its_line(tmp_path, table, file, line):
    (tmp_path / "point.obj").write_text("v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n")
    (tmp_path / "part.fbx").write_text("part")
    text = MINIMAL + mesh_table(file=file)
    if table == "payload":
        text, line = load(f'file = "{file}"'), line + ": the load is its hull" * (not file)
    found = complaint(text, tmp_path / "my.toml")
    assert found == f"{tmp_path}/my.toml: {table}.{line.format(tmp_path)}"


def load(keys, mass=10):
    """A scenario with another load."""
    return changed("mass = 10, radius = 0.1, height = 0.3", f"mass = {mass}, {keys}")


@pytest.fixture
def crate(tmp_path):
    """A scenario file beside a mesh 0.6 m wide, crate.stl, and the same in mm, crate-mm.stl."""
    for name, factor in (("crate.stl", 1), ("crate-mm.stl", 1000)):
        trimesh.creation.box((0.6 * factor, 0.4 * factor, 0.3 * factor)).export(tmp_path / name)
    return tmp_path / "my.toml"


OF_BOX = "give the full size [x, y, z] in m of a load that is a box"


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ('attachments = "hook"',
         ".radius is missing; give the radius in m, of a cylinder; else left out"),
        ("size = []", f".size[0] is missing; {OF_BOX}"),
        ("size = 3", f".size = 3 must be a list; {OF_BOX}"),
        ("size = [0.4, 0, 0.3]", f".size[1] = 0 must be greater than 0; {OF_BOX}"),
        ("size = [0.4, 0.3, nan]", f".size[2] = nan must be finite; {OF_BOX}"),
        ('size = [1, 1, 1], file = "crate.stl"',
         " states size and file; leave one of them out"),
        ('file = "crate.stl", radius = 3',
         " states radius, which a load with size or file has by itself; leave it out"),
        ('file = "crate.stl", radius = "3"',
         '.radius = "3" must be a number; give the radius in m, of a cylinder; else left out'),
        ("radius = 0.1, height = 0.3, scale = 0.5",
         " states scale, and no size or file to go with; leave that out, or give size or file"),
        ("file = 3", ".file = 3 must be text in quotes; give the path of a mesh file, relative to "
         "the scenario file: the load is its hull"),
    ],
)  # fmt: skip
def test_a_load_of_another_shape_is_refused_by_its_own_keys(crate, keys, line):
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(load(keys), crate)
    assert caught.value.problems[0] == f"{crate}: payload{line}"
    assert len(caught.value.problems) == 1 + ("attachments" in keys)  # the height is missing, too


@pytest.mark.fast
def test_all_that_is_wrong_with_a_load_is_told_at_once(crate):
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(load('file = "gone.stl", scale = 0', mass=-1), crate)
    wrong = [line.split()[1] for line in caught.value.problems]
    assert wrong == ["payload.mass", "payload.file", "payload.scale"]


@pytest.mark.parametrize(
    ("scale", "wrong"),
    [
        ("0", "0 must be greater than 0"),
        ("-1", "-1 must be greater than 0"),
        ("nan", "nan must be finite"),
        ("inf", "inf must be finite"),
        ('"mm"', '"mm" must be a number'),
    ],
)
def test_a_scale_that_is_none_is_named(crate, scale, wrong):
    line = complaint(load(f'file = "crate.stl", scale = {scale}'), crate)
    assert line == (
        f"{crate}: payload.scale = {wrong}; give the factor from the unit of that file to metres"
    )
    obstacle = mesh_table(file="crate.stl") + f"scale = {scale}\n"
    assert complaint(MINIMAL + obstacle, crate) == (
        f"{crate}: obstacles[0].scale = {wrong}; give the factor from the unit of the file to "
        "metres"
    )


def test_a_load_in_another_unit_is_refused_and_nothing_that_follows_from_it(crate):
    assert complaint(load('file = "crate-mm.stl"'), crate) == (
        f"{crate}: payload.scale = 1.0 makes it 600 m across, 86 times the workspace: is the file "
        "in millimetres?; give scale = 0.001, or the factor to metres"
    )
    assert complaint(load('file = "crate.stl", scale = 0.001'), crate) == (
        f"{crate}: payload.scale = 0.001 makes it 0.0006 m across, 8.6e-05 times the workspace: is "
        "the file in metres?; give scale = 1, or the factor to metres"
    )
    fits = Scenario.from_toml(load('file = "crate-mm.stl", scale = 0.001'), crate)
    assert fits.payload.words == "hull of crate-mm.stl in 0.360555 × 0.3 m"


def test_a_large_mesh_is_asked_for_its_unit_where_something_else_is_wrong(tmp_path):
    """A hall of 100 m, in a workspace of 7 m."""
    trimesh.creation.box((100, 80, 60)).export(tmp_path / "hall.stl")
    hall, file = mesh_table(file="hall.stl", name="hall"), tmp_path / "my.toml"
    beside = changed("[2, 2, 0.4]", "[80, 0, 0.4]", hall)
    assert Scenario.from_toml(MINIMAL + beside, file)
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(MINIMAL + hall, file)
    first, *others = caught.value.problems
    assert first == (
        f'{file}: obstacles[0] "hall".scale = 1.0 makes it 100 m across, 14 times the workspace: '
        "is the file in millimetres?; give scale = 0.001, or the factor to metres"
    )
    assert "puts the column of the robot into the warning area" in others[0]
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_toml(changed("[0, 2, 1]", "[0, 2, 9]", MINIMAL) + beside, file)
    assert caught.value.problems[0] == first


@pytest.mark.parametrize("shape", ["box", "hull"])
def test_a_number_of_pieces_where_there_are_none_is_refused(crate, shape):
    text = MINIMAL + mesh_table(file="crate.stl", shape=shape, pieces=3)
    assert complaint(text, crate) == (
        f'{crate}: obstacles[0].pieces = 3 has no use with shape = "{shape}"; '
        'give shape = "pieces", or leave it out'
    )


def test_a_mesh_whose_pieces_fail_is_refused_in_one_line(crate, monkeypatch):
    def fails(*_):
        raise MeshError("the pieces of it leave parts of it out", 'give shape = "hull"')

    monkeypatch.setattr(models, "pieces_of", fails)
    text = MINIMAL + mesh_table(file="crate.stl", shape="pieces")
    assert complaint(text, crate).endswith(
        'obstacles[0].file = "crate.stl" cannot be used (the pieces of it leave parts of it out); '
        'give shape = "hull"'
    )


@pytest.mark.parametrize(
    ("size", "scale", "found"),
    [
        (1200, 1.0, "1.2e+03 m across, 1.7e+02 times the workspace: is the file in millimetres?; "
         "give scale = 0.001, or the factor to metres"),
        (150, 1.0, "150 m across, 21 times the workspace: is the file in millimetres?; "
         "give scale = 0.001, or the factor to metres"),
        (700, 0.3, "210 m across, 30 times the workspace; give the factor from its unit to metres, "
         "1 for metres, 0.001 for millimetres"),
        (0.9, 0.001, "0.0009 m across, 0.00013 times the workspace: is the file in metres?; "
         "give scale = 1, or the factor to metres"),
    ],
)  # fmt: skip
def test_a_mesh_in_another_unit_is_refused(tmp_path, size, scale, found):
    trimesh.creation.box((size, size / 2, size / 3)).export(tmp_path / "part.stl")
    table = mesh_table(file="part.stl", scale=scale, name="part")
    line = complaint(MINIMAL + table, tmp_path / "my.toml")
    assert line.endswith(f'obstacles[0] "part".scale = {scale} makes it {found}')


def test_an_open_mesh_has_no_pieces(tmp_path):
    shell = trimesh.creation.box((1, 1, 1))
    shell.update_faces(np.arange(12) > 0)
    shell.export(tmp_path / "open.stl")
    line = complaint(MINIMAL + mesh_table(shape="pieces", file="open.stl"), tmp_path / "my.toml")
    assert "open.stl is not closed, 3 of its edges" in line
    assert line.endswith('close it in the program that it comes from, or give shape = "hull"')


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
