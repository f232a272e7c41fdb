"""Algorithms by name. Adding one is one file in `algorithms/`, and one row in `choices`."""

import functools
import importlib
import inspect
from collections.abc import Callable

from jaxsusp.errors import InputError, require_known
from jaxsusp.optim import choices
from jaxsusp.optim.base import Optimizer


def _factory(row: choices.Row) -> Callable[[], Optimizer]:
    module = importlib.import_module(f"jaxsusp.optim.algorithms.{row.file}")
    factory = getattr(module, row.file)
    return functools.partial(factory, **dict(row.options)) if row.options else factory


ALGORITHMS: dict[str, Callable[[], Optimizer]] = {
    name: _factory(row) for name, row in choices.ALGORITHMS.items()
}
"""Factories by the names of what they make."""


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


def algorithms(chosen) -> list[Optimizer]:
    """Several of them, with distinct names; "all" means every one of the package.

    Raises:
        InputError: an unknown or repeated name, or none at all.
    """
    if isinstance(chosen, str):
        chosen = [chosen]
    found = [algorithm(choice) for choice in (ALGORITHMS if [*chosen] == ["all"] else chosen)]
    names = [optimizer.name for optimizer in found]
    if not names:
        raise InputError("algorithms: none given; name at least one")
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise InputError(
            f"algorithms = {names}: {repeated[0]!r} is repeated; give each a name once"
        )
    return found
