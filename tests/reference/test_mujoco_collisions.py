"""Collision counts against MuJoCo: of loads at rest, and of whole polylines.

A load at rest has as many contacts as MuJoCo finds. On a moving load the count misses none that
MuJoCo finds at any of many instants. A polyline with a count of zero is clear at every instant;
here MuJoCo looks in two ways.

*True distances.* Payload cylinder and cables, capsules from the hook to their ends, against the
obstacles: where the count is zero, every distance must exceed the clearance. Only this direction
holds, for the warning areas of the count have sharp edges where a distance rounds them, and its
cables are swept.

*Warning areas.* The payload's centre and the cables' axes against the obstacles inflated as the
model prescribes: of the polylines that are clear at all these instants the count must accept
most, for a count that refuses everything is sound as well.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from mujoco_scene import KINDS, Scene, packed

import jaxsusp as js
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.problem.fitness import trajectory
from jaxsusp.scenario.models import Box, Cylinder, Sphere
from jaxsusp.scenario.world import World, build_world, cast_world
from jaxsusp.vec3 import Vec3

INSTANTS = {"true distances": 240, "warning areas": 2000}  # least number per polyline
ROUNDING = 1e-6  # m, of MuJoCo's float32 box meshes
THIN = 1e-4  # m, stands for no radius
SPREADS = (0.03, 0.1, 0.3)  # m, standard deviations of the waypoints about a good trajectory
PER_SPREAD = 80
MOVES = 600  # single segments past one obstacle
ANYWHERE = 60  # trajectories through uniformly random waypoints


class TrueDistances:
    """Payload and cables themselves, at more than the clearance from the obstacles."""

    name = "true distances"

    def __init__(self, scenario: js.Scenario):
        payload, limits = scenario.payload, scenario.limits
        self.scene = Scene(scenario.obstacles, limits.cable_radius, payload.radius, payload.height)
        self.hook = np.array([0.0, 0.0, payload.height / 2])
        self.ends = [np.array(robot.end) for robot in scenario.robots]
        self.least = limits.clearance - ROUNDING

    def clear_at(self, position: np.ndarray) -> bool:
        """Whether a load at this position keeps clear."""
        scene, limit = self.scene, 2 * self.least
        scene.place_payload(position)
        if any(scene.payload_distance(i, limit) <= self.least for i in range(scene.count)):
            return False
        for end in self.ends:
            scene.place_capsule(position + self.hook, end)
            if any(scene.capsule_distance(i, limit) <= self.least for i in range(scene.count)):
                return False
        return True


class WarningAreas:
    """The payload's centre and the cables' axes, outside obstacles inflated for them."""

    name = "warning areas"

    def __init__(self, scenario: js.Scenario, obstacles: Sequence | None = None):
        obstacles = scenario.obstacles if obstacles is None else obstacles
        payload, limits = scenario.payload, scenario.limits
        wide = payload.radius + limits.clearance
        tall = payload.height / 2 + limits.clearance
        thin = limits.cable_radius + limits.clearance
        for_payload = [inflated(o, wide, tall, turned_round=True) for o in obstacles]
        for_cables = [inflated(o, thin, thin, turned_round=False) for o in obstacles]
        self.for_payload, self.for_cables = Scene(for_payload, THIN), Scene(for_cables, THIN)
        self.hook = np.array([0.0, 0.0, payload.height / 2])
        self.ends = [np.array(robot.end) for robot in scenario.robots]

    def clear_at(self, position: np.ndarray) -> bool:
        """Whether a load at this position keeps clear."""
        return all(distance > ROUNDING for distance in self.distances(position))

    def distances(self, position: np.ndarray) -> Iterator[float]:
        """Signed distances of the payload, then of each cable, to every obstacle (m)."""
        hook = position + self.hook
        axes = [(self.for_payload, position, position)]
        for scene, a, b in axes + [(self.for_cables, hook, end) for end in self.ends]:
            scene.place_capsule(a, b)
            for obstacle in range(scene.count):
                yield scene.capsule_distance(obstacle, 1.0) + THIN


def inflated(obstacle, aside: float, above: float, turned_round: bool):
    """The obstacle wider by `aside` all round and by `above` at top and bottom.

    A sphere becomes a cylinder about the payload, which is one (`turned_round`).
    """
    match obstacle.kind:
        case "box":
            size = np.add(obstacle.size, [2 * aside, 2 * aside, 2 * above])
            return Box(center=obstacle.center, size=tuple(size), yaw_deg=obstacle.yaw_deg)
        case "cylinder":
            return Cylinder(
                center=obstacle.center,
                radius=obstacle.radius + aside,
                height=obstacle.height + 2 * above,
            )
        case "sphere" if turned_round:
            return Cylinder(
                center=obstacle.center,
                radius=obstacle.radius + aside,
                height=2 * (obstacle.radius + above),
            )
        case "sphere":
            return Sphere(center=obstacle.center, radius=obstacle.radius + aside)


class Verdicts(NamedTuple):
    """What MuJoCo saw of many polylines."""

    clear_at_samples: np.ndarray
    clear: np.ndarray  # between the samples as well


def judge(witness, polylines: np.ndarray) -> Verdicts:
    """Look at many instants of polylines, (polylines, samples, xyz)."""
    between = -(-INSTANTS[witness.name] // (polylines.shape[1] - 1))
    fractions = np.arange(1, between)[:, None] / between
    at_samples, everywhere = [], []
    for polyline in polylines:
        start, step = polyline[:-1, None], np.diff(polyline, axis=0)[:, None]
        inner = (start + fractions * step).reshape(-1, 3)
        at_samples.append(all(map(witness.clear_at, polyline)))
        everywhere.append(at_samples[-1] and all(map(witness.clear_at, inner)))
    return Verdicts(np.array(at_samples), np.array(everywhere))


class Case(NamedTuple):
    """A scenario and the waypoints of trajectories near a good one and anywhere."""

    scenario: js.Scenario
    waypoints: np.ndarray  # (candidates, dim)


def turned(scenario: js.Scenario) -> js.Scenario:
    """The same scenario with every box turned by an angle of its own."""
    content = scenario.model_dump()
    for index, obstacle in enumerate(content["obstacles"]):
        if obstacle["kind"] == "box":
            obstacle["yaw_deg"] = 25.0 + 20.0 * index
    return js.Scenario.model_validate(content | {"name": f"{scenario.name} with turned boxes"})


@pytest.fixture(scope="module", params=[lambda scenario: scenario, turned], ids=["as is", "turned"])
def case(request, scenarios) -> Case:
    scenario = request.param(scenarios[0])
    problem = js.Problem.from_scenario(scenario, search="box")
    good = js.minimize(problem, js.pso(), runs=4, iterations=150).best
    assert problem.terms(good).collisions == 0

    rng = np.random.default_rng(3)
    near = [good + spread * rng.normal(size=(PER_SPREAD, problem.dim)) for spread in SPREADS]
    anywhere = rng.uniform(problem.lower, problem.upper, (ANYWHERE, problem.dim))
    return Case(scenario, np.clip(np.vstack([*near, anywhere]), problem.lower, problem.upper))


def world_of(scenario: js.Scenario) -> World:
    return cast_world(build_world(scenario), np.float64)


def test_a_load_at_rest_has_the_contacts_that_mujoco_finds(case):
    workspace = case.scenario.workspace
    rng = np.random.default_rng(4)
    positions = rng.uniform(workspace.lower, workspace.upper, (4000, 3))
    witness = WarningAreas(case.scenario)
    distances = np.array([list(witness.distances(position)) for position in positions])
    told = (np.abs(distances) > ROUNDING).all(axis=1) & (distances != THIN).all(axis=1)

    world = world_of(case.scenario)
    twice = Vec3.from_array(jnp.asarray(np.stack([positions, positions])))
    ours = np.asarray(jax.jit(count_collisions)(twice, world.bodies, world.obstacles))
    theirs = (distances < 0).sum(axis=1)
    print(
        f"\n{case.scenario.name}: {told.sum()} loads at rest, {(theirs[told] > 0).mean():.0%}"
        f" collide, with up to {theirs.max()} contacts; {(ours != theirs)[told].sum()} differ"
    )
    assert told.mean() > 0.99
    assert 0.2 < (theirs[told] > 0).mean() < 0.8
    np.testing.assert_array_equal(ours[told], theirs[told])


def draw_obstacle(kind: str, center: np.ndarray, rng):
    size = [float(n) for n in 10 ** rng.uniform(-1.3, -0.5, 3)]  # 0.05 m to 0.3 m
    match kind:
        case "box":
            return Box(center=tuple(center), size=tuple(size), yaw_deg=rng.uniform(-180, 180))
        case "cylinder":
            return Cylinder(center=tuple(center), radius=size[0] / 2, height=size[1])
        case "sphere":
            return Sphere(center=tuple(center), radius=size[0] / 2)


def draw_moves(kind: str, scenario: js.Scenario, rng) -> tuple[list, np.ndarray]:
    """Obstacles near a cable or the load, and the two ends of a straight motion past each."""
    hook = np.array([0.0, 0.0, scenario.payload.height / 2])
    obstacles, moves = [], []
    for _ in range(MOVES):
        start = rng.uniform(scenario.workspace.lower, scenario.workspace.upper)
        step = rng.normal(size=3)
        step *= rng.uniform(0.1, 1.5) / np.linalg.norm(step)
        end = np.array(scenario.robots[rng.integers(3)].end)
        beside = start + rng.uniform() * step + hook
        center = beside + rng.uniform(0, 0.9) * (end - beside) + rng.normal(scale=0.15, size=3)
        obstacles.append(draw_obstacle(kind, center, rng))
        moves.append([start, start + step])
    return obstacles, np.array(moves)


@pytest.mark.parametrize("kind", KINDS)
def test_no_contact_of_a_moving_load_is_missed(scenarios, kind):
    scenario = scenarios[0]
    obstacles, moves = draw_moves(kind, scenario, np.random.default_rng([5, KINDS.index(kind)]))
    fractions = np.linspace(0, 1, 101)[:, None]
    distances = []  # of payload and cables at every instant, (moves, instants, bodies)
    for obstacle, (start, stop) in zip(obstacles, moves, strict=True):
        witness = WarningAreas(scenario, [obstacle])
        instants = start + fractions * (stop - start)
        distances.append([list(witness.distances(position)) for position in instants])
    met = np.array(distances) < -ROUNDING
    theirs = met.any(axis=1).sum(axis=1)
    between = (met.any(axis=1) & ~met[:, [0, -1]].any(axis=1)).sum()

    world = world_of(scenario)
    one_each = jax.tree.map(lambda *o: np.stack(o), *(packed(kind, [o]) for o in obstacles))
    count = jax.jit(jax.vmap(lambda move, o: count_collisions(move, world.bodies, o)))
    ours = np.asarray(count(Vec3.from_array(jnp.asarray(moves)), one_each))
    print(
        f"\n{kind}: {len(moves)} moves, {theirs.sum()} contacts, {between} of them only between"
        f" the samples; counted {ours.sum()}, of which {(ours - theirs).sum()} are none;"
        f" {(ours[theirs == 0] == 0).mean():.0%} of {(theirs == 0).sum()} clear moves accepted"
    )
    assert (ours >= theirs).all(), np.flatnonzero(ours < theirs)
    assert between > 40, "nothing here would tell a check of samples apart"
    assert (ours[theirs == 0] == 0).mean() > 0.6


@pytest.mark.parametrize(
    ("samples", "least_share", "least_tunnels"), [(40, 0.9, 1), (20, 0.7, 10)], ids=["40", "20"]
)
def test_a_count_of_zero_is_clear_at_every_instant(case, samples, least_share, least_tunnels):
    world = world_of(case.scenario)
    position = trajectory(world, jnp.asarray(case.waypoints.T), samples)
    accepted = np.asarray(jax.jit(count_collisions)(position, world.bodies, world.obstacles)) == 0
    polylines = np.moveaxis(np.asarray(position.to_array()), 1, 0)
    true, areas = (judge(w(case.scenario), polylines) for w in (TrueDistances, WarningAreas))
    tunnels = true.clear_at_samples & ~true.clear
    share_true, share_areas = (accepted[each.clear].mean() for each in (true, areas))
    print(
        f"\n{case.scenario.name}, {samples} samples: {accepted.sum()} of {len(accepted)} polylines"
        f" accepted; {share_areas:.0%} of {areas.clear.sum()} outside the warning areas and"
        f" {share_true:.0%} of {true.clear.sum()} at more than the clearance;"
        f" {tunnels.sum()} collide between their samples only"
    )

    assert not (accepted & ~true.clear).any(), np.flatnonzero(accepted & ~true.clear)
    assert not (accepted & ~areas.clear).any(), np.flatnonzero(accepted & ~areas.clear)
    assert accepted.sum() >= 40
    assert (~true.clear).sum() >= 40
    assert tunnels.sum() >= least_tunnels, "nothing here would tell a check of samples apart"
    assert share_areas >= least_share
