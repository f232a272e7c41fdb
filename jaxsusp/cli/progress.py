"""Progress of a comparison on stderr: a bar in a terminal, a line per algorithm anywhere else.

Progress is told once per chunk of iterations (20 times per algorithm), which costs nothing that
can be measured.
"""

import time
from collections.abc import Callable
from datetime import timedelta
from statistics import fmean

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from jaxsusp.comparison.events import Event

OFTEN = 60.0
"""Seconds between two lines about a study that goes on, outside of a terminal."""


_ENDS = ("kept", "finished")
"""What workers tell, who tell neither of compiling nor of running."""


class Pace:
    """How fast a comparison gets on, from the events it is told.

    Args:
        clock: seconds since any origin.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic):
        self._clock = clock
        self._start = self._compiling_since = clock()
        self._compilations: list[float] = []  # seconds of each
        self._first_chunk: tuple[float, int] | None = None  # when, and evaluations done then
        self._rate: float | None = None
        self._end: float | None = None  # when everything should be done

    def told(self, event: Event) -> None:
        """Take an event into account."""
        now = self._clock()
        if event.phase == "compiling":
            self._compiling_since, self._first_chunk = now, None
        elif event.phase == "running" or (event.phase in _ENDS and not self._compilations):
            if self._first_chunk is None:
                self._compilations.append(now - self._compiling_since)
                self._first_chunk = now, event.done
            since, before = self._first_chunk
            if now > since:
                self._rate = (event.done - before) / (now - since)
        if self._rate:
            compiling = event.compilations * fmean(self._compilations or [0.0])
            self._end = now + compiling + (event.total - event.done) / self._rate

    @property
    def rate(self) -> str:
        """Fitness evaluations per second while computing."""
        return "" if self._rate is None else f"{self._rate / 1e3:,.0f}k evals/s"

    @property
    def elapsed(self) -> str:
        """Time so far."""
        return _clock_time(self._clock() - self._start)

    @property
    def left(self) -> str:
        """Time to go if compiling and computing go on as they did."""
        return "" if self._end is None else f"{_clock_time(self._end - self._clock())} left"


def _clock_time(seconds: float) -> str:
    return str(timedelta(seconds=max(0, round(seconds))))


class _PaceColumn(ProgressColumn):
    def __init__(self, pace: Pace):
        super().__init__()
        self._pace = pace

    def render(self, task: Task) -> Text:
        del task
        return Text("  ".join(filter(None, (self._pace.rate, self._pace.elapsed, self._pace.left))))


class ProgressBar:
    """Context manager that shows progress; `told` is the callback for `jaxsusp.compare`."""

    def __init__(self, console: Console):
        self._kept: dict[str, str] = {}  # by algorithm, in words
        self._spoken = time.monotonic()
        self._console = console
        self._pace = Pace()
        self._bar = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=16),
            TextColumn("{task.percentage:>3.0f} %"),
            _PaceColumn(self._pace),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("starting")

    def __enter__(self) -> "ProgressBar":
        self._bar.start()
        return self

    def __exit__(self, *_) -> None:
        self._bar.stop()

    def told(self, event: Event) -> None:
        """Show an event."""
        if event.phase == "note":
            self._console.print(event.note, markup=False, highlight=False, soft_wrap=True)
            return
        self._pace.told(event)
        if event.phase == "kept":
            self._note_kept(event)
            return
        ended = event.phase in ("finished", "resumed")
        if ended:
            self._kept[event.algorithm] = event.algorithm
        if self._bar.disable:
            if ended:
                self._print_line(event)
            return
        text = event.algorithm if event.phase == "running" else f"{event.algorithm} {event.phase}"
        self._bar.update(self._task, description=text, completed=event.done, total=event.total)

    @property
    def kept(self) -> list[str]:
        """What an interrupt does not lose."""
        return [*self._kept.values()]

    def _note_kept(self, event: Event) -> None:
        """A chunk is finished; outside of a terminal a line about it now and then is enough."""
        self._kept[event.algorithm] = f"{event.runs} runs of {event.algorithm}"
        if self._bar.disable and time.monotonic() - self._spoken > OFTEN:
            self._spoken = time.monotonic()
            self._print_line(event)
        self._bar.update(self._task, completed=event.done, total=event.total)

    def drawing(self, name: str, number: int, count: int) -> None:
        """Show that one of so many random scenes is being drawn."""
        if self._bar.disable:
            self._console.print(f"drawing {name}", markup=False, highlight=False, soft_wrap=True)
        self._bar.update(self._task, description=f"drawing {name}", completed=number, total=count)

    def _print_line(self, event: Event) -> None:
        how = {"resumed": "was there already", "kept": f"has {event.runs} runs"}.get(
            event.phase, "finished"
        )
        share = f"{100 * event.done / event.total:.0f} % after {self._pace.elapsed}"
        left = self._pace.left if event.done < event.total else ""
        line = ", ".join(filter(None, (f"{event.algorithm} {how}: {share}", self._pace.rate, left)))
        self._console.print(line, markup=False, highlight=False, soft_wrap=True)
