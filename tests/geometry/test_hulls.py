"""Convex hulls of meshes among the obstacles, against boxes, scipy's hulls and dense sampling."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from jaxsusp.geometry.collisions import Bodies, count_at_samples, count_between, count_collisions
from jaxsusp.geometry.depths import segment_in_faces
from jaxsusp.geometry.obstacles import Placed, hull_counts, pack
from jaxsusp.geometry.polytopes import FACES, hull_of
from jaxsusp.geometry.segments import Faces, segment_meets_faces
from jaxsusp.vec3 import Vec3

NONE = [np.zeros((0, width)) for width in (7, 5, 4)]
SIGNS = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
COUNTS = (0, 0, 0, 2, 80, 80)  # one compiled program for all hulls here
QUICKLY = {"xla_backend_optimization_level": 0, "xla_llvm_disable_expensive_passes": True}

count = jax.jit(count_collisions, compiler_options=QUICKLY)
between = jax.jit(count_between, compiler_options=QUICKLY)
at_samples = jax.jit(count_at_samples, compiler_options=QUICKLY)


def scene(seed: int, batch: int = 300, moving: bool = False) -> tuple[Vec3, Bodies]:
    """Random walks of a load on three cables about the origin."""
    random = np.random.default_rng(seed)
    start = random.uniform([-1.5, -1.5, -1.2], [1.5, 1.5, 1.2], (batch, 3)).T[:, None]
    path = start + random.normal(scale=0.15, size=(3, 5, batch)).cumsum(axis=1)
    ends = np.array([[1.5, 0.0, 3.0], [-1.0, 1.3, 3.2], [-0.9, -1.4, 2.8]]).T
    if moving:
        ends = ends[:, :, None, None] + random.normal(scale=0.05, size=(3, 3, 5, batch))
    hooks = np.array([[0.1, 0.0, 0.15], [-0.1, 0.1, 0.15], [-0.1, -0.1, 0.15]]).T
    sizes = map(np.asarray, (0.1, 0.15, 0.01, 0.05))
    return Vec3(*path), Bodies(*sizes, Vec3(*hooks), Vec3(*ends))


half = st.floats(0.05, 1.0)


@given(size=st.tuples(half, half, half), yaw=st.floats(-4, 4), seed=st.integers(0, 99))
@settings(deadline=None, max_examples=12, derandomize=True)
@pytest.mark.parametrize("counted", [count, between], ids=["still", "moving"])
def test_a_hull_that_is_a_box_counts_as_the_box(counted, size, yaw, seed):
    path, bodies = scene(seed, moving=counted is between)
    box = pack(np.array([[0.2, -0.1, 0.3, *size, yaw]]), *NONE[1:], (1, 0, 0))
    hull = hull_of(np.array(size) * SIGNS)
    assert (len(hull.normals), len(hull.grown)) == (6, 6)
    as_hull = pack(*NONE, COUNTS, [Placed((0.2, -0.1, 0.3), yaw, hull)])
    known = np.asarray(counted(path, bodies, box))
    np.testing.assert_array_equal(counted(path, bodies, as_hull), known)
    assert known.any()


def body_points(bodies: Bodies) -> np.ndarray:
    """Points on the rims of the load, about its centre."""
    angle = np.linspace(0, 2 * np.pi, 25)[:-1]
    ring = float(bodies.radius) * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    up = np.array([0, 0, float(bodies.half_height)])
    return np.concatenate([ring + up, ring - up])


@pytest.mark.parametrize("seed", range(3))
def test_what_counts_nothing_is_clear_at_every_instant(seed):
    """Nearest points by trimesh, of dense points of load and cables at dense instants."""
    random = np.random.default_rng(seed)
    points = random.normal(scale=0.5, size=(9 + 20 * seed, 3))
    hull = hull_of(points)
    path, bodies = scene(10 + seed, 400)
    found = np.asarray(count(path, bodies, pack(*NONE, COUNTS, [Placed((0, 0, 0), 0.0, hull)])))
    solid = ConvexHull(points).equations  # distances beyond its planes are distances at most
    mesh = trimesh.Trimesh(points, ConvexHull(points).simplices)
    clear = np.flatnonzero(found == 0)
    assert 40 < len(clear) < 360
    clear, least = clear[:60], np.inf
    centers = np.stack(path, axis=-1)[:, clear]  # (samples, candidates, 3)
    share = np.linspace(0, 1, 9)[:, None, None, None]
    centers = (centers[:-1] + share * np.diff(centers, axis=0)).reshape(-1, 3)
    hooks, ends = np.stack(bodies.attachments, axis=-1), np.stack(bodies.ends, axis=-1)
    lower = centers[:, None] + hooks
    along = np.linspace(0, 1, 25)[:, None, None, None]
    cables = (lower + along * (ends - lower)).reshape(-1, 3)
    load = (centers[:, None] + body_points(bodies)).reshape(-1, 3)
    for which, gap in ((cables, 0.06), (load, 0.05)):
        beyond = (which @ solid[:, :3].T + solid[:, 3]).max(axis=1)
        near = which[beyond < gap]
        assert (beyond > 0).all()
        if len(near):
            nearest = trimesh.proximity.closest_point(mesh, near)[1]
            least = min(least, (nearest - gap).min())
    assert least > -1e-9


@pytest.mark.parametrize("seed", range(2))
def test_what_touches_counts(seed):
    """A load whose rim is in the hull, and a cable that goes through it."""
    random = np.random.default_rng(seed)
    points = random.normal(scale=0.4, size=(30, 3))
    path, bodies = scene(20 + seed, 400)
    packed = pack(*NONE, COUNTS, [Placed((0, 0, 0), 0.0, hull_of(points))])
    found = np.asarray(at_samples(path, bodies, packed))
    solid = ConvexHull(points).equations
    rims = np.stack(path, axis=-1)[..., None, :] + body_points(bodies)
    inside = (rims @ solid[:, :3].T + solid[:, 3]).max(axis=-1) < 0
    touching = inside.any(axis=(0, 2))
    assert touching.any()
    assert (found[touching] > 0).all()


def test_a_hull_is_held_by_few_faces_that_let_little_in():
    ball = trimesh.creation.icosphere(subdivisions=3)
    points = np.asarray(ball.vertices)
    body = hull_of(points)
    assert len(body.normals) <= FACES
    assert (points @ body.normals.T <= body.offsets + 1e-9).all()
    assert (body.corners @ body.normals.T <= body.offsets + 1e-9).all()
    assert body.volume == pytest.approx(4 / 3 * np.pi, rel=0.06)
    few = hull_of(points, 12)
    assert len(few.normals) == 12
    assert few.volume > body.volume


@given(st.integers(0, 10**6))
@settings(deadline=None, max_examples=20, derandomize=True)
def test_few_points_have_their_own_hull(seed):
    points = np.random.default_rng(seed).normal(size=(12, 3)) * [3, 1, 0.2]
    body, known = hull_of(points), ConvexHull(points)
    assert body.volume == pytest.approx(known.volume, rel=1e-4)
    assert (points @ body.normals.T <= body.offsets + 1e-9).all()
    np.testing.assert_allclose(body.support(body.normals), body.offsets, atol=1e-9)
    placed, turned = body.placed((1.0, 2.0, 3.0), 30.0), np.deg2rad(30)
    place = [np.cos(turned), np.sin(turned), 0] @ np.diag([1, 1, 1]) + [1, 2, 3]
    on = body.corners[0]
    flat = np.array([[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]])
    assert placed.corners[0] == pytest.approx([*flat @ on[:2] + [1, 2], on[2] + 3])
    assert place[2] == 3


def test_what_is_flat_gets_a_little_thick():
    body = hull_of(np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0.0]]))
    assert np.ptp(body.corners, axis=0) == pytest.approx([2, 2, 2e-4])


@pytest.fixture(scope="module")
def planes() -> Faces:
    body = hull_of(np.random.default_rng(4).normal(scale=0.5, size=(14, 3)))
    return Faces(
        Vec3(*jnp.asarray(body.grown.T)), jnp.asarray(body.support(body.grown)),
        jnp.asarray(len(body.grown), jnp.int32),
    )  # fmt: skip


def test_the_depth_is_that_of_dense_points_and_meets_where_it_is_positive(planes):
    a, b = np.random.default_rng(5).normal(scale=0.8, size=(2, 500, 3))
    reach = 0.1

    def depth(a, b):
        return segment_in_faces(
            Vec3.from_array(a), Vec3.from_array(b), planes, lambda normal: reach
        )

    found, back = jax.vjp(depth, jnp.asarray(a), jnp.asarray(b))
    normals = np.stack(planes.normal, axis=-1)
    share = np.linspace(0, 1, 2001)[:, None, None]
    rooms = (np.asarray(planes.offset) + reach - (a + share * (b - a)) @ normals.T).min(axis=-1)
    np.testing.assert_allclose(found, rooms.max(axis=0), atol=2e-3)
    assert (np.asarray(found) >= rooms.max(axis=0) - 1e-9).all()
    met = segment_meets_faces(Vec3.from_array(jnp.asarray(a)), Vec3.from_array(jnp.asarray(b)),
                              planes, lambda normal: jnp.asarray(reach))  # fmt: skip
    np.testing.assert_array_equal(met, found > 0)
    assert 100 < int(np.sum(met)) < 400
    for slope, one in zip(back(jnp.ones(500)), (0, 1), strict=True):
        aside = np.random.default_rng(6).normal(size=(500, 3))
        moved = [a, b]
        moved[one] = moved[one] + 1e-6 * aside
        back_ = [a, b]
        back_[one] = back_[one] - 1e-6 * aside
        told = (depth(*map(jnp.asarray, moved)) - depth(*map(jnp.asarray, back_))) / 2e-6
        off = np.abs((np.asarray(slope) * aside).sum(axis=1) - np.asarray(told))
        assert np.quantile(off, 0.98) < 1e-4  # elsewhere two planes change places


def test_scenes_without_hulls_hold_nothing_of_them():
    assert pack(*NONE, (0, 0, 0)).hulls is None
    assert len(jax.tree.leaves(pack(*NONE, (0, 0, 0)))) == 9 + 6 + 5
    assert hull_counts([]) == ()
