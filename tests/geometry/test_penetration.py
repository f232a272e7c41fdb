"""The sum of depths against the count of contacts, and its gradient against plainer ones."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxsusp.geometry.collisions import (
    HELD_AGAINST,
    Bodies,
    Motion,
    count_at_samples,
    count_collisions,
    each_cable,
    with_margin,
)
from jaxsusp.geometry.depths import DEPTHS
from jaxsusp.geometry.obstacles import KINDS, Placed, pack
from jaxsusp.geometry.penetration import charge, deepest, sum_depths
from jaxsusp.geometry.polytopes import hull_of
from jaxsusp.vec3 import Vec3

UNIT = 0.1
SAMPLES, BATCH = 7, 400
BOXES = [[0.3, 0.2, 0.9, 0.2, 0.1, 0.3, 0.6]]
CYLINDERS = [[-0.5, 0.1, 0.5, 0.15, 0.4]]
SPHERES = [[0.1, -0.6, 1.2, 0.2]]
HULL = hull_of(np.array([[0, 0, 0], [0.5, 0, 0], [0, 0.4, 0], [0.1, 0.1, 0.6]]))
OBSTACLES = pack(
    np.array(BOXES), np.array(CYLINDERS), np.array(SPHERES), (1, 2, 1),
    [Placed((0.6, -0.4, 0.8), 0.4, HULL)],
)  # fmt: skip
QUICKLY = {"xla_backend_optimization_level": 0, "xla_llvm_disable_expensive_passes": True}
"""To compile what runs for milliseconds."""


def scene(moving: bool) -> tuple[np.ndarray, Bodies]:
    """Random walks of a load on three cables (3, samples, batch), about half of them clear."""
    rng = np.random.default_rng(3)
    start = rng.uniform([-1.5, -1.5, 0], [1.5, 1.5, 2], (BATCH, 3)).T[:, None]
    steps = rng.normal(scale=0.12, size=(3, SAMPLES - 1, BATCH))
    path = np.concatenate([start, start + steps.cumsum(axis=1)], axis=1)
    ends = np.array([[1.5, 0.0, 3.0], [-1.0, 1.3, 3.2], [-0.9, -1.4, 2.8]]).T
    if moving:
        drift = rng.normal(scale=0.05, size=(3, 3, SAMPLES, BATCH)).cumsum(axis=2)
        ends = ends[:, :, None, None] + 0.3 * path[:, None] + drift
    hooks = np.array([[0.1, 0.0, 0.15], [-0.1, 0.1, 0.15], [-0.1, -0.1, 0.15]]).T
    sizes = map(np.asarray, (0.1, 0.15, 0.01, 0.02))
    return path, Bodies(*sizes, Vec3(*hooks), Vec3(*ends))


def ours(path, bodies, band, obstacles=OBSTACLES):
    """Values per trajectory, and the gradients by positions and ends of their sum."""
    return _ours(path, bodies, np.asarray(band), obstacles)


@functools.partial(jax.jit, compiler_options=QUICKLY)
def _ours(path, bodies, band, obstacles):
    def total(path, ends):
        moved = bodies._replace(ends=Vec3(*ends))
        values = sum_depths(Vec3(*path), moved, obstacles, UNIT, band)
        return values.sum(), values

    (_, values), slopes = jax.value_and_grad(total, (0, 1), has_aux=True)(
        path, jnp.stack(bodies.ends)
    )
    return values, *slopes


def plainly(path, bodies, band):
    """The values, obstacle by obstacle and cable by cable."""
    motion, bodies = Motion.of(Vec3(*path)), with_margin(bodies, path.dtype)
    total = jnp.zeros(path.shape[2:], path.dtype)
    for kind in KINDS:
        packed = getattr(OBSTACLES, kind)
        for i in np.flatnonzero(packed.active):
            obstacle = jax.tree.map(lambda leaf, i=i: leaf[i], packed)
            for depth in HELD_AGAINST[kind](
                obstacle, motion, bodies, tuple(each_cable(bodies)), DEPTHS
            ):
                total += charge(depth / UNIT, band).sum(axis=0)
    return total


def plain(path, bodies, band):
    """The same as `ours` by reverse mode, operation by operation: nothing to compile."""

    def values(path, ends):
        return plainly(path, bodies._replace(ends=Vec3(*ends)), band)

    found, back = jax.vjp(values, jnp.asarray(path), jnp.stack(bodies.ends))
    return found, *back(jnp.ones_like(found))


@pytest.fixture(scope="module", params=[False, True], ids=["still", "moving"])
def case(request):
    """A scene, and ours of it without a band."""
    path, bodies = scene(request.param)
    return request.param, path, bodies, ours(path, bodies, 0.0)


@pytest.fixture(scope="module")
def aside(case):
    """Random directions of positions and, where they move, of ends."""
    moving, path, bodies, _ = case
    rng, ends = np.random.default_rng(4), np.array(bodies.ends)
    return rng.normal(size=path.shape), rng.normal(size=ends.shape) * moving


def along(aside, by_path, by_ends):
    """The slope along the directions that a gradient tells."""
    by_path, by_ends = (np.asarray(s) * d for s, d in zip((by_path, by_ends), aside, strict=True))
    return by_path.sum(axis=(0, 1)) + (by_ends.sum(axis=(0, 1, 2)) if by_ends.ndim == 4 else 0)


def test_it_is_zero_exactly_where_nothing_is_in_contact(case):
    _, path, bodies, (total, *_) = case
    count = np.asarray(jax.jit(count_collisions)(Vec3(*path), bodies, OBSTACLES))
    np.testing.assert_array_equal(np.asarray(total) > 0, count > 0)
    assert (np.asarray(total)[count == 0] == 0).all()
    assert 0.2 < (count > 0).mean() < 0.8


@pytest.mark.parametrize("band", [0.0, 0.3])
def test_values_and_gradient_are_those_of_a_plain_loop(case, band):
    moving, path, bodies, _ = case
    total, by_path, by_ends = ours(path, bodies, band)
    expected, *slopes = plain(path, bodies, band)
    np.testing.assert_allclose(total, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(by_path, slopes[0], rtol=1e-9, atol=1e-9)
    if moving:  # ends that stay are no variables
        np.testing.assert_allclose(by_ends, slopes[1], rtol=1e-9, atol=1e-9)
    else:
        assert not np.asarray(by_ends).any()


def test_its_gradient_is_that_of_finite_differences(case, aside):
    """Along random directions; of four hundred trajectories a few are at a kink."""
    _, path, bodies, _ = case
    h, band, ends = 1e-6, 0.3, np.array(bodies.ends)
    expected = along(aside, *ours(path, bodies, band)[1:])
    there, back = (
        ours(
            path + step * aside[0],
            bodies._replace(ends=Vec3(*(ends + step * aside[1]))),
            band,
        )[0]
        for step in (h, -h)
    )
    close = np.isclose((there - back) / (2 * h), expected, rtol=1e-5, atol=1e-5)
    assert close.mean() > 0.98
    assert (np.abs(expected) > 1e-3).mean() > 0.3


def test_padding_adds_nothing(case):
    """Whatever it holds: at what counts with it, all else being equal."""
    moving, path, bodies, known = case
    cylinders = OBSTACLES.cylinders
    for active, same in ((False, True), (True, False)):
        filled = cylinders._replace(
            center=cylinders.center.each(lambda c: np.resize(c, 1).repeat(2)),
            radius=np.resize(cylinders.radius, 1).repeat(2),
            half_height=np.resize(cylinders.half_height, 1).repeat(2),
            active=np.array([True, active]),
        )
        found = ours(path, bodies, 0.0, OBSTACLES._replace(cylinders=filled))
        for one, other in zip(found, known, strict=True):
            if moving or np.ndim(one) != 2:
                assert np.array_equal(one, other) is same


def test_gradients_are_finite_where_the_load_rests():
    """At an obstacle's centre, and hanging at a cable's end as well."""
    _, bodies = scene(False)
    places = np.array([BOXES[0][:3], CYLINDERS[0][:3], SPHERES[0][:3], [1.4, 0.0, 2.85]])
    path = np.zeros((3, SAMPLES, BATCH))
    path += np.resize(places.T, (3, 4)).repeat(BATCH // 4, axis=1)[:, None]
    found = ours(path, bodies, 0.1)
    assert all(np.isfinite(each).all() for each in found)
    assert (np.asarray(found[0])[: 3 * BATCH // 4] > 0).all()


@pytest.mark.fast
def test_the_charge_is_the_depth_beyond_a_smooth_band():
    depth = jnp.linspace(-1, 1, 2001)
    np.testing.assert_allclose(charge(depth, 0.0), jnp.maximum(depth, 0), atol=1e-9)
    wide = charge(depth, 0.25)
    assert (np.asarray(wide)[depth <= -0.25] == 0).all()
    np.testing.assert_array_equal(wide[depth >= 0.25], depth[depth >= 0.25])
    slope = np.diff(wide) / 1e-3
    assert (np.diff(slope) >= -1e-9).all(), "it must be convex"
    assert (np.abs(np.diff(slope)) < 3e-3).all(), "and have no corner"


@pytest.mark.parametrize("moving", [False, True])
def test_at_the_samples_the_depths_agree_with_the_contacts(moving):
    """As of the motion: a sum of 0 where the paper's check counts nothing, and more elsewhere."""
    path, bodies = scene(moving)

    @functools.partial(jax.jit, compiler_options=QUICKLY)
    def both(path, bodies):
        position = Vec3(*path)
        amount = sum_depths(position, bodies, OBSTACLES, UNIT, 0.0, at_samples=True)
        return amount, count_at_samples(position, bodies, OBSTACLES)

    amount, contacts = map(np.asarray, both(path, bodies))
    assert 40 < (contacts == 0).sum() < BATCH - 40
    np.testing.assert_array_equal(amount[contacts == 0] < 1e-5, True)
    assert (amount[contacts > 0] > 0).all()


