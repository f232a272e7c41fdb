"""Bounds and a fitness that somebody gave: are they what a search can work with?

Of a fitness JAX would say so when the search is compiled, in the words of its own tracing.
"""

import inspect
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxsusp.errors import InputError, require

_UNTRACED = (
    jax.errors.TracerArrayConversionError,
    jax.errors.ConcretizationTypeError,
    jax.errors.NonConcreteBooleanIndexError,
)


def bounds_of(lower: Any, upper: Any) -> tuple[np.ndarray, np.ndarray]:
    """Validated host copies of bounds, in their common floating dtype."""
    given = [bound if hasattr(bound, "dtype") else jnp.asarray(bound) for bound in (lower, upper)]
    lower, upper = (np.asarray(bound) for bound in given)
    dtype = np.result_type(lower, upper)
    if not np.issubdtype(dtype, np.floating):
        dtype = jnp.zeros(()).dtype
    lower, upper = lower.astype(dtype), upper.astype(dtype)
    if lower.ndim != 1 or lower.shape != upper.shape or lower.size == 0:
        raise InputError(
            f"lower and upper must be vectors of one length, got shapes {lower.shape} and "
            f"{upper.shape}"
        )
    if not (np.isfinite(lower).all() and np.isfinite(upper).all() and (lower < upper).all()):
        raise InputError("bounds must be finite with lower < upper in every variable")
    return lower, upper


def held(dtype: Any) -> np.dtype:
    """What JAX holds a dtype in: it cuts float64 where that is not enabled, with a warning."""
    return jax.dtypes.canonicalize_dtype(dtype)


def require_fitness(fitness: Callable, dim: int, dtype: Any) -> None:
    """Refuse a function that is no fitness of vectors of `dim` numbers.

    Raises:
        InputError: one sentence with the remedy.
    """
    require(callable(fitness), f"fitness = {fitness!r}: give a function of one vector x")
    _require_signature(fitness)
    with jax.enable_x64(dtype == np.float64):  # as the search has it
        try:
            found = jax.eval_shape(
                lambda x: _number(fitness(x)), jax.ShapeDtypeStruct((dim,), dtype)
            )
        except InputError:
            raise
        except _UNTRACED:
            raise InputError(
                "fitness: it needs the values of x, which JAX does not have while it compiles; use "
                "jax.numpy in place of numpy, jnp.where in place of if, and neither float(…) nor "
                "int(…) of x"
            ) from None
        except Exception as error:  # whatever a function does with a vector
            reason = (str(error).splitlines() or [""])[0].rstrip(".") or type(error).__name__
            raise InputError(
                f"fitness: it fails for a vector x of {dim} numbers ({reason}); give a JAX "
                "function of such a vector that returns one number"
            ) from error
    require(
        found.shape == (),
        f"fitness: it returns an array of shape {found.shape} for one vector x; return one number, "
        "such as the sum of that array",
    )


def _require_signature(fitness: Callable) -> None:
    try:
        signature = inspect.signature(fitness)
    except (TypeError, ValueError):  # of some compiled functions nothing is known
        return
    try:
        signature.bind(None)
    except TypeError as error:
        raise InputError(
            f"fitness: it cannot be called with one vector x ({error}); give a function of x "
            "alone, such as lambda x: f(x, …)"
        ) from None


def _number(found: Any) -> Any:
    """What a function returned, if JAX can take it for real numbers."""
    if not isinstance(found, jax.Array | np.ndarray | np.generic | bool | int | float):
        what = "nothing" if found is None else f"a {type(found).__name__}"
        raise InputError(f"fitness: it returns {what}; return one number")
    if np.iscomplexobj(found):
        raise InputError("fitness: it returns complex numbers; return a real one")
    return found
