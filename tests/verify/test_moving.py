"""Certificates where ends and arms move, against distances computed densely and otherwise."""

import functools

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_certificate import signed_distance

import jaxsusp as js
from jaxsusp.geometry.segments import segment_distance
from jaxsusp.mechanics import arm
from jaxsusp.suspension.rigging import Rigging, ends_beside
from jaxsusp.trajectory.smoothpath import SmoothPath, Spline
from jaxsusp.trajectory.timelaw import TimeLaw
from jaxsusp.vec3 import Vec3
from jaxsusp.verify.certificate import TOLERANCE, _Search, certify
from jaxsusp.verify.elbow import elbow, elbow_speed

WAYS = {
    "end": [(-0.5, 0.9, 1.2), (0.0, 1.3, 1.5), (0.5, 0.6, 1.5)],
    "base": [(-0.6, 1.3, 1.0), (0.1, 1.5, 1.3), (0.8, 0.5, 1.5)],
    "hybrid": [(-0.6, 0.5, 1.4), (0.2, 0.4, 1.7), (0.8, 0.1, 1.2)],
}
HOOK = np.array([0.0, 0.0, 0.15])
U = 801


@functools.cache
def rig(drive: str, **limits) -> Rigging:
    """A load that goes over a crate and past a pillar, whatever becomes of the arms."""
    content = js.load_scenario("end-driven").model_dump()
    content |= {"name": drive, "drive": drive}
    for robot in content["robots"]:
        robot["end"] = (*robot["end"][:2], 6.5 if drive == "end" else 7.0)
    content["obstacles"] = (
        {"kind": "box", "name": "crate", "center": (0.2, 0.9, 0.3), "size": (0.5, 0.4, 0.6)},
        {"kind": "cylinder", "name": "pole", "center": (1.4, 1.6, 2.0), "radius": 0.1, "height": 4},
    )
    content["limits"] = {**content["limits"], **limits}
    scenario = js.Scenario.model_validate(content)
    knots = np.array([scenario.task.start, *WAYS[drive], scenario.task.goal])
    # Twelve points of a curve through these knots.
    points = Spline(np.linspace(0, 1, len(knots)), knots).curve(np.linspace(0, 1, 12))
    return Rigging.of(
        scenario, TimeLaw.through(points, scenario.task.duration), ends_beside(scenario, points)
    )


certified = functools.cache(certify)


@pytest.fixture(scope="module", params=WAYS)
def rigging(request) -> Rigging:
    return rig(request.param)


@jax.jit
def least_distance(*points: Vec3) -> jax.Array:
    return segment_distance(*points).min()


def between(a, b, c, d) -> float:
    """Least distance of segments, one pair per row."""
    points = (Vec3(*np.moveaxis(p, -1, 0)) for p in np.broadcast_arrays(a, b, c, d))
    return float(least_distance(*points))


def dense(rigging: Rigging) -> dict[str, float]:
    """Least distances of every kind at many instants."""
    u = np.linspace(*rigging.law.path.span, U)
    center, ends = rigging.law.path.curve(u), rigging.ends_at(u)
    chains, count, scenario = rigging.chains_at(ends), rigging.cables, rigging.scenario
    hooks, share = center + HOOK, np.linspace(0, 1, 200)[:, None, None]
    radius = [[r.column_radius, r.link_radius, r.link_radius] for r in scenario.robots]
    least = dict.fromkeys(
        ("cables to obstacles", "cables to arms", "cables to each other", "arms to obstacles",
         "arms to each other", "ends to each other", "load to arms"), np.inf,
    )  # fmt: skip

    def note(kind: str, value: float) -> None:
        least[kind] = min(least[kind], value)

    axis = np.array([0, 0, 0.15])
    for k in range(count):
        line = (1 - share) * hooks + share * ends[:, k]
        for body in scenario.obstacles:
            note("cables to obstacles", signed_distance(body, line).min() - 0.01)
        for j in range(count):
            for part in range(3):
                piece = chains[:, j, part], chains[:, j, part + 1]
                if (j, part) != (k, 2):
                    gap = between(hooks, ends[:, k], *piece)
                    note("cables to arms", gap - 0.01 - radius[j][part])
                if k:
                    continue
                gap = between(center - axis, center + axis, *piece)
                note("load to arms", gap - 0.1 - radius[j][part])
                link = (1 - share) * piece[0] + share * piece[1]
                for body in scenario.obstacles:
                    gap = signed_distance(body, link).min() - radius[j][part]
                    note("arms to obstacles", gap)
        for j in range(k):
            lower = hooks + 0.1 * (ends[:, k] - hooks), hooks + 0.1 * (ends[:, j] - hooks)
            note("cables to each other", between(lower[0], ends[:, k], lower[1], ends[:, j]) - 0.02)
            note("ends to each other", np.linalg.norm(ends[:, k] - ends[:, j], axis=1).min())
            for a in range(3):
                for b in range(3):
                    one, other = chains[:, k, a : a + 2], chains[:, j, b : b + 2]
                    gap = between(one[:, 0], one[:, 1], other[:, 0], other[:, 1])
                    note("arms to each other", gap - radius[k][a] - radius[j][b])
    return least


