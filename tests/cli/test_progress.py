"""The pace that a progress bar shows."""

import pytest

from jaxsusp.cli.progress import Pace
from jaxsusp.comparison.compare import Event


@pytest.mark.fast
def test_pace_counts_neither_compilation_nor_what_was_there():
    now = [0.0]
    pace = Pace(lambda: now[0])

    def told(time, phase, done, compilations):
        now[0] = time
        pace.told(Event("ga", phase, done, 100_000, compilations))
        return pace.rate, pace.elapsed, pace.left

    assert told(0, "resumed", 40_000, 2) == ("", "0:00:00", "")
    assert told(1, "compiling", 40_000, 2) == ("", "0:00:01", "")
    assert told(11, "running", 41_000, 1) == ("", "0:00:11", "")
    assert told(12, "running", 45_000, 1) == ("4k evals/s", "0:00:12", "0:00:24 left")
    assert told(16, "finished", 60_000, 1) == ("4k evals/s", "0:00:16", "0:00:20 left")
    assert told(16, "compiling", 60_000, 1) == ("4k evals/s", "0:00:16", "0:00:20 left")
    assert told(37, "running", 80_000, 0)[2] == "0:00:05 left"
    now[0] = 50.0
    assert pace.left == "0:00:00 left"
