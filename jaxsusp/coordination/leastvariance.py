"""Least variance: of all ends that keep cables clear, the steadiest sequence (Eq. 20; spec §10).

Coarse to fine: dynamic programming is exact over the joint candidates of wide fans around the
drive mode's plain rule, then again over fans half as wide around the sequence found, and so on;
none of them raises Eq. 20. A running mean over the fans' angles rounds the kinks that remain,
where every limit allows it.
"""

import functools
from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Float, Int
from jaxsusp.coordination.fans import (
    Candidates,
    combinations,
    fan_ends,
    joint_candidates,
    offsets,
)
from jaxsusp.coordination.sequence import (
    Spread,
    best_constant,
    best_sequence,
    features,
    spread_of,
    step_costs,
    total_cost,
)
from jaxsusp.coordination.smoothing import WIDTHS, running_means, smoothed
from jaxsusp.errors import InputError, require, require_count
from jaxsusp.fitness import ends_at
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem import require_plannable
from jaxsusp.scenario import Scenario
from jaxsusp.vec3 import Vec3
from jaxsusp.world import World, build_world, cast_world

SLACKS = (0.0, 0.02, 0.05, 0.1, 0.2)
"""m by which the cables of candidates keep further off obstacles, tried in turn: a sequence whose
every step is clear may still touch something between two steps, and a smoothed one needs room."""


class Coordination(NamedTuple):
    """Ends for a load trajectory, or why there are none. Host arrays, float64 (m, N, rad)."""

    feasible: bool
    reason: str  # empty where feasible
    ends: Float[np.ndarray, "samples cables xyz"]
    lengths: Float[np.ndarray, "samples cables"]
    tensions: Float[np.ndarray, "samples cables"]
    cost: float  # Eq. 20 with the transitions, E and η of the widest fans
    candidates: Int[np.ndarray, "samples"]  # feasible joint candidates of every step
    angles: Float[np.ndarray, "cables samples 2"]  # heading, elevation from where the fans opened
    passes: int  # of dynamic programming, each over fans half as wide
    slack: float  # m that candidates kept further off than asked for
    smoothing: float  # standard deviation of the last running mean, in samples; 0: none


def moving_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"],
    fan: int = 9,
    angle_deg: float = 10.0,
    keep: int = 729,
    passes: int = 8,
    margin: float = 0.0,
) -> Coordination:
    """Ends that move with the load and keep the cables clear (cable avoidance, Sect. 3.3).

    The fans open around where the drive mode's plain rule puts the ends. The result is checked
    for contacts between the steps, with load and ends moving straight from step to step.

    Args:
        scenario: in a drive mode whose ends move.
        position: the load's centre along the trajectory (m), at least two steps.
        fan: candidates per cable and step: an odd square number, any odd one in mode "base".
        angle_deg: how far an end may turn from the plain rule to every side (degrees).
        keep: joint candidates that each step keeps: of least step cost, later nearest to the
            sequence found before. The default keeps all for three cables.
        passes: of dynamic programming, each over fans half as wide.
        margin: m that cables keep off obstacles beyond what is required, at and between steps.

    Raises:
        InputError: a drive mode or attachments whose ends do not move so, or fans too large.
    """
    if not moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "cable" keeps the ends where they are; give "end", "base" '
            'or "hybrid" to move them'
        )
    require_count("keep", keep)
    require_count("passes", passes)
    task = _task(scenario, position, fan, angle_deg, margin)
    keep = min(keep, len(task.choices))
    wide, means = np.deg2rad(angle_deg), running_means(len(task.position))
    scales = wide * 0.5 ** np.arange(passes)

    def attempt(slack: float) -> _Attempt:
        return _move(scenario.drive, keep, task, scales, means, np.float64(slack))

    return _smoothest(attempt, passes, WIDTHS[0])


def fixed_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"],
    fan: int = 9,
    angle_deg: float = 10.0,
    margin: float = 0.0,
) -> Coordination:
    """The one joint candidate of least cost that serves the whole trajectory (mode "cable").

    Its fans open around the given ends as seen from the trajectory's middle; arguments as in
    `moving_ends`. Fans may be wide: 25 candidates per cable within 30° take a second or two.
    """
    if moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" moves the ends; give "cable" to fix them'
        )
    task = _task(scenario, position, fan, angle_deg, margin)
    wide = np.deg2rad(angle_deg)

    def attempt(slack: float) -> _Attempt:
        return _stay(task, wide, np.float64(slack))

    return _smoothest(attempt, 1, 0.0)


