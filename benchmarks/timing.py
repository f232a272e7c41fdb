"""How times are taken: compile first, wait for the result, least of several."""

import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import jax


def least_seconds(work: Callable[[], Any], repeats: int = 7, inner: int = 1) -> float:
    """Least time of one call over several repeats of `inner` calls, after a first one."""
    jax.block_until_ready(work())
    times = []
    for _ in range(repeats):
        clock = time.perf_counter()
        for _ in range(inner):
            found = work()
        jax.block_until_ready(found)
        times.append((time.perf_counter() - clock) / inner)
    return min(times)


class Process(NamedTuple):
    """A finished child process."""

    seconds: float
    peak_bytes: int


def run_process(*arguments: str, folder: Path) -> Process:
    """Wall time and peak memory of `python -m jaxsusp …`; what it keeps is kept in `folder`."""
    clock = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "jaxsusp", *arguments, "--output", str(folder)],
        env=os.environ | {"JAXSUSP_CACHE": str(folder / "cache")},
        check=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    seconds = time.perf_counter() - clock
    return Process(seconds, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)
