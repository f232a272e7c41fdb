"""A load that is a box or a hull: its sums with obstacles, in every room that looks at the load."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
import trimesh

import jaxsusp as js
from jaxsusp.freespace.bodies import bodies_of
from jaxsusp.freespace.cells.forbidden import forbidden_of
from jaxsusp.geometry.collisions import count_at_samples, count_collisions
from jaxsusp.geometry.penetration import deepest
from jaxsusp.scenario.models import Box, Cylinder, Mesh, Sphere
from jaxsusp.scenario.ownunits import in_own_units
from jaxsusp.scenario.world import build_world, rounded_counts
from jaxsusp.vec3 import Vec3
from jaxsusp.verify.bodies import Body, HullShape, named_shapes
from jaxsusp.verify.scene import Scene

QUICKLY = {"xla_backend_optimization_level": 0, "xla_llvm_disable_expensive_passes": True}
count = jax.jit(count_collisions, compiler_options=QUICKLY)
at_samples = jax.jit(count_at_samples, compiler_options=QUICKLY)
depth_of = jax.jit(deepest, compiler_options=QUICKLY)
SIZE = (0.7, 0.3, 0.25)


@pytest.fixture(scope="module")
def wedge(tmp_path_factory):
    file = tmp_path_factory.mktemp("load") / "wedge.stl"
    corners = [[0, 0, 0], [800, 0, 0], [0, 400, 0], [0, 0, 300.0], [500, 0, 300]]
    trimesh.convex.convex_hull(np.array(corners)).export(file)
    return file


@pytest.fixture(params=["box", "wedge"])
def scenario(request, wedge, scenarios, tmp_path) -> js.Scenario:
    """The first benchmark with such a load and one obstacle of every kind."""
    shape = {"size": SIZE} if request.param == "box" else {"file": str(wedge), "scale": 0.001}
    content = scenarios[0].model_dump() | {"obstacles": []}
    content["payload"] = {"mass": 10.0, "yaw_deg": 25.0, **shape}
    trimesh.creation.icosphere(subdivisions=1, radius=0.4).export(tmp_path / "ball.stl")
    stones = (
        Box(center=(1.0, 0.0, 2.0), size=(0.8, 0.3, 0.5), yaw_deg=40.0),
        Cylinder(center=(-1.0, 0.5, 1.5), radius=0.3, height=1.0),
        Sphere(center=(0.0, -1.0, 2.5), radius=0.4),
        Mesh(center=(0.5, 1.2, 1.0), shape="hull", file=str(tmp_path / "ball.stl"), yaw_deg=10.0),
    )
    scenario = js.Scenario.model_validate(content)
    return scenario.model_copy(update={"obstacles": stones})


def gaps(scenario: js.Scenario, points: np.ndarray) -> np.ndarray:
    """Distances of the load from every obstacle by MuJoCo (points, obstacles); 0 where they meet"""
    shapes = [shape for each in scenario.obstacles for _, shape in named_shapes(each, "stone")]
    load = Body("load", 1, 1, 1.0, 1.0, load=HullShape(scenario.payload.body.corners))
    scene = Scene([load, *(Body("stone", obstacle=shape) for shape in shapes)])
    found = np.empty((len(points), len(shapes)))
    for row, point in zip(found, points, strict=True):
        scene.place(0, point, point)
        row[:] = [scene.distance(1 + i, 0)[0] for i in range(len(shapes))]
    return np.maximum(found, 0.0)


def test_contacts_are_where_a_certificate_finds_them(scenario):
    random = np.random.default_rng(2)
    points = random.uniform([-2, -2, 0.5], [2, 2, 3.5], (700, 3))
    known, clear = gaps(scenario, points), scenario.limits.clearance
    alone = build_world(scenario)
    bodies = alone.bodies._replace(ends=alone.bodies.ends.each(lambda c: c[:0]))
    still = Vec3(*jnp.asarray(np.stack([points, points]).transpose(2, 0, 1)))
    found = np.asarray(at_samples(still, bodies, alone.obstacles)) > 0
    touching, far = (known < clear - 1e-5).any(axis=1), (known > 0.45).all(axis=1)
    assert 30 < touching.sum() < 600
    assert found[touching].all()
    assert far.sum() > 20
    assert not found[far].any()
    near = (known[:, [0, 3]] > clear).all(axis=1) & (known[:, [1, 2]] > 0.45).all(axis=1)
    assert found[near].mean() < 0.2  # faces moved out reach further at edges
    depth = np.asarray(depth_of(still, bodies, alone.obstacles).load)
    np.testing.assert_array_equal(depth > 0, found)

    forbidden, spaces = forbidden_of(scenario), bodies_of(scenario)
    at = [i for i, cable in enumerate(forbidden.cable) if cable < 0]
    assert len(at) == 4
    for column, body in enumerate(at):
        asked = np.full(len(points), body)
        room = forbidden.room(points, asked)
        inner = forbidden.room(points, asked, inner=True)
        assert (room <= known[:, column] - clear + 1e-6).all()
        assert (known[:, column] < clear)[inner <= 0].all()
        assert (inner <= 0).any()
        kept_out = spaces[body].faces.excess(points) <= 0
        assert kept_out[known[:, column] < clear].all()


def test_motions_count_whatever_the_padding_and_turns_as_their_samples(scenario):
    random = np.random.default_rng(3)
    start = random.uniform([-2, -2, 0.8], [2, 2, 3], (150, 3)).T[:, None]
    path = jnp.asarray(start + random.normal(scale=0.1, size=(3, 4, 150)).cumsum(axis=1))
    world, padded = build_world(scenario), build_world(scenario, rounded_counts(scenario))
    found = np.asarray(count(Vec3(*path), world.bodies, world.obstacles))
    again = np.asarray(count(Vec3(*path), padded.bodies, padded.obstacles))
    np.testing.assert_array_equal(found, again)
    share = jnp.linspace(0, 1, 9)[None, None, :, None]
    dense = path[:, :-1, None] * (1 - share) + path[:, 1:, None] * share
    seen = np.asarray(at_samples(Vec3(*dense.reshape(3, -1, 150)), world.bodies, world.obstacles))
    assert (found[seen > 0] > 0).all()
    assert 10 < (found > 0).sum() < 150


def test_a_box_and_its_corners_as_a_mesh_are_one_load(scenarios, tmp_path):
    trimesh.creation.box(np.multiply(SIZE, 1000)).export(tmp_path / "box.stl")
    bare = scenarios[0].model_dump()
    loads = []
    for shape in ({"size": SIZE}, {"file": str(tmp_path / "box.stl"), "scale": 0.001}):
        payload = {"mass": 10.0, "yaw_deg": 30.0, **shape}
        loads.append(js.Scenario.model_validate(bare | {"payload": payload, "obstacles": []}))
    one, other = (np.sort(each.payload.body.corners, axis=0) for each in loads)
    np.testing.assert_allclose(one, other, atol=1e-7)
    box = loads[0].payload
    assert (box.radius, box.height) == pytest.approx((np.hypot(0.35, 0.15), 0.25))
    lx, ly, lz = SIZE
    own = np.diag([ly**2 + lz**2, lx**2 + lz**2, lx**2 + ly**2]) / 12
    cos, sin = np.cos(np.pi / 6), np.sin(np.pi / 6)
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    np.testing.assert_allclose(box.body.inertia, turn @ own @ turn.T, atol=1e-12)
    again = js.Scenario.from_toml(loads[1].to_toml())
    assert again == loads[1]
    assert loads[1].digest == again.digest
    large = loads[0].model_copy(
        update={"robots": tuple(r.model_copy(update={"links": tuple(2 * a for a in r.links)})
                                for r in loads[0].robots)}
    )  # fmt: skip
    own_units, frame = in_own_units(large)
    assert frame.length == pytest.approx(2)
    np.testing.assert_allclose(own_units.payload.body.corners, box.body.corners / 2, atol=1e-6)


def test_a_simulated_box_has_its_own_inertia():
    spec = mujoco.MjSpec()
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 0.2
    HullShape(np.add(corners, [1.0, 0, 0])).add(spec, "stone")
    model = spec.compile()
    assert model.geom_pos[0] == pytest.approx([1, 0, 0], abs=1e-6)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("payload", "said"),
    [
        ({"size": SIZE, "radius": 0.1}, "states radius, which a load with size or file has"),
        ({"size": SIZE, "file": "x.stl"}, "states size and file"),
        ({"radius": 0.1, "height": 0.3, "yaw_deg": 3.0}, "states yaw_deg, and no size"),
        ({"file": "gone.stl"}, "there is no file"),
        ({"size": [0.1, -0.2, 0.3]}, "size"),
    ],
)
def test_a_load_that_contradicts_itself_is_refused(scenarios, payload, said):
    content = scenarios[0].model_dump() | {"payload": {"mass": 10.0, **payload}}
    with pytest.raises(ValueError, match=said):
        js.Scenario.model_validate(content)
