"""Eq. 20 over given candidates: the steadiest sequence of them, and the steadiest constant choice.

With E^ξ the mean over the η feasible joint candidates of step ξ, the sequence chosen minimises

    Σ_ξ [ Σ_q (Γ_q - E_q^ξ)² / (s_q² (η_ξ - 1)) + Σ_q (ΔΓ_q)² / s_q² ],

q over the coordinates of the ends, the tensions and the lengths, s = 1 m, T_hi - T_lo and
l_max - l_min: the paper's variance (its square belongs inside the sum) as the cost of a step,
smoothness as the cost of a transition. Dynamic programming solves it exactly.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxsusp._types import Array, Bool, Float, Int
from jaxsusp.coordination.fans import Candidates
from jaxsusp.scenario.world import Limits


class Spread(NamedTuple):
    """What the candidates of every step are measured against."""

    mean: Float[Array, "samples 1 q"]  # E / s
    weight: Float[Array, "samples 1"]  # 1 / (η - 1)


def features(joint: Candidates, limits: Limits) -> Float[Array, "*joint q"]:
    """Γ_q / s_q of every joint candidate; zeros where it is not feasible."""
    parts = [
        joint.ends.reshape(*joint.ends.shape[:-2], -1),
        joint.tensions / (limits.tension_high - limits.tension_low),
        joint.lengths / (limits.length_high - limits.length_low),
    ]
    return jnp.where(joint.feasible[..., None], jnp.concatenate(parts, axis=-1), 0)


def spread_of(
    values: Float[Array, "samples joint q"], feasible: Bool[Array, "samples joint"]
) -> Spread:
    """Mean and weight of the feasible candidates of every step."""
    count = feasible.sum(axis=1, keepdims=True).astype(values.dtype)
    share = feasible[..., None].astype(values.dtype)
    total = (values * share).sum(axis=1, keepdims=True)
    return Spread(total / jnp.maximum(count, 1)[..., None], 1 / jnp.maximum(count - 1, 1))


def step_costs(
    values: Float[Array, "samples joint q"], feasible: Bool[Array, "samples joint"], spread: Spread
) -> Float[Array, "samples joint"]:
    """Σ_q (Γ_q - E_q)²/(s_q² (η - 1)) of every candidate (Eq. 20); inf where not feasible.

    Args:
        values: Γ_q / s_q.
        feasible: which candidates may be chosen.
        spread: E and η, of these candidates or of wider fans around the same place.
    """
    cost = ((values - spread.mean) ** 2).sum(axis=-1) * spread.weight
    return jnp.where(feasible, cost, jnp.inf)


def total_cost(
    values: Float[Array, "samples q"], feasible: Bool[Array, "samples"], spread: Spread
) -> Float[Array, ""]:
    """Eq. 20 with its transitions for one sequence; inf where a step is not feasible."""
    own = step_costs(values[:, None], feasible[:, None], spread)
    return own.sum() + ((values[1:] - values[:-1]) ** 2).sum()


def best_sequence(
    values: Float[Array, "samples kept q"], cost: Float[Array, "samples kept"]
) -> tuple[Int[Array, "samples"], Float[Array, ""]]:
    """One candidate per step of least Σ cost + Σ ‖ΔΓ/s‖², by dynamic programming.

    Args:
        values: Γ_q / s_q of the candidates that are kept.
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

    final, origins = jax.lax.scan(forward, cost[0], (values[:-1], values[1:], cost[1:]))
    last = jnp.argmin(final)

    def backward(index: Array, origin: Array) -> tuple[Array, Array]:
        return origin[index], index

    first, rest = jax.lax.scan(backward, last, origins, reverse=True)
    return jnp.concatenate([first[None], rest]), final[last]


def best_constant(
    values: Float[Array, "samples joint q"], feasible: Bool[Array, "samples joint"]
) -> tuple[Int[Array, ""], Float[Array, ""]]:
    """The candidate of least total among those that are feasible at every step."""
    always = jnp.all(feasible, axis=0)
    may = feasible & always[None]
    cost = step_costs(values, may, spread_of(values, may))
    change = ((values[1:] - values[:-1]) ** 2).sum(axis=(0, 2))
    total = jnp.where(always, jnp.where(feasible, cost, 0).sum(axis=0) + change, jnp.inf)
    best = jnp.argmin(total)
    return best, total[best]
