"""The algorithms by name, a row each; light to import, so that a mistyped one is told at once."""

from typing import Any, NamedTuple


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
