"""SDBO with and without each of its improvements, all sixteen variants one compiled program.

`jaxsusp.sdbo` decides while it is traced what is left out, so that each of its variants is a
program of its own. Here that is an argument: what is left out costs no time either, because no run
of a batch differs from another in it, and fifteen compilations are saved.
"""

from itertools import product
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax.tree_util import Partial

from jaxsusp._types import Array, Bool
from jaxsusp.optim.algorithms.dbo import DboState, forage, settle
from jaxsusp.optim.algorithms.sdbo import (
    SdboCoefficients,
    pulled,
    sdbo,
    sine_cosine_moves,
    stabilised,
)
from jaxsusp.optim.base import NoInfo, Optimizer
from jaxsusp.problem.problem import Problem


class Switches(NamedTuple):
    """Which of SDBO's additions to DBO are made."""

    opposition: bool | Bool[Array, ""] = True  # Eq. 13
    sine_cosine: bool | Bool[Array, ""] = True  # Eq. 14-16
    pull: bool | Bool[Array, ""] = True  # Eq. 17
    stability: bool | Bool[Array, ""] = True  # Eq. 18, 19


VARIANTS = tuple(Switches(*made) for made in product((False, True), repeat=4))
"""All of them, from none, DBO, to all, SDBO; they count in binary, opposition the highest digit."""


def switched(made: Switches) -> Optimizer:
    """One of the variants, named "sdbo" like all others: whatever they do alike has equal luck.

    Tracing counts the evaluations of what all improvements need; those of a variant are those of
    `jaxsusp.sdbo` with the same ones.
    """
    on = Switches(*(np.asarray(each, bool) for each in made))
    chosen = SdboCoefficients()
    return Optimizer("sdbo", Partial(_init, on), Partial(_step, on, chosen))


def _init(on: Switches, key, problem: Problem, population: int, iterations):
    def begun(opposition: bool):
        return sdbo(opposition=opposition).init(key, problem, population, iterations)

    return jax.lax.cond(on.opposition, lambda: begun(True), lambda: begun(False))


def _step(on: Switches, c: SdboCoefficients, key, problem: Problem, state: DboState):
    two = jax.random.split(key)  # as many are needed where there is a pull

    def last(key, thieves: Array) -> Array:
        moved = sine_cosine_moves(c, problem, state, key, thieves)
        return jnp.where(on.sine_cosine, moved, thieves)

    key_forage = jnp.where(on.pull, two[0], key)
    state = settle(state, *forage(c.dbo, key_forage, problem, state, last))
    state = jax.lax.cond(
        on.pull, lambda state: pulled(two[1], problem, state), lambda state: state, state
    )
    state = jax.lax.cond(
        on.stability, lambda state: stabilised(c, problem, state)[0], lambda state: state, state
    )
    return state, NoInfo()