class _Task(NamedTuple):
    """What the compiled programs are given."""

    world: World
    position: Array  # (samples, xyz)
    turns: Array  # (fan, 2), the widest 1
    choices: Array  # (joint, cables)
    margin: Array  # m


class _Found(NamedTuple):
    """A sequence, and what is wrong with it."""

    sequence: Candidates
    angles: Array
    cost: Array
    contacts: Array  # between steps
    fine: Array  # none of these, and all limits kept
    width: Array  # of the running mean


class _Outlook(NamedTuple):
    """What no choice changes."""

    counts: Array  # feasible joint candidates, (samples,)
    alive: Array  # there is a sequence of them
    load: Array  # contacts of the load itself


_Attempt = tuple[_Found, _Outlook]


def _task(scenario: Scenario, position, fan: int, angle_deg: float, margin: float) -> _Task:
    require_plannable(scenario)
    require_count("fan", fan)
    require(0 < angle_deg <= 90, f"angle_deg = {angle_deg:g}: give degrees from above 0 to 90")
    require(0 <= margin < np.inf, f"margin = {margin:g}: give a finite number of at least 0 m")
    where = np.asarray(position, np.float64)
    if where.ndim != 2 or where.shape[1] != 3 or len(where) < 2 or not np.isfinite(where).all():
        raise InputError(
            f"position of shape {where.shape}: give the load's way as (samples, 3) finite numbers"
        )
    choices = combinations(fan, len(scenario.robots))
    turns = offsets(scenario.drive, fan, 1.0)
    with jax.enable_x64(True):
        world = cast_world(build_world(scenario), jnp.float64)
    return _Task(world, where, turns, choices, np.float64(margin))


def _smoothest(attempt: Callable[[float], _Attempt], passes: int, widest: float) -> Coordination:
    """The smoothest of what more and more slack finds; stops where it cannot be smoother."""
    best = None
    with jax.enable_x64(True):
        for slack in SLACKS:
            found, outlook = jax.tree.map(np.asarray, attempt(slack))
            reason, width = _reason(found, outlook), float(found.width)
            made = Coordination(
                not reason, reason, found.sequence.ends, found.sequence.lengths,
                found.sequence.tensions, float(found.cost), outlook.counts, found.angles,
                passes, slack, width,
            )  # fmt: skip
            if best is None or (made.feasible, width) > (best.feasible, best.smoothing):
                best = made
            if not outlook.alive or outlook.load or (made.feasible and width == widest):
                break
    assert best is not None
    return best


def _reason(found: _Found, outlook: _Outlook) -> str:
    """Why a sequence will not do; empty if it will."""
    counts = outlook.counts
    if not counts.all():
        return (
            "no joint candidate is in reach, apart, in tension and clear at step "
            f"{np.argmin(counts > 0)} ({(counts == 0).sum()} of {len(counts)} steps)"
        )
    if not outlook.alive:
        return "no single joint candidate serves all steps"
    if outlook.load:
        return f"the load itself meets an obstacle ({outlook.load} contacts)"
    if not found.fine:
        return f"cables meet an obstacle between steps ({found.contacts} contacts)"
    return ""


class _State(NamedTuple):
    """What a pass of dynamic programming hands to the next."""

    angles: Array  # heading and elevation of the sequence so far, (cables, samples, 2) (rad)
    spread: Spread  # of the first, widest fans
    first: Array


