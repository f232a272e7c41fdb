"""A progress bar for a comparison: share, rate and remaining time, on stderr.

The bar is told once per chunk of iterations (20 times per algorithm), which costs nothing that can
be measured.
"""

from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from jaxsusp.comparison import Event


class _Rate(ProgressColumn):
    """Fitness evaluations per second."""

    def render(self, task: Task) -> Text:
        speed = task.finished_speed or task.speed
        return Text("" if speed is None else f"{speed / 1e3:,.0f} k evaluations/s")


class ProgressBar:
    """Context manager around a bar; `told` is the callback for `jaxsusp.compare`."""

    def __init__(self, console: Console):
        self.finished: list[str] = []
        self._progress = Progress(
            TextColumn("{task.description:<18}"),
            BarColumn(),
            TextColumn("{task.percentage:>3.0f} %"),
            _Rate(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=console,
            transient=True,
        )
        self._task = self._progress.add_task("starting")

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, *_) -> None:
        self.stop()

    def stop(self) -> None:
        """Remove the bar."""
        self._progress.stop()

    def told(self, event: Event) -> None:
        """Show an event."""
        if event.phase in ("finished", "resumed"):
            self.finished.append(event.algorithm)
        text = f"{event.algorithm} ({event.phase})" if event.phase != "running" else event.algorithm
        self._progress.update(
            self._task, description=text, completed=event.done, total=event.total
        )
