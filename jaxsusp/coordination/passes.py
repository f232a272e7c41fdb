"""The compiled programs of least variance: passes over fans, and constant choices.

Coarse to fine: dynamic programming is exact over the joint candidates of wide fans around the
drive mode's plain rule, then again over fans half as wide around the sequence found, and so on.
Each fan holds what it opens around, and E and η stay those of the first fans, so that no pass
raises Eq. 20. The angles are arrays: all passes share one program.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array
from jaxsusp.coordination.fans import Candidates, fan_ends, joint_candidates
from jaxsusp.coordination.sequence import (
    Spread,
    best_constant,
    best_sequence,
    features,
    spread_of,
    step_costs,
    total_cost,
)
from jaxsusp.coordination.smoothing import WIDTHS, smoothed
from jaxsusp.geometry.collisions import count_between
from jaxsusp.scenario.world import World
from jaxsusp.suspension.levelload import ends_at
from jaxsusp.vec3 import Vec3


class Task(NamedTuple):
    """What the compiled programs are given."""

    world: World
    position: Array  # (samples, xyz)
    turns: Array  # (fan, 2), the widest 1
    choices: Array  # (joint, cables)
    margin: Array  # m


class Found(NamedTuple):
    """A sequence, and what is wrong with it."""

    sequence: Candidates
    angles: Array
    cost: Array
    contacts: Array  # between steps
    fine: Array  # none of these, and all limits kept
    width: Array  # of the running mean


class Outlook(NamedTuple):
    """What no choice changes."""

    counts: Array  # feasible joint candidates, (samples,)
    costs: Array  # of the best sequence of them after every pass; inf: there is none
    load: Array  # contacts of the load itself


Attempt = tuple[Found, Outlook]


class _State(NamedTuple):
    """What a pass of dynamic programming hands to the next."""

    angles: Array  # heading and elevation of the sequence so far, (cables, samples, 2) (rad)
    spread: Spread  # of the first, widest fans
    first: Array


@functools.partial(jax.jit, static_argnums=(0, 1))
def move(drive: str, keep: int, task: Task, wide, scales, means, slack) -> Attempt:
    """All passes, then the widest running mean that will do."""
    world, position = task.world, Vec3.from_array(task.position)
    plain, arms = ends_at(world, position, drive), drive != "base"
    samples, cables = len(task.position), world.cables
    thick = _thickness(task) + slack

    def narrow(state: _State, scale):
        turns = state.angles[:, :, None] + scale * task.turns[None, None]
        turns = jnp.clip(turns, -wide, wide)
        fans = fan_ends(world, position, plain, turns)
        joint = joint_candidates(world, position, fans, task.choices, thick, arms)
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
    found = Found(each.sequence, each.angles, cost, each.contacts, each.fine, width)
    return found, Outlook(counts[0], totals, _load_contacts(task))


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
def stay(task: Task, wide, slack) -> Attempt:
    """The best constant choice of fans that open as seen from the middle of the way."""
    world, position = task.world, Vec3.from_array(task.position)
    samples, cables, fan = len(task.position), world.cables, len(task.turns)
    thick = _thickness(task) + slack
    middle = position.each(lambda c: c[samples // 2][None])
    turns = jnp.broadcast_to(wide * task.turns, (cables, 1, fan, 2))
    fans = fan_ends(world, middle, world.bodies.ends.each(lambda c: c[:, None]), turns)
    everywhere = fans.each(lambda c: jnp.broadcast_to(c, (cables, samples, fan)))
    joint = joint_candidates(world, position, everywhere, task.choices, thick, arms=True)
    index, total = best_constant(features(joint, world.limits), joint.feasible)
    sequence = jax.tree.map(lambda leaf: leaf[:, index], joint)
    ends = Vec3.from_array(sequence.ends[0])
    bodies = world.bodies._replace(ends=ends, cable_radius=world.bodies.cable_radius + task.margin)
    contacts = count_between(position, bodies, world.obstacles)
    picked = jnp.asarray(task.choices)[index]
    angles = jnp.take_along_axis(turns[:, 0], picked[:, None, None], axis=1)
    angles = jnp.broadcast_to(angles, (cables, samples, 2))
    found = Found(sequence, angles, total, contacts, contacts == 0, jnp.zeros(()))
    return found, Outlook(joint.feasible.sum(axis=1), total[None], _load_contacts(task))


def _thickness(task: Task) -> Array:
    """How far the middle of a cable is to keep off obstacles (m)."""
    bodies = task.world.bodies
    return bodies.cable_radius + bodies.clearance + task.margin


def _load_contacts(task: Task) -> Array:
    """Contacts of the load alone: no ends cure them."""
    bodies = task.world.bodies
    bare = bodies._replace(ends=bodies.ends.each(lambda c: c[:0]))
    return count_between(Vec3.from_array(task.position), bare, task.world.obstacles)
