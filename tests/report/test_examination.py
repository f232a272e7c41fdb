"""What `jaxsusp check` says of the meshes of a scenario."""

import numpy as np
import pytest
import trimesh

import jaxsusp as js
from jaxsusp.report.examination import about, mesh_records
from jaxsusp.scenario.models import Mesh


def test_a_mesh_is_told_with_what_is_in_its_place(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=2)
    ball.export(tmp_path / "ball.stl")
    shell = trimesh.creation.box((1, 1, 1))
    shell.update_faces(np.arange(12) > 0)
    shell.export(tmp_path / "shell.stl")
    meshes = [
        Mesh(name=name, center=(2.0, 2.0, 0.5), file=str(tmp_path / f"{name}.stl"), shape=shape)
        for name, shape in (("ball", "hull"), ("shell", "box"))
    ]
    scenario = js.load_scenario("scenario-1").model_copy(update={"obstacles": tuple(meshes)})
    told = [line for line in about(scenario) if "is a mesh" in line]
    assert told[0].startswith('obstacles[0] "ball" is a mesh of 320 triangles, 2.00 × ')
    assert "in place of which is its convex hull, 4.24 m³" in told[0]
    assert told[0].endswith("m³ more than it has itself.")
    assert told[1].endswith(
        "its bounding box, 1.00 m³; it is not closed (3 open edges): it has no volume."
    )
    ours, other = mesh_records(scenario)
    assert other["volume_m3"] is None
    assert ours["volume_m3"] == pytest.approx(ball.volume)
    assert ours["bodies_m3"] > ours["volume_m3"]


def test_a_mesh_that_overlaps_itself_is_told_no_volume(tmp_path):
    """Two cubes that share half of their room: the surface's own sum is 2 m³ where 1.5 are."""
    cubes = [trimesh.creation.box((1, 1, 1)).apply_translation((x, 0, 0)) for x in (0, 0.5)]
    trimesh.util.concatenate(cubes).export(tmp_path / "cubes.stl")
    mesh = Mesh(center=(2.0, 2.0, 0.5), file=str(tmp_path / "cubes.stl"), shape="hull")
    scenario = js.load_scenario("scenario-1").model_copy(update={"obstacles": (mesh,)})
    (record,) = mesh_records(scenario)
    assert (record["volume_m3"], record["overlaps"]) == (None, True)
    assert record["bodies_m3"] == pytest.approx(1.5)
    (told,) = [line for line in about(scenario) if "is a mesh" in line]
    assert "1.50 m³; it overlaps itself" in told


def test_the_most_pieces_are_a_default_in_force_only_where_there_are_pieces(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "cube.stl")
    place = {"center": (2.0, 2.0, 0.5), "file": str(tmp_path / "cube.stl")}
    scenario = js.load_scenario("scenario-1")
    for shape in ("box", "hull", "pieces"):
        update = {"obstacles": (Mesh(shape=shape, **place),)}
        text = "\n".join(about(scenario.model_copy(update=update)))
        assert ("pieces = 16" in text) == (shape == "pieces")
