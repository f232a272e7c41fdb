"""The bounding box that replaces a mesh file."""

import numpy as np
import pytest
import trimesh

from jaxsusp.geometry.meshes import MeshError, bounding_box


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
        ("text.foo", b"hello", "cannot be read as a mesh"),
        ("broken.off", b"OFF\n3", "cannot be read as a mesh"),
        ("broken.glb", b"\0\1glTF", "cannot be read as a mesh"),
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
