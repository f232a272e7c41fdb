"""A real scheduler and real workers on loopback."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

SMALL = Path(__file__).parents[1] / "comparison"  # optimisers of tests, which workers must have
sys.path.append(str(SMALL))


class Daemons(NamedTuple):
    """What was started."""

    file: Path  # of the scheduler
    start_worker: Callable[..., subprocess.Popen]
    processes: list[subprocess.Popen]  # the scheduler first

    @property
    def address(self) -> str:
        """Of the scheduler."""
        return json.loads(self.file.read_text())["address"]


def _dask(*arguments: str, **environment: str) -> subprocess.Popen:
    command = [sys.executable, "-m", "dask", *arguments]
    path = os.pathsep.join([str(SMALL), os.getcwd(), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen(
        command,
        env=os.environ | {"PYTHONPATH": path, "JAX_NUM_CPU_DEVICES": "1"} | environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


@pytest.fixture
def daemons(tmp_path_factory) -> Iterator[Daemons]:
    """A scheduler; workers are started by the test."""
    file = tmp_path_factory.mktemp("dask") / "scheduler.json"
    quiet = ("--no-dashboard", "--scheduler-file", str(file))
    processes = [_dask("scheduler", "--host", "127.0.0.1", "--port", "0", *quiet)]

    def start_worker(**environment: str) -> subprocess.Popen:
        local = ("--local-directory", str(file.parent))
        options = ("--no-nanny", "--nthreads", "1", "--death-timeout", "60", *local)
        processes.append(_dask("worker", *options, *quiet, **environment))
        return processes[-1]

    while not file.exists() or not file.read_text().strip():
        assert processes[0].poll() is None, "the scheduler ended"
        time.sleep(0.05)
    try:
        yield Daemons(file, start_worker, processes)
    finally:
        for process in processes:
            process.kill()
            process.wait()