def test_the_deepest_is_where_the_check_at_samples_sees_it():
    path, bodies = scene(moving=False)

    @functools.partial(jax.jit, compiler_options=QUICKLY)
    def both(path, bodies):
        position = Vec3(*path)
        return deepest(position, bodies, OBSTACLES), count_at_samples(position, bodies, OBSTACLES)

    found, contacts = both(path, bodies)
    np.testing.assert_array_equal(np.maximum(*found) >= 0, np.asarray(contacts) > 0)


def test_depths_of_a_load_and_of_a_cable_are_those_on_paper():
    """A load 0.1 m in radius beside a box, and a cable that runs through its middle."""
    box = pack(np.array([[0, 0, 0, 0.5, 2, 0.3, 0]]), np.zeros((0, 5)), np.zeros((0, 4)), (1, 1, 1))
    sizes = map(np.asarray, (0.1, 0.15, 0.01, 0.0))
    bodies = Bodies(*sizes, Vec3(*np.zeros((3, 1))), Vec3(*np.array([[-2.0], [0], [0]])))
    load, cables = deepest(Vec3(*np.array([[2.0, 0.57], [0, 0], [0, 0.0]])), bodies, box)
    assert float(load) == pytest.approx(0.03)
    assert float(cables) == pytest.approx(0.31)  # up or down and out
