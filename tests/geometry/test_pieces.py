"""Concave meshes as convex pieces: they hold the mesh, add little, and are the same every time."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from jaxsusp import _cache
from jaxsusp.geometry import pieces
from jaxsusp.geometry.meshes import MeshError, bounding_box, surface
from jaxsusp.geometry.pieces import held_by, pieces_of
from jaxsusp.geometry.polytopes import hull_of


def bracket() -> trimesh.Trimesh:
    """An L of two boxes, 200 mm by 300 mm, closed by hand: no package for polygons is needed."""
    ring = np.array([[0, 0], [200, 0], [200, 40], [40, 40], [40, 300], [0, 300]], float)
    vertices = np.concatenate([np.column_stack([ring, np.full(6, z)]) for z in (0.0, 80.0)])
    flat = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]
    faces = [tri[::-1] for tri in flat] + [[i + 6 for i in tri] for tri in flat]
    for i in range(6):
        j = (i + 1) % 6
        faces += [[i, j, j + 6], [i, j + 6, i + 6]]
    return trimesh.Trimesh(vertices, faces, process=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The file of a bracket, and its pieces in metres."""
    file = tmp_path_factory.mktemp("meshes") / "bracket.stl"
    bracket().export(file)
    return file, pieces_of(file, 0.001)


def test_pieces_hold_the_mesh_and_little_more(made):
    file, bodies = made
    mesh = bracket()
    assert mesh.is_watertight
    assert 2 <= len(bodies) <= 4
    random = np.random.default_rng(0).uniform
    inside = [random([0, 0, 0], [200, 40, 80], (999, 3)), random(0, [40, 300, 80], (999, 3))]
    points = np.concatenate([*inside, trimesh.sample.sample_surface(mesh, 3000, seed=0)[0]])
    own = 0.001 * (points - [100, 150, 40])
    excess = [(own @ body.normals.T - body.offsets).max(axis=1) for body in bodies]
    assert np.min(excess, axis=0).max() <= 1e-9
    total = sum(ConvexHull(body.corners).volume for body in bodies)
    assert 1 < total / (1e-9 * mesh.volume) < 1.25
    assert surface(file).volume == pytest.approx(mesh.volume)
    assert total < 0.7e-9 * mesh.convex_hull.volume * 1.25


def test_they_are_the_same_when_they_are_made_anew_and_kept(made, tmp_path, monkeypatch):
    file, known = made
    copy = tmp_path / "copy.stl"
    copy.write_bytes(file.read_bytes())
    monkeypatch.setenv(_cache.CACHE, str(tmp_path))
    again = pieces_of(copy, 0.001)
    (kept,) = (tmp_path / "pieces").iterdir()
    assert [each.files for each in _cache.contents() if each.kind == "pieces"] == [1]
    monkeypatch.setattr(pieces, "_coacd", lambda: pytest.fail("it was made anew"))
    pieces._pieces.cache_clear()
    assert kept.suffix == ".npz"
    for one, other, same in zip(known, again, pieces_of(copy, 0.001), strict=True):
        np.testing.assert_array_equal(one.corners, other.corners)
        np.testing.assert_array_equal(one.corners, same.corners)
    pieces._pieces.cache_clear()
    kept.write_bytes(b"damaged")
    monkeypatch.undo()
    monkeypatch.setenv(_cache.CACHE, str(tmp_path))
    assert len(pieces_of(copy, 0.001)) == len(known)


def test_without_the_package_one_message_says_what_to_install(made, monkeypatch):
    monkeypatch.setattr(pieces, "_version", lambda: "")
    with pytest.raises(MeshError, match=r'pip install "jaxsusp\[pieces\]", or give shape = "hull"'):
        pieces.require_divisible(made[0], 16)


def test_what_is_not_held_is_not_proved():
    body = hull_of(np.asarray(trimesh.creation.box((1, 1, 1)).vertices))
    beside = body.placed((1.1, 0.0, 0.0), 0.0)
    inside = np.array([[[0.0, 0, 0], [0.4, 0, 0], [0, 0.4, 0]]])
    across = np.array([[[0.0, 0, 0], [1.1, 0, 0], [0, 0.4, 0]]])  # over the slit between the two
    assert held_by([body], inside)
    assert not held_by([body, beside], across)
    assert held_by([body.larger(0.2), beside], across)


def test_what_cannot_be_divided_is_refused_with_a_remedy(tmp_path, monkeypatch):
    shell = trimesh.creation.box((1, 1, 1))
    shell.update_faces(np.arange(12) > 0)
    shell.export(tmp_path / "open.stl")
    with pytest.raises(MeshError, match=r"open\.stl is not closed, 3 of its edges .* \"hull\""):
        pieces_of(tmp_path / "open.stl")
    boxes = [trimesh.creation.box((1, 1, 1)).apply_translation([2 * i, 0, 0]) for i in range(3)]
    trimesh.util.concatenate(boxes).export(tmp_path / "three.stl")
    with pytest.raises(MeshError, match=r"has 3 separate parts and pieces = 2"):
        pieces_of(tmp_path / "three.stl", pieces=2)
    monkeypatch.setattr(pieces, "TRIANGLES", 30)
    with pytest.raises(MeshError, match=r"36 triangles, more than 30 .* reduce them"):
        pieces_of(tmp_path / "three.stl")


@pytest.mark.fast
@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb", "gltf"])
def test_a_closed_mesh_is_closed_in_every_format(tmp_path, suffix):
    file = tmp_path / f"ball.{suffix}"
    ball = trimesh.creation.icosphere(subdivisions=1)
    if suffix == "gltf":  # several files, which trimesh would leave open
        for name, content in trimesh.exchange.gltf.export_gltf(ball.scene()).items():
            (tmp_path / name).write_bytes(content)
        file = tmp_path / "model.gltf"
    else:
        ball.export(file)
    assert surface(file).open_edges == 0
    assert bounding_box(file) == pytest.approx([2, 2, 2], rel=0.2)
