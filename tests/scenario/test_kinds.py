"""Every kind of obstacle in every room that has to know it: one table, a row per kind."""

from typing import get_args

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest
from trimesh.creation import box as box_mesh

import jaxsusp as js
from jaxsusp.freespace.bodies import obstacle_bodies
from jaxsusp.geometry.collisions import Bodies, count_collisions
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.report.drawing.solids import of_obstacles
from jaxsusp.scenario.models import Obstacle
from jaxsusp.scenario.world import build_world
from jaxsusp.vec3 import Vec3
from jaxsusp.verify.bodies import named_shapes
from jaxsusp.verify.model import _geom as add_obstacle

count = jax.jit(count_collisions)  # not jitted, it is compiled anew with every call
PLACE = {"center": (1.5, 0.5, 0.6)}
SAMPLES = {
    "box": {"size": (0.4, 0.6, 0.8)},
    "cylinder": {"radius": 0.25, "height": 0.9},
    "sphere": {"radius": 0.35},
    "mesh": {"scale": 0.5},
}
KINDS = {each.model_fields["kind"].default: each for each in get_args(get_args(Obstacle)[0])}


NAMES = [*SAMPLES, "hull"]


@pytest.fixture
def scenario(request, tmp_path, scenarios) -> js.Scenario:
    """The first benchmark scenario with one obstacle of the kind."""
    kind = "mesh" if request.param == "hull" else request.param
    content = scenarios[0].model_dump() | {"obstacles": [{"kind": kind} | PLACE | SAMPLES[kind]]}
    if kind == "mesh":
        box_mesh((0.8, 1.2, 1.6)).export(tmp_path / "crate.stl")
        content["obstacles"][0]["file"] = str(tmp_path / "crate.stl")
        content["obstacles"][0]["shape"] = "hull" if request.param == "hull" else "box"
    return js.Scenario.model_validate(content)


@pytest.mark.fast
def test_every_kind_has_a_row():
    assert SAMPLES.keys() == KINDS.keys()


@pytest.mark.parametrize("scenario", NAMES, indirect=True)
@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3)])
def test_all_rooms_agree_where_the_body_ends(scenario, axis):
    """Along an axis from the centre: drawn, measured, packed and avoided, it is the same body."""
    (obstacle,) = scenario.obstacles
    center = np.array(obstacle.center)
    ((_, shape),) = named_shapes(obstacle, "obstacle")
    far = shape.support(axis[None])[0] - axis @ center
    assert far > 0.1
    corners = of_obstacles([obstacle])[0].corners - center
    assert (corners @ axis).max() == pytest.approx(far, rel=0.02)

    def met(start, stop) -> bool:
        packed = build_world(scenario).obstacles
        a, b = (Vec3(*(center + share * axis)) for share in (start, stop))
        return not segments_clear(a, b, np.array(0.0), packed)

    assert met(far - 1e-6, far + 1)
    assert not met(far + 1e-6, far + 1)

    def counted(share) -> bool:
        """A speck of a load at rest, and then a hair of a cable along the axis."""
        nothing = np.array(0.0)
        at = Vec3(*(jnp.asarray([c, c]) for c in center + share * axis))
        hook, end = (Vec3(*each.reshape(3, 1)) for each in (np.zeros(3), center + 9 * axis))
        speck = Bodies(nothing, nothing, nothing, nothing, hook, end.each(lambda c: c[:0]))
        packed = build_world(scenario, (1, 1, 1)).obstacles
        load = int(count(at, speck, packed))
        both = int(count(at, speck._replace(ends=end), packed))
        assert both == 2 * load
        return load > 0

    assert counted(far - 1e-6)
    assert not counted(far + 1e-6)

    spec = mujoco.MjSpec()
    add_obstacle(spec, "obstacle", shape)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom = np.zeros(1, np.int32)
    away = center + (far + 1) * axis
    hit = mujoco.mj_ray(model, data, away, -axis, None, 1, -1, geom)
    assert hit == pytest.approx(1, abs=1e-6)

    around_load, *shadows = obstacle_bodies(scenario, obstacle, "obstacle")
    assert (around_load.faces.excess((center + far * axis)[None]) < 0).all()
    assert len(shadows) == len(scenario.robots)
