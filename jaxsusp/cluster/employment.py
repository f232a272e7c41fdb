"""Who does the work, from what a person says of it. What is heavy is loaded for workers alone."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from jaxsusp.cluster.choices import Place
from jaxsusp.errors import InputError

if TYPE_CHECKING:
    from jaxsusp.cluster.client import Cluster


@contextmanager
def employed(
    workers: Any, told: Callable[[str], None] = lambda message: None
) -> Iterator["Cluster | None"]:
    """Who does the work: nobody but this process, or workers.

    Args:
        workers: None, a number of processes of this machine, the address or file of a scheduler, a
            `Place`, or a `distributed.Client` that is connected.
        told: called with a sentence where something deserves a person's attention.

    Raises:
        ClusterError: no scheduler answers, or none of its workers can do the work.
        InputError: anything else.
    """
    match workers:
        case None:
            place = Place()
        case Place():
            place = workers
        case bool():
            raise InputError(f"workers = {workers}: give a number of them")
        case int():
            place = Place(workers=workers)
        case str() | os.PathLike():
            place = Place(scheduler=os.fspath(workers))
        case _:
            place = None
    if place is not None:
        place.require_sense()
        if place.here:
            yield None
            return
    from jaxsusp.cluster.client import connected

    chosen: Any = workers if place is None else place
    with connected(chosen, told) as cluster:
        yield cluster
