"""The algorithms by name, a row each; light to import, so that a mistyped one is told at once."""

from collections.abc import Iterable
from importlib.util import find_spec
from typing import Any, NamedTuple

from jaxsusp.errors import InputError, require_known


class Row(NamedTuple):
    """Where an algorithm is: its file in `optim/algorithms`, whose factory has the same name."""

    file: str
    options: tuple[tuple[str, Any], ...] = ()  # of the factory


ALGORITHMS = {
    "pso": Row("pso"),
    "ga": Row("ga"),
    "dbo": Row("dbo"),
    "sdbo": Row("sdbo"),
    "dbo-task": Row("dbo", (("frame", "task"),)),
    "sdbo-task": Row("sdbo", (("frame", "task"),)),
    "cmaes": Row("cmaes"),
    "jde": Row("jde"),
    "routed": Row("routed"),
}

PUBLISHED = ("pso", "ga", "dbo", "sdbo")
"""The four algorithms of the paper's Table 1."""

PEERS = {"evosax": "CMA_ES", "pymoo": "GA"}
"""Libraries whose algorithms are known as "evosax:CMA_ES", each with one of its names. An adapter
of the same name is in `optim/peers`."""

EXTRA = 'pip install ".[peers]" in a copy of the repository'


def installed() -> list[str]:
    """The libraries of `PEERS` that are there."""
    return [library for library in PEERS if find_spec(library)]


def require_algorithm(name: str, others: Iterable[str] = ()) -> None:
    """Refuse what is no algorithm, as far as it can be told without loading any.

    Args:
        name: of ours, or "LIBRARY:NAME" of another library's.
        others: what is allowed besides.

    Raises:
        InputError: an unknown name or library, or a library that is not installed.
    """
    library, colon, _ = str(name).partition(":")
    if not colon and library not in PEERS:
        require_known("algorithm", name, [*ALGORITHMS, *others])
        return
    require_known(f'library of "{name}"', library, PEERS)
    if not colon:
        raise InputError(f'algorithm = "{name}" is a library; name one of its algorithms, such as '
                         f'"{name}:{PEERS[name]}"')  # fmt: skip
    if library not in installed():
        raise InputError(
            f'algorithm = "{name}": {library} is not installed; {EXTRA} brings it (extra "peers")'
        )


DEVICES = ("cpu", "gpu")
"""What searches run on."""


def require_device(device: str) -> None:
    """Refuse what is no kind of device.

    Raises:
        InputError: with the nearest.
    """
    require_known("device", device, DEVICES)
