"""Concave meshes as convex pieces: they hold the mesh, add little, and are the same every time."""

import io

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


def test_without_the_package_one_message_says_what_to_install(made, monkeypatch):
    monkeypatch.setattr(pieces, "_version", lambda: "")
    with pytest.raises(MeshError, match=r'pip install "\.\[pieces\]" in .* or give'):
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


def _saved(*arrays) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, *arrays)
    return stream.getvalue()


CORNERS = np.random.default_rng(0).uniform(-9, 9, (8, 3))
NOT_PIECES = {
    "text": b"damaged",
    "empty": b"",
    "an archive of nothing": _saved(),
    "an end": _saved(np.array([2]), CORNERS)[:-60],
    "half": _saved(np.array([1]), CORNERS)[:150],
    "objects": _saved(np.array([1]), np.array([None])),
    "too few": _saved(np.array([2]), CORNERS),
    "too many": _saved(np.array([1]), CORNERS, CORNERS),
    "another number of parts": _saved(np.array([1, 1]), CORNERS, CORNERS),
    "none of a part": _saved(np.array([0])),
    "negative": _saved(np.array([-1])),
    "two columns": _saved(np.array([1]), CORNERS[:, :2]),
    "a row": _saved(np.array([1]), CORNERS[0]),
    "no rows": _saved(np.array([1]), CORNERS[:0]),
    "nan": _saved(np.array([1]), CORNERS * np.nan),
    "one point": _saved(np.array([1]), CORNERS[[0, 0, 0, 0]]),
    "whole numbers": _saved(np.array([1]), CORNERS.astype(int)),
    "text in it": _saved(np.array([1]), np.array([["a", "b", "c"]])),
    "pieces of something else": _saved(np.array([1]), CORNERS),
    "counts in a table": _saved(np.array([[1]]), CORNERS),
    "counts that are fractions": _saved(np.array([0.5]), CORNERS),
}


def _proved_at_once(patch):
    """By the share that will do: those that will not take most of the time."""
    patch.setattr(pieces, "GROWN", (0.02,))
    patch.setattr(pieces, "_HALVINGS", 9)


@pytest.fixture(scope="module")
def damaged(tmp_path_factory):
    """A folder for what is kept, a mesh that is divided for it, and what that gives."""
    folder = tmp_path_factory.mktemp("kept")
    bracket().export(folder / "bracket.stl")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(_cache.CACHE, str(folder))
        _proved_at_once(patch)
        pieces._pieces.cache_clear()
        found = pieces_of(folder / "bracket.stl", 0.001)
    (kept,) = (folder / "pieces").iterdir()
    return folder, kept, found, kept.read_bytes()


@pytest.mark.parametrize("content", NOT_PIECES.values(), ids=NOT_PIECES.keys())
def test_whatever_is_in_a_kept_file_pieces_are_made_anew(damaged, monkeypatch, content):
    folder, kept, known, whole = damaged
    made = [*np.load(io.BytesIO(whole)).values()][1:]
    _proved_at_once(monkeypatch)
    divided = []
    monkeypatch.setattr(pieces, "_divided", lambda *given: divided.append(given) or made)
    monkeypatch.setenv(_cache.CACHE, str(folder))
    kept.write_bytes(content)
    pieces._pieces.cache_clear()
    for one, other in zip(known, pieces_of(folder / "bracket.stl", 0.001), strict=True):
        np.testing.assert_array_equal(one.corners, other.corners)
    assert len(divided) == 1
    assert kept.read_bytes() == whole


def test_a_mesh_that_is_turned_inside_out_has_the_pieces_of_itself(made, tmp_path):
    mesh = bracket()
    mesh.invert()
    mesh.export(tmp_path / "turned.stl")
    assert trimesh.load_mesh(tmp_path / "turned.stl").volume == pytest.approx(-bracket().volume)
    found = pieces_of(tmp_path / "turned.stl", 0.001)
    assert len(found) == len(made[1])
    total = sum(body.volume for body in found)
    assert total == pytest.approx(sum(body.volume for body in made[1]), rel=0.05)


def test_what_is_convex_is_its_own_piece_and_is_not_divided(tmp_path, monkeypatch):
    """Boxes, a ball, a thin plate, one with no thickness at all, and a cavity: it is filled."""
    monkeypatch.setattr(pieces, "_coacd", lambda: pytest.fail("it was divided"))
    monkeypatch.setenv(_cache.CACHE, "")
    cavity = trimesh.creation.box((0.5, 0.5, 0.5))
    cavity.invert()
    flat = trimesh.creation.box((2, 1, 1))
    flat.vertices[:, 2] = 0.0
    for name, parts, volumes, rel in [
        ("box", [trimesh.creation.box((1, 2, 3))], [6.0], 1e-6),
        ("hollow", [trimesh.creation.box((1, 1, 1)), cavity], [1.0, 0.125], 1e-6),
        ("plate", [trimesh.creation.box((1, 1, 1e-3))], [1e-3], 1e-3),
        ("thinner", [trimesh.creation.box((1, 1, 1e-7))], [1e-4], 1e-2),
        ("flat", [flat], [2 * 2e-4], 1e-2),
        ("twice", [trimesh.creation.box((1, 2, 3))] * 2, [6.0], 1e-6),
        ("ball", [trimesh.creation.icosphere(1)], [4.2], 0.3),
    ]:
        file = tmp_path / f"{name}.ply"
        trimesh.util.concatenate(parts).export(file)
        found = pieces_of(file)
        assert sorted(body.volume for body in found) == pytest.approx(sorted(volumes), rel=rel)


def test_a_mesh_of_lines_has_no_pieces(tmp_path):
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nf 1 2 2\n")
    with pytest.raises(MeshError, match="has no inside: each of its triangles is but a line"):
        pieces_of(tmp_path / "line.obj")


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
