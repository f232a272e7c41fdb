"""Algorithms by name. Adding one is one file in `algorithms/`, and one row in `choices`.

Those of other libraries are looked up in their own registries, through an adapter in `peers/`.
"""

import functools
import importlib
import inspect
from collections.abc import Callable
from types import ModuleType
from typing import Any

from jaxsusp.errors import InputError, require
from jaxsusp.optim import choices
from jaxsusp.optim.base import AnyOptimizer, HostOptimizer, Optimizer


def _factory(row: choices.Row) -> Callable[[], Optimizer]:
    module = importlib.import_module(f"jaxsusp.optim.algorithms.{row.file}")
    factory = getattr(module, row.file)
    return functools.partial(factory, **dict(row.options)) if row.options else factory


ALGORITHMS: dict[str, Callable[[], Optimizer]] = {
    name: _factory(row) for name, row in choices.ALGORITHMS.items()
}
"""Factories by the names of what they make."""


def algorithm(choice: str | AnyOptimizer) -> AnyOptimizer:
    """The optimiser of that name, or the optimiser itself.

    Raises:
        InputError: an unknown name, for which the message suggests the nearest; or one of a library
            that is not installed.
    """
    if isinstance(choice, Optimizer | HostOptimizer):
        return choice
    choices.require_algorithm(choice)
    return peer(choice) if ":" in choice else ALGORITHMS[choice]()


def peer(name: str, **coefficients: Any) -> AnyOptimizer:
    """An algorithm of another library, with coefficients of its own in place of the defaults.

    Args:
        name: such as "evosax:CMA_ES" or "pymoo:GA"; `jaxsusp algorithms --peers` lists them.
        **coefficients: by the names that the library has for them.

    Returns:
        An optimiser of that name, an `Optimizer` or a `HostOptimizer`.

    Raises:
        InputError: an unknown name or coefficient, or a library that is not installed.
    """
    library, colon, theirs = name.partition(":")
    require(bool(colon), f'peer = "{name}": give a name such as "evosax:CMA_ES"')
    choices.require_algorithm(name)
    return _adapter(library).make(theirs, **coefficients)


def peers() -> list[str]:
    """Algorithms of the other libraries that are installed, such as "evosax:CMA_ES"."""
    return [
        f"{library}:{name}" for library in choices.installed() for name in _adapter(library).names()
    ]


def _adapter(library: str) -> ModuleType:
    return importlib.import_module(f"jaxsusp.optim.peers.{library}")


def describe(name: str) -> str:
    """One line about an algorithm: the first of its factory's documentation."""
    library, colon, theirs = name.partition(":")
    if colon:
        return _adapter(library).describe(theirs)
    factory = ALGORITHMS[name]
    options = getattr(factory, "keywords", {})
    words = (inspect.getdoc(getattr(factory, "func", factory)) or "").splitlines()[0]
    return ", ".join([words.rstrip("."), *(f"{key}={value!r}" for key, value in options.items())])


def algorithms(chosen) -> list[AnyOptimizer]:
    """Several of them, with distinct names; "all" means every one that is ours.

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
