"""What spares work among many bodies finds what looking at each of them finds."""

import numpy as np
import pytest
from scenes import anywhere

from jaxsusp.freespace import bodies as bodies_module
from jaxsusp.freespace import iris as iris_module
from jaxsusp.freespace import polylines
from jaxsusp.freespace.bodies import bodies_of, domain_of
from jaxsusp.freespace.build import free_space
from jaxsusp.freespace.iris import Bodies, iris, proved_apart
from jaxsusp.freespace.polylines import GRAZE, Polyhedra


def drawn_bodies(seed: int, count: int) -> list:
    scenario = anywhere(np.random.default_rng(seed), count, 3)
    domain = domain_of(scenario)
    return [b for b in bodies_of(scenario) if not proved_apart(domain, b)]


@pytest.mark.parametrize("seed", range(3))
def test_regions_are_the_same(seed, monkeypatch):
    scenario = anywhere(np.random.default_rng(seed), 12, 3)
    domain, each = domain_of(scenario), drawn_bodies(seed, 12)
    few = Bodies(each)
    monkeypatch.setattr(iris_module, "MANY", 0)
    many = Bodies(each)
    assert many.many
    assert not few.many
    points = np.random.default_rng(seed).uniform(-3, 4, (300, 3))
    free = points[(domain.excess(points) < 0) & ~few.holding(points)][:6]
    assert len(free) > 2
    for seed_point in free:
        one, other = (iris(bodies, domain, seed_point) for bodies in (few, many))
        assert (one is None) == (other is None)
        if one is not None:
            np.testing.assert_allclose(other.polytope.A, one.polytope.A, atol=1e-9)
            np.testing.assert_allclose(other.polytope.b, one.polytope.b, atol=1e-9)


def test_planes_and_places_are_told_the_same(monkeypatch):
    each, random = drawn_bodies(5, 12), np.random.default_rng(0)
    few = Bodies(each)
    monkeypatch.setattr(iris_module, "MANY", 0)
    many = Bodies(each)
    found = []
    for normal in random.normal(size=(200, 3)):
        normal /= np.linalg.norm(normal)
        offset = random.uniform(-3, 3)
        found.append(few.beyond(normal, offset))
        np.testing.assert_array_equal(many.beyond(normal, offset), found[-1])
    assert 0.1 < np.mean(found) < 0.9
    for point in random.uniform(-3, 4, (200, 3)):
        names = [b.name for b in few.bodies if b.faces.excess(point) <= iris_module.GAP]
        assert {*names} <= {b.name for b in many.around(point)}


def test_segments_meet_the_same(monkeypatch):
    solid = Polyhedra([body.faces for body in drawn_bodies(2, 12)], -GRAZE)
    random = np.random.default_rng(1)
    begin = random.uniform([-3, -3, 0], [3, 3, 5], (60, 3))
    segments = begin, begin + random.normal(size=(60, 3))
    expected = solid.met(*segments)
    assert 5 < expected.sum() < 55
    monkeypatch.setattr(polylines, "_MANY", 0)
    np.testing.assert_array_equal(solid.met(*segments), expected)
    for one, two, met in zip(*segments, expected, strict=True):
        assert solid.met(one[None], two[None]) == met


def test_rougher_bodies_hold_the_finer_ones(monkeypatch):
    scenario = anywhere(np.random.default_rng(3), 9, 3)
    fine = bodies_of(scenario)
    monkeypatch.setattr(bodies_module, "FEW", 0)
    rough = bodies_of(scenario)
    assert sum(len(b.corners) for b in rough) < 0.6 * sum(len(b.corners) for b in fine)
    points = np.random.default_rng(4).uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (40_000, 3))
    inside, roughly = (Bodies(each).holding(points) for each in (fine, rough))
    assert (inside & ~roughly).sum() <= 0.002 * inside.sum()  # what of a finer corner sticks out
    assert roughly.mean() < inside.mean() + 0.02


def test_a_space_among_many_bodies_is_covered(monkeypatch):
    monkeypatch.setattr(bodies_module, "FEW", 0)
    for module in (iris_module, polylines):
        monkeypatch.setattr(module, "MANY" if module is iris_module else "_MANY", 10)
    space = free_space("scenario-5", cache=False)
    assert space.connected
    assert space.coverage > 0.95
