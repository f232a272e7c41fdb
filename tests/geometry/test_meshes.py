"""The bounding box that replaces a mesh file."""

import numpy as np
import pytest
import trimesh

from jaxsusp.geometry.meshes import MeshError, Surface, bounding_box, hull


@pytest.mark.fast
@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off", "glb"])
def test_every_common_format_gives_its_full_extents_in_metres(tmp_path, suffix):
    file = tmp_path / f"crate.{suffix}"
    trimesh.creation.box((1000, 2000, 3000)).export(file)
    np.testing.assert_allclose(bounding_box(file, scale=0.001), [1, 2, 3], rtol=1e-6)


@pytest.mark.fast
def test_the_parts_of_a_file_are_taken_together(tmp_path):
    far = trimesh.creation.box((1, 1, 1)).apply_translation([5, 0, 0])
    trimesh.Scene([trimesh.creation.box((1, 1, 1)), far]).export(tmp_path / "two.glb")
    np.testing.assert_allclose(bounding_box(tmp_path / "two.glb"), [6, 1, 1])


@pytest.mark.fast
def test_a_flat_mesh_has_no_height(tmp_path):
    (tmp_path / "plate.obj").write_text("v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n")
    assert bounding_box(tmp_path / "plate.obj").tolist() == [2, 3, 0]


@pytest.mark.fast
@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.obj", b"# nothing\n", "holds no mesh"),
        ("empty.stl", b"", "holds no mesh"),
        ("text.foo", b"hello", "cannot be read as a mesh: .foo is no format that is read; give"),
        ("none", b"hello", "cannot be read as a mesh: its name has no suffix; give a file of STL"),
        ("broken.off", b"OFF\n3", "as .off it is damaged, or in another format .*; export it anew"),
        ("broken.glb", b"\0\1glTF", "cannot be read as a mesh: as .glb it is damaged"),
        ("part.dxf", b"0\nSECTION\n", "as .dxf it is damaged, or in another format"),
        ("far.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "damaged|not in it"),
        ("point.obj", b"v 1 2 3\nv 1 2 3\nv 1 2 3\nf 1 2 3\n", "is but one point"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
        ("huge.obj", b"v 1e308 0 0\nv -1e308 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
    ],
)
def test_an_unusable_file_is_named_with_the_reason(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(MeshError, match=message) as caught:
        bounding_box(tmp_path / name)
    assert name in str(caught.value)


@pytest.mark.fast
def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(MeshError, match=r"there is no file .*gone\.stl"):
        bounding_box(tmp_path / "gone.stl")


@pytest.mark.fast
def test_a_folder_is_called_one(tmp_path):
    for path in (tmp_path, "."):
        with pytest.raises(MeshError, match="is a folder; give a mesh file in it"):
            bounding_box(path)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("name", "lacking", "message"),
    [
        ("part.3mf", "networkx", "pip install networkx lxml, or export it as STL, OBJ, PLY"),
        ("part.STEP", "cascadio", "pip install cascadio, or export it as STL, OBJ, PLY"),
        ("part.xaml", "lxml.etree", "xaml asks for a package more; pip install lxml, or export"),
        ("part.obj", "charset_normalizer", "in another format, or text that is not UTF-8; export"),
    ],
)
def test_what_a_reader_lacks_is_named(tmp_path, monkeypatch, name, lacking, message):
    def lacks(*_, **__):
        raise ModuleNotFoundError(f"No module named '{lacking}'", name=lacking)

    monkeypatch.setattr(trimesh, "load_scene", lacks)
    (tmp_path / name).write_bytes(b"anything")
    with pytest.raises(MeshError, match=message):
        bounding_box(tmp_path / name)


@pytest.mark.fast
def test_a_reader_that_only_says_how_to_install_it_is_understood(tmp_path, monkeypatch):
    error = ImportError("missing `pip install pycollada`")
    monkeypatch.setattr(trimesh, "load_scene", lambda *_, **__: (_ for _ in ()).throw(error))
    (tmp_path / "part.new").write_bytes(b"anything")
    with pytest.raises(MeshError, match="; pip install pycollada, or export it"):
        bounding_box(tmp_path / "part.new")


@pytest.mark.fast
@pytest.mark.parametrize("points", ["line", "plane"])
def test_a_line_and_a_plane_have_a_thin_hull(tmp_path, points):
    other = {"line": "2 4 6", "plane": "1 0 1"}[points]
    (tmp_path / "flat.obj").write_text(f"v 0 0 0\nv 1 2 3\nv {other}\nf 1 2 3\n")
    assert 0 < hull(tmp_path / "flat.obj").volume < 1e-2


def cube(x: float = 0.0, size: float = 1.0, inside_out: bool = False) -> trimesh.Trimesh:
    found = trimesh.creation.box((size, size, size)).apply_translation((x, 0.2 * x, 0.1 * x))
    if inside_out:
        found.invert()
    return found


@pytest.mark.fast
@pytest.mark.parametrize(
    ("parts", "overlaps"),
    [
        ([cube()], False),
        ([cube(inside_out=True)], False),
        ([cube(), cube(3)], False),
        ([cube(), cube(1)], False),  # they share a part of a wall
        ([cube(), cube().apply_translation((0, 0, 1 - 1e-7))], False),  # one on the other, rounded
        ([cube(), cube(size=0.5, inside_out=True)], False),  # a cavity
        ([cube(), cube(0.5)], True),
        ([cube(), cube(size=0.5)], True),
        ([cube(), cube(3, 0.8, inside_out=True)], True),
        ([trimesh.creation.torus(1.0, 0.3)], False),
    ],
)
def test_a_surface_that_goes_around_a_place_twice_is_noticed(parts, overlaps):
    mesh = trimesh.util.concatenate(parts)
    surface = Surface(np.asarray(mesh.vertices, float), np.asarray(mesh.faces))
    assert surface.overlaps is overlaps
    assert surface.signed_volume == pytest.approx(mesh.volume)
    assert surface.turned.signed_volume == pytest.approx(-mesh.volume)