def test_least_distances_are_those_of_a_dense_check(rigging):
    found = {each.kind: each.value for each in certified(rigging).clearances}
    for kind, sampled in dense(rigging).items():
        if sampled <= 0:  # how deep bodies overlap is measured in different ways
            assert found[kind] <= 0
            continue
        # For the load's cylinder the dense check takes a capsule around it, which is nearer.
        more = 0.1 if kind == "load to arms" else TOLERANCE
        assert found[kind] <= sampled + more, kind
        assert found[kind] >= sampled - 2e-3, kind


def test_a_certificate_costs_some_thousands_of_distances(rigging):
    found = certified(rigging)
    assert found.distances < 20_000
    assert certify(rigging, first_only=True).distances <= found.distances


@pytest.mark.parametrize(("spare", "proved"), [(1e-3, True), (-1e-3, False)])
def test_the_clearance_of_a_moving_cable_is_exact(spare, proved):
    """The clearance asked for is a little less, or more, than the least distance of the cables."""
    free = rig("hybrid")
    least = {each.kind: each for each in certified(free).clearances}["cables to obstacles"]
    assert 0.05 < least.value < least.value + 1e-3
    contacts = certify(rig("hybrid", clearance=least.value - spare)).contacts
    about_it = [c for c in contacts if c.bodies == least.bodies]
    assert bool(about_it) != proved
    if about_it:
        assert about_it[0].least == pytest.approx(least.value, abs=2e-3)


def test_ends_that_lead_a_cable_through_a_thin_sheet_between_two_points_are_found():
    """At every point of the path the cable is far from the sheet; between two it jumps over."""
    rigging = rig("hybrid")
    content = rigging.scenario.model_dump()
    path = rigging.law.path
    jumped = rigging.end_path.copy()
    jumped[6:, 0] += [1.2, 0.0, 0.0]  # end 1 goes aside between two points
    moved = Rigging(rigging.scenario, rigging.law, jumped, rigging.elbow_up)
    knots = moved.tracks[0].u
    u = (knots[5] + knots[6]) / 2  # in the middle of the jump
    hook, end = path.curve([u])[0] + HOOK, moved.ends_at(np.array([u]))[0, 0]
    sheet = {"kind": "box", "name": "sheet", "center": tuple((0.3 * hook + 0.7 * end).tolist()),
             "size": (0.005, 0.3, 0.3)}  # fmt: skip
    content["obstacles"] = (sheet,)
    scenario = js.Scenario.model_validate(content)
    lines = path.curve(knots)[:, None] + HOOK, moved.end_path[:, :1]
    share = np.linspace(0, 1, 300)[:, None, None, None]
    at_points = signed_distance(scenario.obstacles[0], (1 - share) * lines[0] + share * lines[1])
    assert at_points.min() > 0.06
    found = certify(Rigging(scenario, moved.law, jumped, moved.elbow_up))
    assert ("cable 1", "sheet") in {contact.bodies for contact in found.contacts}


