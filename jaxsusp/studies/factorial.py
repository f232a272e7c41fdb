"""What factors are worth that are on or off in all combinations, and how sure that is.

In a full 2^k design every effect uses every run: the effect of a factor is the mean, over all
combinations of the others, of what changes when it comes on. The runs of all combinations on one
scene begin with one key, so that effects are formed within a scene and run before anything is
averaged.
"""

from collections.abc import Sequence

import numpy as np

from jaxsusp._types import Float


def effect(
    values: Float[np.ndarray, "*cells factors"], factors: Sequence[int], count: int
) -> Float[np.ndarray, "*cells"]:
    """The effect of one factor, or by how much several change each other's.

    Of one: the mean of on − off. Of two: the effect of either where the other is on minus that
    where it is off; and so on.

    Args:
        values: one number per combination in the last axis, which counts in binary: the first
            factor is its highest digit, 0 off and 1 on.
        factors: numbers of the factors, from 0.
        count: number k of all factors.
    """
    table = values.reshape(*values.shape[:-1], *(2,) * count)
    first = values.ndim - 1
    for factor in factors:
        table = np.diff(table, axis=first + factor)
    return table.mean(axis=tuple(range(first, first + count)))
