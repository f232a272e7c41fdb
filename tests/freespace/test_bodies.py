"""Bodies in the space of load positions against the exact contact tests of the fitness."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh
from scenes import anywhere

import jaxsusp as js
from jaxsusp.freespace.bodies import bodies_of, domain_of
from jaxsusp.freespace.iris import Bodies
from jaxsusp.geometry.cables import cable_lengths, cable_vectors
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.mechanics.statics import hook_tensions, weight
from jaxsusp.scenario.models import Box, Mesh
from jaxsusp.scenario.world import build_world
from jaxsusp.vec3 import Vec3

count = jax.jit(count_collisions)


def contacts(scenario: js.Scenario, points: np.ndarray, larger: float = 0.0) -> np.ndarray:
    """Contacts of load and cables at rest, by the test that the fitness uses.

    Points come in multiples of 20 000, so that one program serves all.
    """
    world = build_world(scenario, (9, 9, 9))
    bodies = world.bodies._replace(clearance=world.bodies.clearance + larger)
    found = []
    for part in np.split(points, len(points) // 20_000):
        still = Vec3(*jnp.asarray(np.stack([part, part])).transpose(2, 0, 1))
        found.append(np.asarray(count(still, bodies, world.obstacles)))
    return np.concatenate(found)


@pytest.mark.parametrize("seed", range(4))
def test_no_contact_outside_the_bodies(seed):
    """Whatever the kinds: where the load is in no body, nothing touches anything."""
    random = np.random.default_rng(seed)
    scenario = anywhere(random, 9, 3)
    points = random.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (20_000, 3))
    free = ~Bodies(bodies_of(scenario)).holding(points)
    assert 100 < free.sum() < 19_900
    assert contacts(scenario, points)[free].max() == 0


def test_boxes_are_exact():
    """A contact with the obstacle inflated by a little less than the body, and only then."""
    random = np.random.default_rng(7)
    boxes = [o for o in anywhere(random, 40, 3).obstacles if o.kind == "box"][:9]
    scenario = anywhere(random, 0, 3).model_copy(update={"obstacles": tuple(boxes)})
    points = random.uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (20_000, 3))
    inside = Bodies(bodies_of(scenario)).holding(points)
    np.testing.assert_array_equal(inside, contacts(scenario, points, larger=1e-4) > 0)


def test_round_bodies_take_little_more_than_their_own(scenarios):
    """Of positions near the surface of pillar and ball, only within 2 % of the radius."""
    scenario = scenarios[5]
    points = np.random.default_rng(1).uniform([-3, -3, 0.2], [3, 3, 5], (60_000, 3))
    inside = Bodies(bodies_of(scenario)).holding(points)
    largest = 0.39 + scenario.payload.radius + 0.06
    assert (contacts(scenario, points, larger=1e-4 + 0.02 * largest)[inside] > 0).all()
    assert (contacts(scenario, points)[inside] == 0).any(), "circumscribed, not inscribed"


@pytest.mark.parametrize("heights", [(7.0, 7.0, 7.0), (6.0, 8.5, 7.0)])
def test_the_domain_is_where_every_cable_pulls(scenarios, heights):
    frame = scenarios[0]
    robots = [
        r.model_copy(update={"end": (*r.end[:2], z)})
        for r, z in zip(frame.robots, heights, strict=True)
    ]
    scenario = frame.model_copy(update={"robots": tuple(robots)})
    points = np.random.default_rng(0).uniform([-3.5, -3.5, 0.2], [3.5, 3.5, 5.5], (5000, 3))
    world = build_world(scenario)
    vectors = cable_vectors(
        Vec3.from_array(jnp.asarray(points)), world.bodies.attachments, world.bodies.ends
    )
    tensions = np.array(hook_tensions(vectors, cable_lengths(vectors), weight(world.mass)))
    excess = domain_of(scenario).excess(points)
    clearly = np.abs(excess) > 1e-9
    np.testing.assert_array_equal((excess < 0)[clearly], (tensions > 0).all(axis=0)[clearly])


@pytest.mark.fast
def test_more_robots_widen_the_domain():
    """The polygon of six level ends: the load may be wherever the hook is inside the hexagon."""
    scenario = anywhere(np.random.default_rng(0), 0, 6)
    level = [r.model_copy(update={"end": (*r.end[:2], 7.0)}) for r in scenario.robots]
    domain = domain_of(scenario.model_copy(update={"robots": tuple(level)}))
    assert domain.excess(np.array([3.4, 3.4, 1.0])) < 0
    assert domain.excess(np.array([3.6, 0.0, 1.0])) > 0  # the workspace ends at 3.5


def test_an_end_in_a_warning_area_is_an_error(scenarios):
    robot = scenarios[0].robots[1]
    block = Box(name="shed", center=robot.end, size=(1.0, 1.0, 1.0))
    scenario = scenarios[0].model_copy(update={"obstacles": (block,)})
    with pytest.raises(js.InputError, match=r'robots\[1\]\.end = .* obstacles\[0\] "shed"; move'):
        bodies_of(scenario)


def test_a_mesh_is_its_box_or_its_hull(scenarios, tmp_path):
    wedge = trimesh.Trimesh(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )
    wedge.export(tmp_path / "wedge.stl")
    corner = np.array([[0.47, 0.47, 1.47]])  # of the box, far from the hull

    def inside(shape: str) -> bool:
        mesh = Mesh(center=(0.0, 0.0, 1.0), shape=shape, file=str(tmp_path / "wedge.stl"))
        scenario = scenarios[0].model_copy(update={"obstacles": (mesh,)})
        load = Bodies(bodies_of(scenario)[:1])
        return bool(load.holding(corner)[0])

    assert inside("box")
    assert not inside("hull")
