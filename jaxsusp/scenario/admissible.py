"""Can a task be carried out at all?  The checks of a scenario that no single field can make.

They ask for what is necessary, not for what suffices: that rows belong together, that every end
is in its robot's reach, and that at start and goal the load hangs inside its workspace, below and
between the ends, clear of the warning area with all its cables.
"""

from collections.abc import Iterator
from itertools import combinations
from math import dist
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.geometry.collisions import Bodies, count_collisions
from jaxsusp.geometry.contacts import segments_clear
from jaxsusp.geometry.meshes import MeshError, bounding_box
from jaxsusp.mechanics.arm import reach, shoulder_distance
from jaxsusp.mechanics.posture.graspmap import rank
from jaxsusp.scenario.messages import numbered, sentence
from jaxsusp.scenario.models import Statement
from jaxsusp.scenario.ownunits import TOUCH, frame_of, in_own_units
from jaxsusp.scenario.world import (
    World,
    attachments_of,
    build_world,
    one_at_a_time,
    warning_shape,
)
from jaxsusp.vec3 import Vec3

_count = jax.jit(count_collisions)
_clear = jax.jit(segments_clear)


def inadmissible(scenario: Statement) -> tuple[list[str], list[str]]:
    """What makes a scenario unusable and what its task, one line per problem; empty: nothing."""
    for doubt in (_contradictory, _out_of_scale, _indivisible, _never_level):
        if contradictions := [*doubt(scenario)]:
            return contradictions, []
    checks = (_namesakes, _unreachable, _crowded, _ends_on_ground, _columns_blocked)
    problems, troubles = [line for check in checks for line in check(scenario)], misplaced(scenario)
    if found := problems or troubles:  # of which a mesh in another unit may be the cause
        found[:0] = _of_another_unit(scenario, DOUBTFUL)
    return problems, troubles


def misplaced(scenario: Statement) -> list[str]:
    """What makes start and goal unusable, one line per problem, which begins with the place."""
    checks = (_outside, _not_below, _not_between, _on_ground, _in_contact)
    return [line for check in checks for line in check(scenario)]


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


def _namesakes(scenario: Statement) -> Iterator[str]:
    """Obstacles of one name: what is told of the one would be taken for the other."""
    first: dict[str, int] = {}
    for i, obstacle in enumerate(scenario.obstacles):
        if obstacle.name and (j := first.setdefault(obstacle.name, i)) != i:
            remedy = "give each obstacle a name of its own, or none"
            yield sentence(
                f"obstacles[{i}].name", obstacle.name, f"is also the name of obstacles[{j}]", remedy
            )


SMALL, LOAD, DOUBTFUL, OBSTACLE = 1e-3, 1.0, 2.0, 20.0
"""Sizes of a mesh, in largest sides of the workspace, beyond which its unit is doubted: of any, too
small; of a load, too large; of an obstacle, where there are other faults, and whatever else."""

UNITS = {0.001: "millimetres", 0.01: "centimetres", 0.0254: "inches", 1.0: "metres"}
"""Units of mesh files, by their scale."""


def _out_of_scale(scenario: Statement) -> Iterator[str]:
    """Meshes whose unit is not the one that their scale is for."""
    load = scenario.payload
    if load.file is not None:
        size = bounding_box(load.file, load.scale or 1.0)
        yield from _doubted(scenario, "payload", load.scale or 1.0, size, LOAD)
    yield from _of_another_unit(scenario, OBSTACLE)


def _of_another_unit(scenario: Statement, beyond: float) -> Iterator[str]:
    for i, each in enumerate(scenario.obstacles):
        if each.kind == "mesh":
            name = numbered("obstacles", i, each.name)
            yield from _doubted(scenario, name, each.scale, each.size, beyond)


def _doubted(
    scenario: Statement, table: str, scale: float, size: Any, beyond: float
) -> Iterator[str]:
    """A mesh that is too small, or larger than so many times the workspace."""
    across = float(max(size))
    share = across / float(max(np.subtract(scenario.workspace.upper, scenario.workspace.lower)))
    if SMALL <= share <= beyond:
        return
    wrong = f"makes it {across:.3g} m across, {share:.2g} times the workspace"
    remedy = "give the factor from its unit to metres, 1 for metres, 0.001 for millimetres"
    for unit in sorted(UNITS, reverse=share < SMALL) if scale in UNITS else ():
        if unit != scale and SMALL <= share * unit / scale <= min(beyond, DOUBTFUL):
            wrong += f": is the file in {UNITS[unit]}?"
            remedy = f"give scale = {unit:g}, or the factor to metres"
            break
    yield sentence(f"{table}.scale", scale, wrong, remedy)


