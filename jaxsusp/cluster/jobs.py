"""What is handed to a worker: a function of this package and what it is to be called with."""

from collections.abc import Callable
from typing import Any, NamedTuple


class Job(NamedTuple):
    """A piece of work that depends on nothing but its arguments, and may be done twice."""

    name: str  # for people
    work: Callable[..., Any]  # work(shared, *arguments), of a module that every worker has
    shared: Any  # what many jobs have in common; a worker gets it once
    arguments: tuple[Any, ...] = ()
