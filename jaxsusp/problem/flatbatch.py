"""One flat batch of candidates whatever `vmap` adds: runs join it, scenarios are taken in turn."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap

from jaxsusp._types import Array

BLOCK = 1024
"""Candidates at a time: with 40 samples an array of theirs takes 160 KiB, of which a core's own
cache holds several. A thousand runs side by side take 2.2 times as long without."""


def one_flat_batch(function: Callable[[Any, Array], Array]) -> Callable[[Any, Array], Array]:
    """Let a function of (coefficients, candidates (N, D)) see one flat batch whatever `vmap` adds.

    Runs join the population in the last axis, where XLA vectorises. Scenarios, whose coefficients
    differ, are taken in turn: one body of code whatever their number keeps a run bit-equal
    whether its scenario is alone or stacked.
    """
    function = _in_blocks(function)

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
        return _in_turn(function, coefficients, x), True

    return batched


def _in_blocks(function: Callable[[Any, Array], Array]) -> Callable[[Any, Array], Array]:
    """The same of any number of candidates, on a CPU no more of them at a time than `BLOCK`."""

    def found(coefficients: Any, x: Array) -> Array:
        count = len(x)
        if count <= BLOCK or jax.default_backend() != "cpu":
            return function(coefficients, x)
        blocks = -(-count // BLOCK)
        size = -(-count // blocks)
        last = jnp.broadcast_to(x[-1:], (blocks * size - count, x.shape[1]))  # only fills up
        cut = jnp.concatenate([x, last]).reshape(blocks, size, -1)
        each = jax.lax.map(functools.partial(function, coefficients), cut)
        return each.reshape(-1, *each.shape[2:])[:count]

    return found


def _in_turn(function: Callable[[Any, Array], Array], coefficients: Any, x: Array) -> Array:
    """The function of every (coefficients, candidates), those of the next fetched ahead.

    What a loop carries is at hand when a turn begins. Fetched where they are used, as `lax.map`
    does, coefficients would be looked up within every kernel, whose loops LLVM then leaves
    unvectorised: a search of six scenarios would take 1.8 times as long.
    """
    count, table = len(x), jax.tree.map(jnp.asarray, coefficients)

    def of(i) -> Any:
        return jax.tree.map(lambda leaf: jax.lax.dynamic_index_in_dim(leaf, i, 0, False), table)

    def turn(own: Any, each: tuple[Array, Array]) -> tuple[Any, Array]:
        following, candidates = each
        return of(following), function(own, candidates)

    following = jnp.minimum(jnp.arange(1, count + 1, dtype=jnp.int32), count - 1)
    return jax.lax.scan(turn, of(0), (following, x))[1]