def _indivisible(scenario: Statement) -> Iterator[str]:
    """Meshes in whose place no convex bodies are found."""
    for i, each in enumerate(scenario.obstacles):
        if each.kind != "mesh":
            continue
        try:
            _ = each.bodies
        except MeshError as error:
            wrong = f"cannot be used ({error.problem})"
            remedy = error.remedy or 'give shape = "box"'
            field = f"{numbered('obstacles', i, each.name)}.file"
            yield sentence(field, each.path.name, wrong, remedy)


def _unreachable(scenario: Statement) -> Iterator[str]:
    """Ends that their robot's arm cannot hold."""
    own, frame = in_own_units(scenario)
    rows = [(robot.base, robot.links, robot.end) for robot in own.robots]
    with jax.enable_x64(True):
        base, links, end = map(jnp.array, zip(*rows, strict=True))
        found = np.array([shoulder_distance(base, links, end), *reach(links)])
    missed = np.maximum(found[1] - found[0], found[0] - found[2])
    distance, nearest, farthest = frame.number(found, "m")
    for k, robot in enumerate(scenario.robots):
        if not missed[k] <= TOUCH:
            wrong = (
                f"is out of reach: {distance[k]:.4g} m from the shoulder, and the arm reaches "
                f"{nearest[k]:.4g} to {farthest[k]:.4g} m"
            )
            remedy = "move the end or the base, or change the links"
            yield sentence(f"robots[{k}].end", robot.end, wrong, remedy)


def _crowded(scenario: Statement) -> Iterator[str]:
    """Ends that are too close to each other."""
    least, length = scenario.limits.separation, frame_of(scenario).length
    for (j, one), (k, other) in combinations(enumerate(scenario.robots), 2):
        if (distance := dist(one.end, other.end)) < least - TOUCH * length:
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
                remedy = "move it inside"
                if "workspace" not in scenario.model_fields_set:
                    remedy += ", or give a [workspace] table, which was left out"
                yield sentence(f"{place}[{i}]", point[i], wrong, remedy)


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


def _on_ground(scenario: Statement) -> Iterator[str]:
    """A start or goal in the workspace at which the load is in the ground, or too near to it."""
    bottom = scenario.workspace.lower[2]
    places = [(place, point) for place, point in _places(scenario) if point[2] >= bottom]
    return _grounded(scenario, places, warning_shape(scenario).half_height, "load")


def _ends_on_ground(scenario: Statement) -> Iterator[str]:
    """Ends from which a cable would hang in the ground."""
    ends = ((f"robots[{k}].end", robot.end) for k, robot in enumerate(scenario.robots))
    return _grounded(scenario, ends, warning_shape(scenario).cable_radius, "cable")


def _columns_blocked(scenario: Statement) -> Iterator[str]:
    """Obstacles that stand where a robot's column does; bases that roll may leave them."""
    own = in_own_units(scenario)[0]
    if scenario.drive == "base" or not own.obstacles:
        return
    for i, obstacle in enumerate(own.obstacles):
        alone = own.model_copy(update={"obstacles": (obstacle,)})
        with jax.enable_x64(True):
            world = build_world(alone, counts=one_at_a_time(alone))
            wide = jnp.asarray(world.robots.radius)[:, 0] + world.bodies.clearance
            foot = Vec3.from_array(jnp.asarray(world.robots.base))
            clear = _clear(foot, world.robots.shoulder, wide, world.obstacles)
        for k in np.flatnonzero(~np.asarray(clear)):
            name = numbered("obstacles", i, obstacle.name)
            wrong = f"puts the column of the robot into the warning area of {name}"
            yield sentence(f"robots[{k}].base", scenario.robots[k].base, wrong, "move either")


def _grounded(scenario: Statement, places, below: float, what: str) -> Iterator[str]:
    if (ground := scenario.ground_height) is None:
        return
    least, touch = ground + below + scenario.limits.clearance, TOUCH * frame_of(scenario).length
    for place, point in places:
        if point[2] < least - touch:
            wrong = f"puts the {what} into the warning area of the ground at z = {ground:g} m"
            yield sentence(
                place, point, wrong, f'give a z of {least:g} or more, or ground = "none"'
            )


def _in_contact(scenario: Statement) -> Iterator[str]:
    """A start or goal at which the load or a cable is in an obstacle's warning area."""
    own = in_own_units(scenario)[0]
    for i, obstacle in enumerate(own.obstacles):
        warning_area = f"the warning area of {numbered('obstacles', i, obstacle.name)}"
        alone = own.model_copy(update={"obstacles": (obstacle,)})
        load, *cables = _contacts(build_world(alone, counts=one_at_a_time(alone)))
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