@functools.partial(jax.jit, static_argnums=(0, 1))
def _move(drive: str, keep: int, task: _Task, scales, means, slack) -> _Attempt:
    """All passes, then the widest running mean that will do."""
    world, position = task.world, Vec3.from_array(task.position)
    plain, arms = ends_at(world, position, drive), drive != "base"
    samples, cables = len(task.position), world.cables

    def narrow(state: _State, scale):
        turns = state.angles[:, :, None] + scale * task.turns[None, None]
        turns = jnp.clip(turns, -scales[0], scales[0])
        joint = _judged(task, fan_ends(world, position, plain, turns), slack, arms)
        index, spread, total = _steadiest(features(joint, world.limits), joint, state, keep)
        picked = jnp.asarray(task.choices)[index].T
        angles = jnp.take_along_axis(turns, picked[..., None, None], axis=2)[:, :, 0]
        return _State(angles, spread, jnp.zeros((), bool)), (joint.feasible.sum(axis=1), total)

    nothing = Spread(jnp.zeros((samples, 1, 5 * cables)), jnp.zeros((samples, 1)))
    start = _State(jnp.zeros((cables, samples, 2)), nothing, jnp.ones((), bool))
    last, (counts, totals) = jax.lax.scan(narrow, start, scales)
    each = smoothed(world, position, plain, last.angles, means, task.margin, arms)
    which = jnp.where(each.fine.any(), jnp.argmax(each.fine), len(means) - 1)
    each = jax.tree.map(lambda leaf: leaf[which], each)
    values = features(each.sequence, world.limits)
    cost = total_cost(values, each.sequence.feasible, last.spread)
    width = jnp.asarray(WIDTHS)[which]
    found = _Found(each.sequence, each.angles, cost, each.contacts, each.fine, width)
    return found, _Outlook(counts[0], jnp.isfinite(totals[0]), _load_contacts(task))


def _steadiest(values: Array, joint: Candidates, state: _State, keep: int):
    """The joint candidate of every step, E and η, and what Eq. 20 comes to."""
    own = spread_of(values, joint.feasible)
    spread = jax.tree.map(lambda new, old: jnp.where(state.first, new, old), own, state.spread)
    cost = step_costs(values, joint.feasible, spread)
    middle = values.shape[1] // 2  # the sequence so far
    near = ((values - values[:, middle : middle + 1]) ** 2).sum(axis=-1)
    kept = jax.lax.top_k(-jnp.where(state.first | ~joint.feasible, cost, near), keep)[1]
    chosen, total = best_sequence(
        jnp.take_along_axis(values, kept[..., None], axis=1),
        jnp.take_along_axis(cost, kept, axis=1),
    )
    return jnp.take_along_axis(kept, chosen[:, None], axis=1)[:, 0], spread, total


@jax.jit
def _stay(task: _Task, wide, slack) -> _Attempt:
    """The best constant choice of fans that open as seen from the middle of the way."""
    world, position = task.world, Vec3.from_array(task.position)
    samples, cables, fan = len(task.position), world.cables, len(task.turns)
    middle = position.each(lambda c: c[samples // 2][None])
    turns = jnp.broadcast_to(wide * task.turns, (cables, 1, fan, 2))
    fans = fan_ends(world, middle, world.bodies.ends.each(lambda c: c[:, None]), turns)
    everywhere = fans.each(lambda c: jnp.broadcast_to(c, (cables, samples, fan)))
    joint = _judged(task, everywhere, slack, arms=True)
    index, total = best_constant(features(joint, world.limits), joint.feasible)
    sequence = jax.tree.map(lambda leaf: leaf[:, index], joint)
    ends = Vec3.from_array(sequence.ends[0])
    bodies = world.bodies._replace(
        ends=ends, cable_radius=world.bodies.cable_radius + task.margin
    )
    contacts = count_collisions(position, bodies, world.obstacles)
    picked = jnp.asarray(task.choices)[index]
    angles = jnp.take_along_axis(turns[:, 0], picked[:, None, None], axis=1)
    angles = jnp.broadcast_to(angles, (cables, samples, 2))
    found = _Found(sequence, angles, total, contacts, contacts == 0, jnp.zeros(()))
    return found, _Outlook(
        joint.feasible.sum(axis=1), jnp.isfinite(total), _load_contacts(task)
    )


def _judged(task: _Task, fans: Vec3, slack: Array, arms: bool) -> Candidates:
    """All joint candidates of fans, the cables kept off obstacles by all that is asked for."""
    bodies = task.world.bodies
    thick = bodies.cable_radius + bodies.clearance + task.margin + slack
    position = Vec3.from_array(task.position)
    return joint_candidates(task.world, position, fans, task.choices, thick, arms)


def _load_contacts(task: _Task) -> Array:
    """Contacts of the load alone: no ends cure them."""
    bodies = task.world.bodies
    bare = bodies._replace(ends=bodies.ends.each(lambda c: c[:0]))
    return count_collisions(Vec3.from_array(task.position), bare, task.world.obstacles)
