"""Progress of a comparison on stderr: a bar in a terminal, a line per algorithm anywhere else.

Progress is told once per chunk of iterations (20 times per algorithm), which costs nothing that
can be measured.
"""

import time
from collections.abc import Callable
from datetime import timedelta
from typing import NamedTuple, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn, TimeElapsedColumn
from rich.text import Text

from jaxsusp.comparison import Event


class Pace:
    """How fast a comparison gets on, from the events it is told.

    Args:
        clock: seconds from any origin.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic):
        self._clock = clock
        self._start = clock()
        self._done = 0
        self._computed = 0  # what was there before is not
        self._total = 0
        self._mark: tuple[float, int] | None = None  # first chunk of this algorithm: time and done
        self.rate: float | None = None  # fitness evaluations per second, without compilation

    def told(self, event: Event) -> None:
        """Take an event into account."""
        now = self._clock()
        if event.phase in ("running", "finished"):
            self._computed += event.done - self._done
        if event.phase == "compiling":
            self._mark = None
        elif event.phase == "running" and self._mark is None:
            self._mark = now, event.done
        elif event.phase == "running" and self._mark is not None and now > self._mark[0]:
            self.rate = (event.done - self._mark[1]) / (now - self._mark[0])
        self._done, self._total = event.done, event.total

    @property
    def elapsed(self) -> float:
        """Seconds so far."""
        return self._clock() - self._start

    @property
    def remaining(self) -> float | None:
        """Seconds to go if compilation and computation go on in the same proportion."""
        if not self._computed:
            return None
        return self.elapsed * (self._total - self._done) / self._computed


class ProgressBar:
    """Context manager that shows progress; `told` is the callback for `jaxsusp.compare`."""

    def __init__(self, console: Console):
        self.finished: list[str] = []
        self._pace = Pace()
        self._console = console
        self._bar = _bar(console) if console.is_terminal else None
        self._task = self._bar.add_task("starting", eta=None, rate=None) if self._bar else None

    def __enter__(self) -> Self:
        if self._bar:
            self._bar.start()
        return self

    def __exit__(self, *_) -> None:
        self.stop()

    def stop(self) -> None:
        """Remove the bar."""
        if self._bar:
            self._bar.stop()

    def told(self, event: Event) -> None:
        """Show an event."""
        self._pace.told(event)
