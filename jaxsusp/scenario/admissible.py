"""Can a task be carried out at all?  The checks of a scenario that no single field can make.

They ask for what is necessary, not for what suffices: that rows belong together, that every end
is in its robot's reach, and that at start and goal the load hangs inside its workspace, below and
between the ends, clear of the warning area with all its cables.
"""

from collections.abc import Iterator
from itertools import combinations
from math import dist

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.geometry.collisions import Bodies, count_collisions
from jaxsusp.geometry.obstacles import KINDS
from jaxsusp.mechanics.arm import reach, reachable, shoulder_distance
from jaxsusp.mechanics.posture.graspmap import rank
from jaxsusp.scenario.messages import numbered, sentence
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.world import World, attachments_of, build_world
from jaxsusp.vec3 import Vec3

_count = jax.jit(count_collisions)


def inadmissible(scenario: Statement) -> list[str]:
    """What makes a scenario unusable, one line per problem; empty for an admissible one."""
    checks = (_unreachable, _crowded, _outside, _not_below, _not_between, _in_contact)
    contradictions = [*_contradictory(scenario)] or [*_never_level(scenario)]
    return contradictions or [line for check in checks for line in check(scenario)]


def _contradictory(scenario: Statement) -> Iterator[str]:
    """An inside-out workspace, and lists without one entry per robot."""
    corners = zip(scenario.workspace.lower, scenario.workspace.upper, strict=True)
    for i, (low, high) in enumerate(corners):
        if low >= high:
            wrong = f"must be greater than workspace.lower[{i}] = {low:g}"
            yield sentence(f"workspace.upper[{i}]", high, wrong, "give the corners in m")

    robots = len(scenario.robots)
    attachments, joints = scenario.payload.attachments, scenario.limits.joint_limits_deg
    if attachments != "hook" and len(attachments) != robots:
        wrong = f"has {len(attachments)} entries for {robots} robots"
        remedy = 'give one [x, y, z] per robot, or "hook"'
        yield sentence("payload.attachments", attachments, wrong, remedy)
    if joints is not None and len(joints) not in (1, robots):
        wrong = f"has {len(joints)} entries for {robots} robots"
        remedy = "give three [low, high] pairs per robot, or once for all"
        yield sentence("limits.joint_limits_deg", joints, wrong, remedy)


def _never_level(scenario: Statement) -> Iterator[str]:
    """Attachments from which the load cannot hang as planned, wherever it is."""
    payload = scenario.payload
    if payload.attachments == "hook":
        x, y, z = payload.center_of_mass
        if x != 0 or y != 0 or z >= payload.height / 2:
            wrong = "is not straight below the hook, so the load would tilt or turn over"
            remedy = "give [0, 0, z] below half the height, or one attachment per cable"
            yield sentence("payload.center_of_mass", payload.center_of_mass, wrong, remedy)
    elif (found := rank(np.array(payload.attachments))) < 6:
        line = "on one line" if found > 3 else "at one point"
        wrong = f"are all {line}, about which nothing holds the load"
        yield sentence(
            "payload.attachments", payload.attachments, wrong, 'spread them, or give "hook"'
        )


def _unreachable(scenario: Statement) -> Iterator[str]:
    """Ends that their robot's arm cannot hold."""
    rows = [(robot.base, robot.links, robot.end) for robot in scenario.robots]
    with jax.enable_x64(True):
        base, links, end = map(jnp.array, zip(*rows, strict=True))
        found = reachable(base, links, end), shoulder_distance(base, links, end), *reach(links)
        held, distance, nearest, farthest = map(np.asarray, found)
    for k, robot in enumerate(scenario.robots):
        if not held[k]:
            wrong = (
                f"is out of reach: {distance[k]:.4g} m from the shoulder, and the arm reaches "
                f"{nearest[k]:.4g} to {farthest[k]:.4g} m"
            )
            remedy = "move the end or the base, or change the links"
            yield sentence(f"robots[{k}].end", robot.end, wrong, remedy)


def _crowded(scenario: Statement) -> Iterator[str]:
    """Ends that are too close to each other."""
    least = scenario.limits.separation
    for (j, one), (k, other) in combinations(enumerate(scenario.robots), 2):
        if (distance := dist(one.end, other.end)) < least:
            wrong = (
                f"is {distance:.4g} m from robots[{j}].end, less than "
                f"limits.separation = {least:g} m"
            )
            yield sentence(f"robots[{k}].end", other.end, wrong, "move them apart")


