"""What a comparison tells while it is computed."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from jaxsusp.comparison.chunks import Chunk
from jaxsusp.comparison.workunit import Unit


class Event(NamedTuple):
    """What a progress callback is told."""

    algorithm: str  # the name of a scenario while its free space is mapped
    phase: str  # "free space", "timing", "resumed", "compiling", "running", "kept" or "finished"
    done: int  # fitness evaluations done …
    total: int  # … of the whole comparison
    compilations: int = 0  # still to be done, this one included
    runs: int = 0  # finished of that algorithm
    note: str = ""  # a sentence for a person


class Tally:
    """What has been done of a comparison, and telling of it.

    Args:
        work: every unit, with the runs that are still to be computed.
        runs: how many each has to have in the end.
        progress: see `compare`.
        workers_compile: whether compilations are somebody else's, who does not tell of them.
    """

    def __init__(
        self,
        work: Sequence[tuple[Unit, list[int]]],
        runs: int,
        progress: Callable[[Event], None],
        workers_compile: bool = False,
    ):
        self.runs = runs
        self.total = sum(unit.cost(runs) for unit, _ in work)
        self.left = {id(unit): len(missing) for unit, missing in work}
        self.done = sum(unit.cost(runs - len(missing)) for unit, missing in work)
        self.compilations = 0 if workers_compile else sum(bool(missing) for _, missing in work)
        self._begun: set[int] = set()
        self._progress = progress

    def tell(self, unit: Unit, phase: str, extra: int = 0) -> None:
        """An event of a unit; `extra` evaluations are done of a chunk that is not finished."""
        there = self.runs - self.left[id(unit)]
        self._progress(Event(
            unit.optimizer.name, phase, self.done + extra, self.total, self.compilations, there,
        ))  # fmt: skip

    def report(self, chunk: Chunk, iterations: int) -> None:
        """A chunk that is computed here gets on."""
        unit = chunk.unit
        if iterations == 0:
            if id(unit) not in self._begun:
                self.tell(unit, "compiling")
                self._begun.add(id(unit))
                self.compilations -= 1
            return
        self.tell(unit, "running", chunk.cost * iterations // unit.iterations)

    def finished(self, chunk: Chunk) -> None:
        """A chunk is finished and kept."""
        self.left[id(chunk.unit)] -= len(chunk.runs)
        self.done += chunk.cost
        self.tell(chunk.unit, "kept" if self.left[id(chunk.unit)] else "finished")
