"""IRIS on random scenes: no crash, no region that meets a body, seeds where they may be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import anywhere
from scipy.optimize import linprog

from jaxsusp.errors import InputError
from jaxsusp.freespace.bodies import bodies_of, domain_of
from jaxsusp.freespace.iris import Bodies, Region, iris, proved_apart
from jaxsusp.freespace.polyhedra import Body, HalfSpaces

CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)


def common_ball(region: Region, body: Body) -> float:
    """Radius of the largest ball in region ∩ body by another solver; negative if apart (m).

    The body is the hull of its corners: x = Σ λ_i v_i; the ball is measured in the region.
    """
    count, faces = len(body.corners), len(region.polytope.b)
    rows = np.column_stack([region.polytope.A @ body.corners.T, np.ones(faces)])
    found = linprog(
        np.eye(count + 1)[-1] * -1,
        rows,
        region.polytope.b,
        np.append(np.ones(count), 0)[None],
        [1.0],
        bounds=[(0, None)] * count + [(None, None)],
        method="highs",
    )
    assert found.status == 0
    return -found.fun


def check(region: Region, bodies: Bodies, domain: HalfSpaces) -> None:
    beyond = [bodies.beyond(*face) for face in zip(*region.polytope, strict=True)]
    for i in np.flatnonzero(~np.any(beyond, axis=0)):  # what no face keeps out alone
        body = bodies.bodies[i]
        assert proved_apart(region.polytope, body)
        assert common_ball(region, body) < 1e-7  # the tolerance of HiGHS, not ours
    C, d = region.ellipsoid
    reach = np.linalg.norm(region.polytope.A @ C, axis=1) + region.polytope.A @ d
    assert (reach <= region.polytope.b + 1e-12).all()
    assert (np.linalg.norm(domain.A @ C, axis=1) + domain.A @ d <= domain.b + 1e-12).all()


@given(st.integers(0, 2**32 - 1), st.integers(0, 14), st.integers(3, 6))
@settings(deadline=None, max_examples=25)
def test_random_scenes(seed, count, robots):
    random = np.random.default_rng(seed)
    scenario = anywhere(random, count, robots)
    domain = domain_of(scenario)
    bodies = Bodies([b for b in bodies_of(scenario) if not proved_apart(domain, b)])
    lower, upper = np.array(scenario.workspace.lower), np.array(scenario.workspace.upper)
    on_a_face = random.uniform(lower, upper)
    on_a_face[random.integers(3)] = random.choice([0.2, 3.5])
    corner = np.where(random.random(3) < 0.5, lower, upper)
    on_a_body = random.choice(bodies.corners) if len(bodies) else corner
    seeds = [*random.uniform(lower, upper, (3, 3)), on_a_face, corner, on_a_body]
    for point in seeds:
        refused = domain.excess(point) > 1e-9 or any(
            body.faces.excess(point) <= 1e-9 for body in bodies.bodies
        )
        if refused:
            with pytest.raises(InputError, match=r"seed = .* is (in|outside)"):
                iris(bodies, domain, point)
            continue
        region = iris(bodies, domain, point)
        if region is not None:
            assert region.polytope.excess(point) <= 1e-9, "a region contains its seed"
            check(region, bodies, domain)


def box(center, half) -> Body:
    return Body.hull("box", np.asarray(center) + CORNERS * half)


@pytest.mark.fast
def test_an_empty_domain_is_one_region():
    domain = HalfSpaces.box(np.zeros(3), np.full(3, 4.0))
    region = iris(Bodies([]), domain, np.ones(3))
    assert region.ellipsoid.volume == pytest.approx(4 / 3 * np.pi * 8, rel=1e-6)


@pytest.mark.fast
def test_a_slab_between_two_walls_is_filled():
    """Walls at x = 1 and x = 3: the region is what lies between, whatever the seed."""
    domain = HalfSpaces.box(np.zeros(3), np.full(3, 4.0))
    walls = Bodies([box([0.5, 2, 2], [0.5, 3, 3]), box([3.5, 2, 2], [0.5, 3, 3])])
    region = iris(walls, domain, np.array([1.1, 0.2, 3.9]))
    assert region.ellipsoid.volume == pytest.approx(4 / 3 * np.pi * 1 * 2 * 2, rel=1e-5)


@pytest.mark.fast
def test_a_body_cleared_only_by_two_planes_together_gets_no_third():
    """Behind the edge where two planes meet lies a body that neither of them clears alone."""
    half = HalfSpaces(np.array([[1.0, 1, 0], [1, -1, 0]]) / np.sqrt(2), np.zeros(2))
    wedge = HalfSpaces.box(np.full(3, -5.0), np.full(3, 5.0)) & half  # x <= -|y|
    behind = box([1.0, 0, 0], [0.5, 3, 1])
    assert not ((behind.corners @ wedge.A.T).min(axis=0) > wedge.b).any()
    assert proved_apart(wedge, behind)
    assert not proved_apart(wedge, box([-0.4, 0, 0], [0.5, 3, 1]))


@pytest.mark.fast
def test_touching_bodies_and_a_hair_of_room():
    """Seeds between bodies 2 µm apart: a region or none, never one that meets a body."""
    domain = HalfSpaces.box(np.full(3, -3.0), np.full(3, 3.0))
    bodies = Bodies([box([-1, 0, 0], [1 - 1e-6, 1, 1]), box([1, 0, 0], [1 - 1e-6, 1, 1])])
    region = iris(bodies, domain, np.zeros(3))
    if region is not None:
        check(region, bodies, domain)
