"""A real scheduler and real workers on loopback."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
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


@contextmanager
def _started(folder: Path, options: Sequence[str] = ()) -> Iterator[Daemons]:
    file = folder / "scheduler.json"
    quiet = ("--no-dashboard", "--scheduler-file", str(file), *options)
    processes = [_dask("scheduler", "--host", "127.0.0.1", "--port", "0", *quiet)]

    def start_worker(**environment: str) -> subprocess.Popen:
        local = ("--local-directory", str(file.parent))
        once = ("--no-nanny", "--nthreads", "1", "--death-timeout", "60", *local)
        processes.append(_dask("worker", *once, *quiet, **environment))
        return processes[-1]

    try:
        while not file.exists() or not file.read_text().strip():
            assert processes[0].poll() is None, "the scheduler ended"
            time.sleep(0.05)
        yield Daemons(file, start_worker, processes)
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.fixture
def daemons(tmp_path_factory) -> Iterator[Daemons]:
    """A scheduler; workers are started by the test."""
    with _started(tmp_path_factory.mktemp("dask")) as found:
        yield found


class Certificate(NamedTuple):
    """Signed by itself: who trusts it trusts nobody else."""

    cert: Path
    key: Path


@pytest.fixture(scope="session")
def certify(tmp_path_factory) -> Callable[[str], Certificate]:
    """Makes certificates by name."""
    if shutil.which("openssl") is None:
        pytest.skip("no openssl here")
    folder = tmp_path_factory.mktemp("certificates")

    def made(name: str) -> Certificate:
        found = Certificate(folder / f"{name}.pem", folder / f"{name}.key")
        curve = ("-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-noenc")
        files = ("-keyout", found.key, "-out", found.cert)
        about = ("-subj", f"/CN={name}", "-addext", "subjectAltName=IP:127.0.0.1", "-days", "2")
        command = ["openssl", "req", "-x509", *curve, *files, *about]
        subprocess.run(command, check=True, capture_output=True)
        return found

    return made


@pytest.fixture
def guarded(tmp_path_factory, certify) -> Iterator[tuple[Daemons, Certificate]]:
    """A scheduler that speaks TLS alone, and whom it trusts."""
    ours = certify("ours")
    options = ("--tls-ca-file", ours.cert, "--tls-cert", ours.cert, "--tls-key", ours.key)
    speaks = ("--protocol", "tls", *map(str, options))
    with _started(tmp_path_factory.mktemp("tls"), speaks) as found:
        yield found, ours