def test_what_points_do_beyond_their_first_order_motion_is_bounded(rigging):
    """Also where they go away and come back, so that the rate in the middle tells nothing."""
    search = _Search(rigging, first_only=False)
    system, path = search._system, rigging.law.path
    low, high = path.span
    rng = np.random.default_rng(5)
    middle = rng.uniform(low, high, 40)
    half = np.minimum(rng.uniform(0.02, 0.5, 40), np.minimum(middle - low, high - middle))
    motion = search._motion(middle, half, rigging.ends_at(middle))
    shares = np.linspace(-1, 1, 41)

    def points(u):
        return system.locate(path.curve(u), rigging.ends_at(u))

    at = points(middle)
    for _ in range(30):
        a, b = rng.integers(1, len(system.along), (2, 40))
        rows = np.arange(40)
        rest = motion.rest(system, a, b, half)
        rate = motion.rates[rows, a] - motion.rates[rows, b]
        apart = at[rows, a] - at[rows, b]
        for share in shares:
            moved = points(middle + share * half)
            off = moved[rows, a] - moved[rows, b] - apart - rate * (share * half)[:, None]
            assert (np.linalg.norm(off, axis=1) <= rest + 1e-9).all()


@pytest.mark.fast
def test_the_bound_of_bends_is_needed():
    """A way that goes out and back about the middle of an interval has no rate there."""
    path = SmoothPath(np.array([[0, 0, 0], [1, 0.2, 0], [2, 0.4, 0], [3, 0.2, 0], [4, 0, 0.0]]))
    middle = np.array([sum(path.span) / 2])
    assert abs(path.derivatives[0](middle)[0, 1]) < 1e-9
    _, bend = path.spline.bounds(middle - 1, middle + 1)
    fallen = path.curve(middle)[0, 1] - path.curve(middle + 1)[0, 1]
    assert 0.05 < fallen <= 0.5 * bend[0]


# Elbows

inverse, known_elbow = jax.jit(arm.inverse), jax.jit(arm.elbow)
ARMS = st.tuples(st.floats(1.0, 4.0), st.floats(1.0, 4.0))


@given(ARMS, st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_elbows_are_those_of_the_inverse_kinematics_and_no_faster_than_their_bound(lengths, seed):
    rng = np.random.default_rng(seed)
    base, links = np.array([[0.5, -0.3, 0.2]]), np.array([[2.0, *lengths]])
    shoulder = base + np.array([0, 0, 2.0])
    reach = abs(lengths[0] - lengths[1]), sum(lengths)
    away = rng.normal(size=(2, 3))
    away *= rng.uniform(*reach, (2, 1)) / np.linalg.norm(away, axis=1, keepdims=True)
    t = np.linspace(0, 0.05, 41)[:, None]
    ends = shoulder + (1 - t) * away[0] + t * away[1]
    for up in (True, False):
        found = elbow(shoulder, links, ends[:, None], np.array([up]))[:, 0]
        solution = inverse(base, links, ends)
        joints = solution.elbow_up if up else solution.elbow_down
        known = known_elbow(base, links, joints)
        np.testing.assert_allclose(found, known, atol=1e-6)
        speed = np.linalg.norm(away[1] - away[0])
        one = np.ones((1, 1))
        half = speed * t[-1, 0] / 2
        bound = elbow_speed(shoulder, links, ends[20][None, None], half * one, speed * one)[0, 0]
        steps = np.linalg.norm(np.diff(found, axis=0), axis=1) / (t[1] - t[0])
        assert steps.max() <= bound * (1 + 1e-6)


# What goes with the load


def test_ends_are_held_and_modes_keep_what_they_keep(rigging):
    scenario = rigging.scenario
    u = np.linspace(*rigging.law.path.span, 60)
    ends = rigging.ends_at(u)
    joints, bases = rigging.joints_at(ends), rigging.bases_at(ends)
    held = jax.jit(arm.forward)(bases, rigging.links[None], joints)
    np.testing.assert_allclose(held, ends, atol=1e-9)
    np.testing.assert_allclose(rigging.chains_at(ends)[:, :, 3], ends, atol=1e-9)
    lengths = np.linalg.norm(ends - (rigging.law.path.curve(u) + HOOK)[:, None], axis=-1)
    if scenario.drive in ("end", "base"):
        assert np.ptp(lengths, axis=0).max() < 2e-4  # of a path of twelve points
    if scenario.drive == "base":
        assert np.ptp(joints, axis=0).max() < 1e-9
        assert np.ptp(bases[..., 2]) < 1e-9
        assert np.ptp(bases[..., 0]) > 0.5
    else:
        np.testing.assert_array_equal(bases, np.broadcast_to(rigging.bases, bases.shape))
        assert np.ptp(joints, axis=0).max() > 0.1
