"""One flat batch of candidates whatever `vmap` adds: runs join it, scenarios are taken in turn."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap

from jaxsusp._types import Array


def one_flat_batch(function: Callable[[Any, Array], Array]) -> Callable[[Any, Array], Array]:
    """Let a function of (coefficients, candidates (N, D)) see one flat batch whatever `vmap` adds.

    Runs join the population in the last axis, where XLA vectorises. Scenarios, whose coefficients
    differ, are taken in turn: one body of code whatever their number keeps a run bit-equal
    whether its scenario is alone or stacked.
    """

    @custom_vmap
    def batched(coefficients, x: Array) -> Array:
        return function(coefficients, x)

    @batched.def_vmap
    def _rule(axis_size, in_batched, coefficients, x):
        if not any(jax.tree.leaves(in_batched[0])):
            flat = batched(coefficients, x.reshape(-1, x.shape[-1]))
            return flat.reshape(x.shape[:-1] + flat.shape[1:]), True
        coefficients, x = jax.tree.map(
            lambda leaf, batched: leaf if batched else jnp.stack([leaf] * axis_size),
            (coefficients, x),
            tuple(in_batched),
        )
        return jax.lax.map(lambda each: function(*each), (coefficients, x)), True

    return batched
