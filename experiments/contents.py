"""Which pages there are, in the order in which they are read."""

import importlib
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, cast

import pandas as pd
from matplotlib.figure import Figure

from experiments.artefacts import Artefacts
from jaxsusp.errors import require_known

NAMES = (
    "published.comparison",
    "published.ends",
    "published.system",
    "published.schemes",
    "published.environment",
    "published.space",
    "published.trajectories",
    "published.motion",
    "published.towing",
    "published.convergence",
    "studies.ablation",
    "studies.budgets",
    "studies.origin",
    "studies.spaces",
    "studies.sensitivity",
    "studies.cable_check",
    "studies.difficulty",
    "studies.pace",
    "studies.scaling",
    "claims.ledger",
)
"""Modules of this folder; what stands later may read the data of what stands before it."""


_NONE: Mapping[str, Any] = MappingProxyType({})


class Page(NamedTuple):
    """What a module has to show."""

    figures: Mapping[str, Figure] = _NONE  # by file name; captions in `Figure.get_label`
    tables: Mapping[str, pd.DataFrame] = _NONE  # by file name; see report.render
    findings: str = ""  # Markdown; every number in it comes from the data
    body: str = ""  # Markdown instead of the tables, where rows of a table are too long to read


class Module(Protocol):
    """What a page's module says and does.

    `make` is there only where runs are needed. It keeps its data under the names in `MADE`; what
    it interrupts goes on from `work.folder`.
    """

    TITLE: str
    PRINTED: str  # "Table 1", "Fig. 7"; "" of what the paper does not have
    DIFFERS: str  # a sentence: how it differs from the printed one, or what is asked
    MADE: tuple[str, ...]  # artefacts that `make` keeps
    READ: tuple[str, ...]  # artefacts that `draw` reads
    MINUTES: float  # of `make` on two cores that do nothing else
    FULL: Any  # settings, a NamedTuple; `MINIATURE` has as little work as shows anything
    MINIATURE: Any
    make: Callable[[Any, "Work"], None]
    draw: Callable[[Artefacts], Page]


def maker(artefact: str) -> str:
    """The page whose `make` keeps an artefact; "" where none does."""
    return next((name for name in NAMES if artefact in module(name).MADE), "")


def making(artefacts: Sequence[str]) -> str:
    """Commands that make some data, with their minutes."""
    names = dict.fromkeys(filter(None, map(maker, artefacts)))
    return " and ".join(
        f"`python -m experiments make {name}` (about {module(name).MINUTES:g} min)"
        for name in names
    )


class Work(NamedTuple):
    """What `make` is given."""

    artefacts: Artefacts  # where its data are kept, and those that it needs are read
    folder: Any  # a folder of its own for parts that are finished
    told: Callable[[str], None]  # a line for a person who waits


def module(name: str) -> Module:
    """The module of that name.

    Raises:
        InputError: there is none.
    """
    require_known("page", name, NAMES)
    return cast(Module, importlib.import_module(f"experiments.{name}"))
