"""Algorithms by name. Adding one is one file with a factory, and one row here."""

import functools
import inspect
from collections.abc import Callable

from jaxsusp.errors import InputError, require_known
from jaxsusp.optim.base import Optimizer
from jaxsusp.optim.dbo import dbo
from jaxsusp.optim.ga import ga
from jaxsusp.optim.pso import pso
from jaxsusp.optim.sdbo import sdbo

ALGORITHMS: dict[str, Callable[[], Optimizer]] = {
    "pso": pso,
    "ga": ga,
    "dbo": dbo,
    "sdbo": sdbo,
    "dbo-task": functools.partial(dbo, frame="task"),
    "sdbo-task": functools.partial(sdbo, frame="task"),
}
"""Factories by the names of what they make."""

PUBLISHED = ("pso", "ga", "dbo", "sdbo")
"""The four algorithms of the paper's Table 1."""


def algorithm(choice: str | Optimizer) -> Optimizer:
    """The optimiser of that name, or the optimiser itself.

    Raises:
        InputError: an unknown name; the message suggests the nearest.
    """
    if isinstance(choice, Optimizer):
        return choice
    require_known("algorithm", choice, ALGORITHMS)
    return ALGORITHMS[choice]()


def describe(name: str) -> str:
    """One line about an algorithm: the first of its factory's documentation."""
    factory = ALGORITHMS[name]
    options = getattr(factory, "keywords", {})
    words = (inspect.getdoc(getattr(factory, "func", factory)) or "").splitlines()[0]
    return ", ".join([words.rstrip("."), *(f"{key}={value!r}" for key, value in options.items())])


def algorithms(choices) -> list[Optimizer]:
    """Several of them, with distinct names.

    Raises:
        InputError: an unknown or repeated name, or none at all.
    """
    chosen = [algorithm(choice) for choice in choices]
    names = [optimizer.name for optimizer in chosen]
    if not names:
        raise InputError("algorithms: none given; name at least one")
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise InputError(
            f"algorithms = {names}: {repeated[0]!r} is repeated; give each a name once"
        )
    return chosen
