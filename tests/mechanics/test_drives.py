"""The four drive modes by what each of them keeps, and how their violations count."""

from typing import get_args

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxsusp as js
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.geometry.obstacles import pack
from jaxsusp.mechanics.drives import HYBRID_SHARE, Anchors, Drive, bases_along
from jaxsusp.scenario.world import build_world, cast_world
from jaxsusp.suspension.levelload import ends_at
from jaxsusp.suspension.reach import count_misplaced
from jaxsusp.vec3 import Vec3

WAY = np.linspace([0.0, 2.0, 1.0], [0.5, -1.0, 2.5], 20)


def follow(scenario, way=WAY, drive="cable"):
    """Ends (n, K, 3), lengths (n, K) and bases of a scenario's load along a way."""
    world = cast_world(build_world(scenario), np.float64)
    ends = ends_at(world, Vec3.from_array(jnp.asarray(way)), drive)
    anchors = Anchors(world.start, world.bodies.attachments, world.bodies.ends)
    bases = bases_along(drive, ends, anchors, Vec3.from_array(jnp.asarray(world.robots.base)))
    rows = [np.moveaxis(np.asarray(v.to_array()), 0, -2) for v in (ends, bases)]
    hook = way + np.array([0, 0, scenario.payload.height / 2])
    lengths = np.linalg.norm(rows[0] - hook[:, None], axis=-1)
    return rows[0], lengths, rows[1]


@pytest.mark.parametrize("drive", get_args(Drive))
def test_every_mode_starts_from_the_given_ends(scenarios, drive):
    ends, _, bases = follow(scenarios[0], WAY[:1], drive)
    np.testing.assert_allclose(
        np.broadcast_to(ends, (1, 3, 3))[0], [r.end for r in scenarios[0].robots], atol=1e-12
    )
    np.testing.assert_allclose(
        np.broadcast_to(bases, (1, 3, 3))[0], [r.base for r in scenarios[0].robots], atol=1e-12
    )


def test_cable_driven_ends_stay(scenarios):
    ends, lengths, _ = follow(scenarios[0])
    assert ends.shape == (3, 3)
    assert np.ptp(lengths, axis=0).min() > 0.5


def test_end_driven_lengths_and_tensions_stay(scenarios):
    scenario = scenarios[0].model_copy(update={"drive": "end"})
    ends, lengths, _ = follow(scenario, drive="end")
    np.testing.assert_allclose(lengths - lengths[:1], 0, atol=1e-12)
    assert np.ptp(ends, axis=0).max() > 2
    tensions = np.asarray(js.tensions(scenario, WAY))
    np.testing.assert_allclose(tensions, np.tile(tensions[0], (20, 1)), rtol=1e-12)
    np.testing.assert_allclose(
        tensions[0], js.tensions(scenarios[0], np.array(scenario.task.start)), rtol=1e-12
    )


def test_base_driven_lengths_heights_and_headings_stay(scenarios):
    ends, lengths, bases = follow(scenarios[0], drive="base")
    np.testing.assert_allclose(lengths - lengths[:1], 0, atol=1e-12)
    np.testing.assert_allclose(ends[..., 2], 7, atol=1e-12)
    np.testing.assert_allclose(bases[..., 2], 0, atol=1e-12)
    np.testing.assert_allclose(np.ptp(ends - bases, axis=0), 0, atol=1e-12)  # P = O + const
    level = ends[..., :2] - WAY[:, None, :2]
    heading = np.arctan2(level[..., 1], level[..., 0])
    np.testing.assert_allclose(heading - heading[:1], 0, atol=1e-12)
    assert (np.diff(np.linalg.norm(level, axis=-1), axis=0) > 0).all()  # outwards as it rises


def test_a_base_driven_cable_that_is_too_short_is_no_number(scenarios):
    down = np.array([[0.0, 2.0, 1.0], [0.0, 2.0, -5.0]])
    ends, _, _ = follow(scenarios[0], down, "base")
    assert np.isfinite(ends[0]).all()
    assert np.isnan(ends[1, :, :2]).any()


