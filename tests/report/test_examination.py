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
    ours, _ = mesh_records(scenario)
    assert ours["volume_m3"] == pytest.approx(ball.volume)
    assert ours["bodies_m3"] > ours["volume_m3"]
