"""Compiled programs that the next process need not trace again.

What XLA compiles, JAX keeps; what leads there, tracing a search and lowering it, takes each process
longer than the search itself. Where compiled programs are kept at all (see `devices.configure`),
ours are kept whole: known by what they are called with, by the code of the package, by JAX and by
the machine. A search with functions or types that are not the package's own is traced as ever,
since nothing tells when they change; who puts other helpers into modules of the package while it
runs is not seen, and sets JAXSUSP_NO_CACHE=1.
"""

import dataclasses
import functools
import hashlib
import inspect
import os
import pickle
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

import jax
from jax._src import config
from jax.experimental import serialize_executable
from jax.tree_util import Partial

from jaxsusp._cache import code_digest, used
from jaxsusp._files import atomic_path
from jaxsusp.optim.devices import instruction_set

SUFFIX = ".program"

_APART = {"xla_embed_ir_in_executable": False}
"""Stated though it is XLA's default: programs that JAX has kept otherwise are other ones."""

_SWITCHES = ("jax_threefry_partitionable", "jax_default_matmul_precision", "jax_debug_nans")
"""Of JAX, that change what a program computes. Whether it may use 64 bits its arguments tell."""

_Found = TypeVar("_Found")


def at_hand(
    program: Callable[..., _Found], devices: Sequence[Any], *arguments: Any, **fixed: Any
) -> Callable[..., _Found]:
    """The compiled form of a program for arguments of such shapes, kept or compiled now.

    Args:
        program: what `jax.jit` gave.
        devices: those that it runs on.
        *arguments: what it will be called with; numbers among them may be others then.
        **fixed: what else the program was made for.

    Returns:
        What is to be called with arguments like these: `program` itself where nothing is kept.
    """
    folder = kept_in()
    if folder is None:
        return program
    leaves, tree = jax.tree.flatten(arguments)
    try:
        known = described((tree.unflatten(map(_kind_of, leaves)), fixed))
    except Exception:  # of other code, or of a class that holds nothing but arrays
        return program
    file = folder / f"{_digest(known, devices)}{SUFFIX}"
    place = _place_of(file, tree)
    with place.lock:  # who asks for what another thread compiles waits for it
        if place.program is None:
            try:
                place.program = _made(file, program, devices, arguments)
            except Exception:  # what cannot be compiled before it is called says itself why
                return program
        return place.program


def kept_in() -> Path | None:
    """The folder in which JAX keeps what is compiled for CPUs; None where it does not."""
    config: Any = jax.config
    folder = config.jax_compilation_cache_dir
    if not folder or "://" in folder or jax.default_backend() != "cpu":
        return None
    wanted = config.jax_enable_compilation_cache and not config.jax_disable_jit
    return Path(folder) if wanted else None


class _Place:
    """Where a process holds a program that it has, or will have."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.program: Callable | None = None


@functools.lru_cache(maxsize=64)
def _place_of(file: Path, tree: Any) -> _Place:
    """The place of a program in this process.

    A module that is loaded anew has other functions of the same names, of which a program that
    was made for the earlier ones would know nothing.
    """
    del file, tree
    return _Place()


def _made(file: Path, program: Any, devices: Sequence, arguments: tuple) -> Callable:
    with suppress(Exception):  # not there, cut short, of a machine that only seems the same
        return _loaded(file, devices, arguments)
    compiled = _compiled_here(program.lower(*arguments))
    with suppress(Exception):  # a full disk
        _keep(file, compiled)
    return compiled


def _compiled_here(lowered: Any) -> Any:
    """Compiled by this process, not found by JAX: XLA cannot write down what it has only read.

    Of this thread alone JAX keeps nothing meanwhile, which its public configuration cannot say.
    """
    with config.persistent_cache_min_compile_time_secs(float("inf")):
        return lowered.compile(_APART)


def _loaded(file: Path, devices: Sequence, arguments: tuple) -> Callable:
    with file.open("rb") as opened:
        payload, outcome = pickle.load(opened)
    used(file)
    trees = jax.tree.structure((arguments, {})), jax.tree.structure(outcome)
    return serialize_executable.deserialize_and_load(payload, *trees, execution_devices=devices)


def _keep(file: Path, compiled: Any) -> None:
    payload, _, tree = serialize_executable.serialize(compiled)
    outcome = jax.tree.unflatten(tree, range(tree.num_leaves))
    with atomic_path(file) as scratch:
        scratch.write_bytes(pickle.dumps((payload, outcome)))


def _digest(known: str, devices: Sequence) -> str:
    """What the result depends on beside the arguments: code, versions, machine, switches."""
    places = [(each.platform, each.device_kind, each.id) for each in devices]
    switches = [getattr(jax.config, name) for name in _SWITCHES]
    said = repr((known, code_digest(""), _machine(), places, switches))
    return hashlib.sha256(said.encode()).hexdigest()[:32]


@functools.cache
def _machine() -> tuple[str, ...]:
    """What stays while a process lasts."""
    flags = os.environ.get("XLA_FLAGS", "")
    return version("jax"), version("jaxlib"), instruction_set(), flags


def _kind_of(leaf: Any) -> str:
    """What a program knows of an argument: shape and type, no values."""
    aval = jax.typeof(leaf)
    return f"{aval.dtype}{aval.shape}{'~' * aval.weak_type}"


class _ForeignError(Exception):
    """Something whose code is not the package's."""


def described(value: Any) -> str:
    """Types, functions and what else is fixed in a program's arguments, kinds in place of leaves.

    Raises:
        _ForeignError: a function or a type among them is defined elsewhere.
    """
    if value is None or isinstance(value, bool | int | float | str):
        return repr(value)
    if isinstance(value, Partial):
        return f"Partial{described((value.func, value.args, value.keywords))}"
    if type(value) in (tuple, list):
        return f"{type(value).__name__}({', '.join(map(described, value))})"
    if type(value) is dict:
        return f"dict({', '.join(f'{key!r}: {described(value[key])}' for key in sorted(value))})"
    if inspect.isfunction(value):
        return _name(value)
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return f"{_name(type(value))}{described(tuple(value))}"
    if dataclasses.is_dataclass(value) or hasattr(value, "__dict__"):
        return f"{_name(type(value))}{described(vars(value))}"
    raise _ForeignError(type(value))


def _name(thing: Any) -> str:
    """The name under which a function or class is found in a module of the package."""
    module, name = thing.__module__, thing.__qualname__
    if module.split(".")[0] != "jaxsusp" or getattr(sys.modules[module], name, None) is not thing:
        raise _ForeignError(f"{module}.{name}")
    if inspect.isfunction(thing) and not _is_its_own(thing):
        raise _ForeignError(f"{module}.{name}, of which another function has the name")
    return f"{module}.{name}"


def _is_its_own(function: Any) -> bool:
    """Whether a function was defined under its name: wrappers take those of what they wrap."""
    while inspect.isfunction(function) and _room(function) in _CHECKERS:
        function = inspect.getattr_static(function, "__wrapped__", None)
    of_module = _room(function) == "jaxsusp" and _defined_in(function) == function.__module__
    return of_module and function.__code__.co_qualname == function.__qualname__


_CHECKERS = ("jaxtyping", "beartype")
"""Packages whose wrappers, where types are checked, change nothing that is computed."""


def _room(function: Any) -> str:
    return _defined_in(function).split(".")[0]


def _defined_in(function: Any) -> str:
    """The module whose code a function is."""
    return getattr(function, "__globals__", {}).get("__name__", "")
