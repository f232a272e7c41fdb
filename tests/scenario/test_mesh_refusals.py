"""Meshes and loads of scenario files that cannot be used, and the sentence for each."""

import numpy as np
import pytest
import trimesh
from statements import MINIMAL, changed, complaint, mesh_table

from jaxsusp.errors import ScenarioError
from jaxsusp.geometry.meshes import MeshError
from jaxsusp.scenario import models
from jaxsusp.scenario.scenario import Scenario


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