def test_hybrid_ends_follow_half_of_the_way_and_lengths_vary(scenarios):
    ends, lengths, _ = follow(scenarios[0], drive="hybrid")
    step = (WAY - WAY[0]) * [HYBRID_SHARE, HYBRID_SHARE, 0]
    np.testing.assert_allclose(ends - ends[:1], np.tile(step[:, None], (1, 3, 1)), atol=1e-12)
    assert np.ptp(lengths, axis=0).min() > 0.1


def test_ends_out_of_reach_or_too_close_are_counted(scenarios):
    world = cast_world(build_world(scenarios[0]), np.float64)
    ends = np.array([robot.end for robot in scenarios[0].robots])
    moved = np.tile(ends[:, None], (1, 4, 1))  # (K, samples, 3)
    moved[0, 1] += [0, 3.5, 0]  # 5.4 m from its shoulder
    moved[1, 2] = moved[0, 2] + [0.3, 0, 0]  # too close, and out of its own reach
    packed = Vec3(*(jnp.asarray(moved[..., i]) for i in range(3)))
    assert int(count_misplaced(world, packed, "end")) == 1 + 2
    assert int(count_misplaced(world, packed, "base")) == 1
    assert int(count_misplaced(world, packed._replace(x=packed.x * jnp.nan), "base")) == 3 * 4


def test_no_collision_counted_means_that_moving_cables_are_clear_at_every_instant():
    """Random motions of both cable ends past random bodies, sampled densely by hand."""
    rng = np.random.default_rng(0)
    clear = caught = 0
    start = build_world(js.load_scenario("hybrid")).bodies
    count = jax.jit(count_collisions)
    for _ in range(300):
        load = rng.uniform(-1, 1, (2, 3)) * [1, 1, 0.3]
        top = rng.uniform(-1.5, 1.5, (2, 3)) * [1, 1, 0.3] + [0, 0, 3]
        boxes = np.array([[*rng.uniform(-1.5, 1.5, 2), 1.5, *rng.uniform(0.1, 0.4, 3), 0.7]])
        cylinders = np.array([[*rng.uniform(-1.5, 1.5, 2), 1.5, 0.2, 0.4]])
        spheres = np.array([[*rng.uniform(-1.5, 1.5, 2), 1.5, 0.3]])
        bodies = start._replace(
            attachments=Vec3(*np.zeros((3, 1))),
            ends=Vec3(*(jnp.asarray(top[None, :, i]) for i in range(3))),
            radius=np.array(0.01),
            half_height=np.array(0.01),
        )
        found = count(
            Vec3(*(jnp.asarray(load[:, i]) for i in range(3))),
            bodies,
            pack(boxes, cylinders, spheres, (1, 1, 1)),
        )
        s, t = np.linspace(0, 1, 60)[:, None, None], np.linspace(0, 1, 200)[None, :, None]
        low, high = (1 - s) * load[0] + s * load[1], (1 - s) * top[0] + s * top[1]
        points = ((1 - t) * low + t * high).reshape(-1, 3)
        thin = 0.06 - 1e-9
        x, y, z = (points - boxes[0, :3]).T
        c, d = np.cos(0.7), np.sin(0.7)
        own = np.stack([c * x + d * y, c * y - d * x, z], axis=1)
        touch = (np.abs(own) <= boxes[0, 3:6] + thin).all(axis=1).any()
        flat = points - cylinders[0, :3]
        touch |= (
            (np.hypot(*flat[:, :2].T) <= 0.2 + thin) & (np.abs(flat[:, 2]) <= 0.4 + thin)
        ).any()
        touch |= (np.linalg.norm(points - spheres[0, :3], axis=1) <= 0.3 + thin).any()
        if int(found) == 0:
            assert not touch
            clear += 1
        caught += bool(touch)
    assert clear > 40
    assert caught > 40
