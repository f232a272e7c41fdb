"""Least variance: of all ends that keep cables clear, the steadiest sequence (Eq. 20; spec §10).

With E^ξ the mean over the η feasible joint candidates of step ξ, the sequence chosen minimises

    Σ_ξ [ Σ_q (Γ_q - E_q^ξ)² / (s_q² (η_ξ - 1)) + Σ_q (ΔΓ_q)² / s_q² ],

q over the coordinates of the ends, the tensions and the lengths, s = 1 m, T_hi - T_lo and
l_max - l_min: the paper's variance (its square belongs inside the sum) as the cost of a step,
smoothness as the cost of a transition. Dynamic programming solves it exactly.
"""

import functools
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.coordination.fans import (
    Candidates,
    combinations,
    fan_ends,
    joint_candidates,
    offsets,
)
from jaxsusp.errors import InputError, require_count
from jaxsusp.fitness import ends_at
from jaxsusp.geometry.collisions import count_collisions
from jaxsusp.mechanics.drives import moving
from jaxsusp.problem import require_plannable
from jaxsusp.scenario import Scenario
from jaxsusp.vec3 import Vec3
from jaxsusp.world import World, build_world, cast_world

SLACKS = (0.0, 0.02, 0.05, 0.1, 0.2)
"""m by which the cables of candidates keep further off obstacles, tried in turn: a sequence whose
every step is clear may still touch something between two steps."""


class Coordination(NamedTuple):
    """Ends for a load trajectory, or why there are none. Host arrays, float64 (m, N)."""

    feasible: bool
    reason: str  # empty where feasible
    ends: Float[np.ndarray, "samples cables xyz"]
    lengths: Float[np.ndarray, "samples cables"]
    tensions: Float[np.ndarray, "samples cables"]
    cost: float  # of Eq. 20 with the transitions
    candidates: Int[np.ndarray, "samples"]  # feasible joint candidates of every step


def moving_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"],
    fan: int = 9,
    angle_deg: float = 10.0,
    keep: int = 300,
) -> Coordination:
    """Ends that move with the load and keep the cables clear (cable avoidance, Sect. 3.3).

    The fans open around where the drive mode's plain rule puts the ends. The result is checked
    for contacts between the steps, with load and ends moving straight from step to step.

    Args:
        scenario: in a drive mode whose ends move.
        position: the load's centre along the trajectory (m), at least two steps.
        fan: candidates per cable and step: a square number, any in mode "base".
        angle_deg: how far a fan opens to every side (degrees).
        keep: joint candidates of least step cost that each step keeps.

    Raises:
        InputError: a drive mode or attachments whose ends do not move so, or fans too large.
    """
    if not moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "cable" keeps the ends where they are; give "end", "base" '
            'or "hybrid" to move them'
        )
    return _coordinate(scenario, position, fan, angle_deg, keep)


def fixed_ends(
    scenario: Scenario,
    position: Float[Array, "samples xyz"],
    fan: int = 9,
    angle_deg: float = 10.0,
) -> Coordination:
    """The one joint candidate of least cost that serves the whole trajectory (mode "cable").

    Its fans open around the given ends as seen from the trajectory's middle; arguments as in
    `moving_ends`.
    """
    if moving(scenario.drive):
        raise InputError(
            f'{scenario.name}: drive = "{scenario.drive}" moves the ends; give "cable" to fix them'
        )
    return _coordinate(scenario, position, fan, angle_deg, keep=1)


def _coordinate(scenario: Scenario, position, fan: int, angle_deg: float, keep: int):
    require_plannable(scenario)
    require_count("fan", fan)
    require_count("keep", keep)
    where = np.asarray(position, np.float64)
    if where.ndim != 2 or where.shape[1] != 3 or len(where) < 2 or not np.isfinite(where).all():
        raise InputError(
            f"position of shape {where.shape}: give the load's way as (samples, 3) finite numbers"
        )
    turns = offsets(scenario.drive, fan, float(np.deg2rad(angle_deg)))
    choices = combinations(fan, len(scenario.robots))
    keep = min(keep, len(choices))
    with jax.enable_x64(True):
        world = cast_world(build_world(scenario), jnp.float64)
        run = functools.partial(_run, scenario.drive, keep)
        tried = []
        for slack in SLACKS:
            found = run(world, jnp.asarray(where), turns, choices, jnp.asarray(slack))
            found = jax.tree.map(np.asarray, found)
            tried.append(_explain(found))
            if not found.alive or found.contacts == 0:
                break
    # More slack leaves fewer candidates: where it leaves none, say what the last one lacked.
    return next((each for each in tried if each.feasible), tried[-1 if len(tried) == 1 else -2])


class _Found(NamedTuple):
    candidates: Candidates  # of one choice per step: (samples, cables, …)
    counts: Array
    cost: Array
    alive: Array  # every step has a candidate
    contacts: Array  # between steps


def _explain(found: _Found) -> Coordination:
    reason = ""
    if not found.alive:
        step = int(np.argmin(found.counts > 0))
        reason = (
            f"no joint candidate is in reach, apart, in tension and clear at step {step} "
            f"({int((found.counts == 0).sum())} of {len(found.counts)} steps)"
            if (found.counts == 0).any()
            else "no single joint candidate serves all steps"
        )
    elif found.contacts:
        reason = f"load or cables meet an obstacle between steps ({int(found.contacts)} contacts)"
    chosen = found.candidates
    return Coordination(
        not reason,
        reason,
        np.asarray(chosen.ends),
        np.asarray(chosen.lengths),
        np.asarray(chosen.tensions),
        float(found.cost),
        np.asarray(found.counts),
    )