def _outside(scenario: Statement) -> Iterator[str]:
    """A start or goal outside the workspace."""
    box = scenario.workspace
    for place, point in _places(scenario):
        for i, low, high in zip(range(3), box.lower, box.upper, strict=True):
            if not low <= point[i] <= high:
                wrong = f"is outside the workspace, whose {'xyz'[i]} is {low:g} to {high:g} m"
                yield sentence(f"{place}[{i}]", point[i], wrong, "move it inside")


def _not_below(scenario: Statement) -> Iterator[str]:
    """A start or goal at which a cable would not pull upwards."""
    offsets = attachments_of(scenario)
    for place, point in _places(scenario):
        for k, robot in enumerate(scenario.robots):
            if (height := point[2] + offsets[k, 2]) >= robot.end[2]:
                wrong = (
                    f"puts the lower end of the cable of robots[{k}] at z = "
                    f"{height:g} m, not below the upper end at z = {robot.end[2]:g} m"
                )
                yield sentence(place, point, wrong, "lower it or raise the end")


def _not_between(scenario: Statement) -> Iterator[str]:
    """A start or goal at which no pulling cables can carry the load, seen from above."""
    payload, ends = scenario.payload, np.array([robot.end for robot in scenario.robots])
    hook = payload.attachments == "hook"
    offset = (0.0, 0.0, 0.0) if hook else payload.center_of_mass
    for place, point in _places(scenario):
        if not _surrounded(np.add(point, offset)[:2], ends[:, :2]):
            body = "hook" if hook else "centre of mass"
            wrong = f"puts the {body} outside the polygon of the cables' ends, seen from above"
            yield sentence(place, point, wrong, "move it or the ends")


def _surrounded(point: np.ndarray, corners: np.ndarray) -> bool:
    """Whether a point (2,) is inside the convex hull of corners (n, 2), not on its boundary.

    It is iff no two neighbouring directions towards the corners are half a turn apart or more.
    """
    rays = corners - point
    rays = rays[rays.any(axis=1)]  # a corner at the point itself surrounds nothing
    if not len(rays):
        return False
    angles = np.sort(np.arctan2(rays[:, 1], rays[:, 0]))
    gaps = np.diff(angles, append=angles[0] + 2 * np.pi)
    return bool(gaps.max() < np.pi)


def _in_contact(scenario: Statement) -> Iterator[str]:
    """A start or goal at which the load or a cable is in an obstacle's warning area."""
    for i, obstacle in enumerate(scenario.obstacles):
        warning_area = f"the warning area of {numbered('obstacles', i, obstacle.name)}"
        alone = scenario.model_copy(update={"obstacles": (obstacle,)})
        load, *cables = _contacts(build_world(alone, counts=[1] * len(KINDS)))
        for at, (place, point) in enumerate(_places(scenario)):
            if load[at]:
                wrong = f"puts the load into {warning_area}"
                yield sentence(place, point, wrong, "move it or the obstacle")
                continue  # its cables are in there too
            for k, cable in enumerate(cables):
                if cable[at]:
                    wrong = f"puts the cable of robots[{k}] into {warning_area}"
                    yield sentence(place, point, wrong, "move it, the end or the obstacle")


def _contacts(world: World) -> Iterator[np.ndarray]:
    """Whether the load, then each cable, touches an obstacle: at rest at (start, goal).

    The very count that the fitness uses, of a motion that stays where it is, one body at a time.
    """

    def count(bodies: Bodies) -> np.ndarray:
        with jax.enable_x64(True):
            places = zip(world.start, world.goal, strict=True)
            still = Vec3(*(jnp.array([pair, pair]) for pair in places))
            return np.asarray(_count(still, bodies, world.obstacles))

    def keep_cables(rows: slice) -> Bodies:
        shared = world.bodies.attachments.x.shape[0] == 1
        attachments = world.bodies.attachments.each(lambda c: c if shared else c[rows])
        ends = world.bodies.ends.each(lambda c: c[rows])
        return world.bodies._replace(attachments=attachments, ends=ends)

    load = count(keep_cables(slice(0, 0)))
    yield load > 0
    for k in range(world.cables):
        yield count(keep_cables(slice(k, k + 1))) > load


def _places(scenario: Statement) -> Iterator[tuple[str, tuple[float, float, float]]]:
    yield "task.start", scenario.task.start
    yield "task.goal", scenario.task.goal