@functools.partial(jax.jit, static_argnums=(0, 1))
def _run(drive: str, keep: int, world: World, where, turns, choices, slack) -> _Found:
    position = Vec3.from_array(where)
    bodies, samples = world.bodies, len(where)
    margin = bodies.cable_radius + bodies.clearance + slack
    if moving(drive):
        fans = fan_ends(world, position, ends_at(world, position, drive), turns)
    else:
        middle = position.each(lambda c: c[samples // 2][None])
        fans = fan_ends(world, middle, bodies.ends.each(lambda c: c[:, None]), turns)
        fans = fans.each(lambda c: jnp.broadcast_to(c, (c.shape[0], samples, c.shape[2])))
    all_joint = joint_candidates(world, position, fans, choices, margin, arms=drive != "base")
    features = _features(all_joint, world)
    counts = all_joint.feasible.sum(axis=1)
    if moving(drive):
        cost = step_costs(features, all_joint.feasible)
        _, kept = jax.lax.top_k(-cost, keep)
        chosen, total = best_sequence(
            jnp.take_along_axis(features, kept[..., None], axis=1),
            jnp.take_along_axis(cost, kept, axis=1),
        )
        index = jnp.take_along_axis(kept, chosen[:, None], axis=1)[:, 0]
    else:
        best, total = best_constant(features, all_joint.feasible)
        index = jnp.broadcast_to(best, (samples,))
    picked = jax.tree.map(lambda leaf: leaf[jnp.arange(samples), index], all_joint)
    ends = Vec3.from_array(picked.ends).each(lambda c: c.T)
    contacts = count_collisions(position, bodies._replace(ends=ends), world.obstacles)
    return _Found(picked, counts, total, jnp.isfinite(total), contacts)


def _features(joint: Candidates, world: World) -> Float[Array, "samples joint q"]:
    """Γ_q / s_q of every joint candidate; zeros where it is not feasible."""
    limits = world.limits
    parts = [
        joint.ends.reshape(*joint.ends.shape[:2], -1),
        joint.tensions / (limits.tension_high - limits.tension_low),
        joint.lengths / (limits.length_high - limits.length_low),
    ]
    return jnp.where(joint.feasible[..., None], jnp.concatenate(parts, axis=-1), 0)


def step_costs(
    features: Float[Array, "samples joint q"], feasible: Bool[Array, "samples joint"]
) -> Float[Array, "samples joint"]:
    """Σ_q (Γ_q - E_q)²/(s_q² (η - 1)) of every candidate (Eq. 20); inf where not feasible.

    Args:
        features: Γ_q / s_q.
        feasible: which candidates count, for the mean as well.
    """
    count = feasible.sum(axis=1, keepdims=True).astype(features.dtype)
    weight = feasible[..., None].astype(features.dtype)
    mean = (features * weight).sum(axis=1, keepdims=True) / jnp.maximum(count, 1)[..., None]
    spread = ((features - mean) ** 2).sum(axis=-1) / jnp.maximum(count - 1, 1)
    return jnp.where(feasible, spread, jnp.inf)


def best_sequence(
    features: Float[Array, "samples kept q"], cost: Float[Array, "samples kept"]
) -> tuple[Int[Array, "samples"], Float[Array, ""]]:
    """One candidate per step of least Σ cost + Σ ‖ΔΓ/s‖², by dynamic programming.

    Args:
        features: Γ_q / s_q of the candidates that are kept.
        cost: of choosing each; inf forbids it.

    Returns:
        The indices and the least total: exact, inf if some step has no candidate.
    """

    def forward(best: Array, step: tuple[Array, Array, Array]) -> tuple[Array, Array]:
        before, now, own = step
        change = jnp.zeros((len(before), len(now)), now.dtype)
        for q in range(now.shape[-1]):  # differences, not products: no digits are lost
            change = change + (before[:, None, q] - now[None, :, q]) ** 2
        through = best[:, None] + change
        origin = jnp.argmin(through, axis=0)
        return own + through.min(axis=0), origin

    final, origins = jax.lax.scan(forward, cost[0], (features[:-1], features[1:], cost[1:]))
    last = jnp.argmin(final)

    def backward(index: Array, origin: Array) -> tuple[Array, Array]:
        return origin[index], index

    first, rest = jax.lax.scan(backward, last, origins, reverse=True)
    return jnp.concatenate([first[None], rest]), final[last]


def best_constant(
    features: Float[Array, "samples joint q"], feasible: Bool[Array, "samples joint"]
) -> tuple[Int[Array, ""], Float[Array, ""]]:
    """The candidate of least total among those that are feasible at every step."""
    always = jnp.all(feasible, axis=0)
    cost = step_costs(features, feasible & always[None])
    change = ((features[1:] - features[:-1]) ** 2).sum(axis=(0, 2))
    total = jnp.where(always, jnp.where(feasible, cost, 0).sum(axis=0) + change, jnp.inf)
    best = jnp.argmin(total)
    return best, total[best]
