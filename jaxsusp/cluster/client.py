"""The one module that submits work: jobs to a Dask scheduler, and what becomes of them.

A worker that dies is replaced by another one, which does its job again. Nothing that is returned
depends on who did it: whoever has other software is refused.
"""

import asyncio
import logging
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent import futures
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import cloudpickle
from distributed import Client, LocalCluster, wait
from distributed.client import Future
from distributed.scheduler import KilledWorker
from distributed.security import Security

from jaxsusp.cluster.choices import ClusterError, Place
from jaxsusp.cluster.jobs import Job
from jaxsusp.cluster.worker import Done, Software, carry_out, held, software
from jaxsusp.optim.devices import cores

CANCELLED = (asyncio.CancelledError, futures.CancelledError)
"""What Dask raises of tasks that went with their scheduler."""

ANSWER = 10.0
"""Seconds in which a scheduler has to answer."""

PATIENCE = 60.0
"""Seconds without any worker that may do the work, after which there is nothing to wait for."""

LOOK = 1.0
"""Seconds between two looks at who is still there."""

KEPT = "what was finished is kept; go on with resume when workers are there again"


@contextmanager
def connected(
    place: Place | Client, told: Callable[[str], None] = lambda message: None
) -> Iterator["Cluster"]:
    """The workers of a place; those of this machine are started, and ended afterwards.

    Args:
        place: a scheduler, a number of workers, or a client, which stays connected.
        told: called with a sentence where something deserves a person's attention.

    Raises:
        ClusterError: no scheduler answers, or none of its workers can do the work.
    """
    if isinstance(place, Client):
        yield Cluster(place, told)
        return
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # we say it ourselves
    if place.workers is None:
        with _of_a_scheduler(place) as client:
            yield Cluster(client, told)
        return
    told(f"starting {place.workers} worker{'s' if place.workers > 1 else ''} on this machine")
    with (
        _of_this_machine(place.workers) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        yield Cluster(client, told)


def _of_a_scheduler(place: Place) -> Client:
    """Connect, with certificates where they are given."""
    assert place.scheduler is not None
    file = Path(place.scheduler)
    if file.suffix == ".json" and not file.is_file():
        raise ClusterError(
            f"scheduler = {file}: no such file; give what `dask scheduler --scheduler-file` wrote, "
            "or an address such as tcp://HOST:8786"
        )
    where: dict[str, Any] = (
        {"scheduler_file": str(file)} if file.is_file() else {"address": place.scheduler}
    )
    security = None
    if place.tls_ca or place.tls_cert:
        security = Security(
            tls_ca_file=place.tls_ca and str(place.tls_ca),
            tls_client_cert=place.tls_cert and str(place.tls_cert),
            tls_client_key=str(place.tls_key or place.tls_cert),
            require_encryption=True,
        )
    try:
        return Client(**where, security=security, timeout=ANSWER, set_as_default=False)
    except (OSError, TimeoutError, ValueError, TypeError, RuntimeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ClusterError(
            f"scheduler = {place.scheduler!r}: no Dask scheduler answers there ({reason}); start "
            "one with `dask scheduler`, give its address such as tcp://HOST:8786, or workers for "
            "processes of this machine"
        ) from error


def _of_this_machine(workers: int) -> LocalCluster:
    """Processes that share the cores, and leave Ctrl-C to us."""
    share = str(max(1, cores() // workers))
    return LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        processes=True,
        memory_limit=None,
        dashboard_address="127.0.0.1:0",
        silence_logs=logging.CRITICAL,
        env={"JAX_NUM_CPU_DEVICES": share},
        preload=["jaxsusp.cluster.deaf"],
    )


class Cluster:
    """Workers that are there, and those that come.

    Args:
        client: connected to a scheduler; it stays the caller's.
        told: see `connected`.
    """

    def __init__(self, client: Client, told: Callable[[str], None] = lambda message: None):
        self.client, self.told = client, told
        self.expected: Software = software()
        self.refused: dict[str, str] = {}  # by address
        self._seen, self._waiting = False, False
        self._introduce()

    @property
    def workers(self) -> list[str]:
        """Addresses of those that may do the work."""
        known = self.client.scheduler_info(n_workers=-1)["workers"]
        return [address for address in known if address not in self.refused]

    def _introduce(self) -> None:
        """Ask everybody who is there for their software, and refuse by name who has another."""
        there: Any = self.client.run(software, on_error="return")
        self._seen = bool(there)
        for address, answer in there.items():
            if isinstance(answer, Software):
                wrong = self.expected.difference(answer)
            else:
                wrong = f"jaxsusp cannot be loaded there: {answer}"
            if wrong:
                self._refuse(address, wrong)
        self._require_somebody()
        if many := len(self.workers):
            who = f"{many} workers do" if many > 1 else "1 worker does"
            self.told(f"{who} the work; what is finished is told, compiling is not")

    def _wait_for_the_first(self) -> None:
        """Say once that nothing goes on yet: workers of a queue can take hours to come."""
        if not self._waiting:
            self._waiting = True
            self.told("no worker is there yet; the work begins when one comes")

    def _refuse(self, address: str, wrong: str) -> None:
        if address not in self.refused:
            self.refused[address] = wrong
            self.told(f"worker {address} is not used: {wrong}")

    def _require_somebody(self) -> None:
        """While nobody has come yet there is hope; not when all who came are refused."""
        if self.refused and not self.workers:
            reasons = "; ".join(f"{where}: {why}" for where, why in self.refused.items())
            raise ClusterError(
                f"workers: none of them can be used ({reasons}); give all of them the software of "
                f"this process, {_told(self.expected)}, and whatever module the work needs"
            )

    def run(self, jobs: Sequence[Job]) -> Generator[tuple[int, Any], None, None]:
        """Have jobs done; their numbers and what they returned, in the order they finish.

        When the caller stops asking, or is interrupted, the rest is cancelled on the cluster.

        Raises:
            ClusterError: scheduler or workers are lost for good.
            Exception: what a job raised.
        """
        shared: dict[int, Future] = {}
        numbers: dict[Future, int] = {}

        def submit(number: int) -> None:
            job = jobs[number]
            if id(job.shared) not in shared:
                content = cloudpickle.dumps(job.shared)
                shared[id(job.shared)] = self.client.submit(held, content, pure=False)
            future = self.client.submit(
                carry_out, self.expected, shared[id(job.shared)],
                cloudpickle.dumps((job.work, job.arguments)),
                workers=self.workers if self.refused else None, pure=False,
            )  # fmt: skip
            numbers[future] = number

        try:
            for number in range(len(jobs)):
                submit(number)
            while numbers:
                for future in self._finished(numbers):
                    done = self._outcome(future, jobs[numbers[future]])
                    if done is None:
                        continue
                    number = numbers.pop(future)
                    future.release()
                    if done.refused:
                        self._require_somebody()
                        submit(number)
                    else:
                        yield number, done.result
        finally:
            with suppress(Exception):  # of a scheduler that is gone there is nothing to cancel
                self.client.cancel([*numbers, *shared.values()], force=True)

    def _finished(self, numbers: dict[Future, int]) -> list[Future]:
        """Wait until one of them has ended, as long as there is anybody to end it."""
        since = time.monotonic()
        while True:
            try:
                with self.client.as_current():
                    ended: Any = wait([*numbers], timeout=LOOK, return_when="FIRST_COMPLETED")
                return list(ended.done)
            except TimeoutError:
                pass
            except (*CANCELLED, OSError) as error:
                raise self._lost("the scheduler is gone") from error
            if self.client.status != "running":
                raise self._lost("the scheduler is gone")
            if self.workers:
                since, self._seen = time.monotonic(), True
            elif not self._seen:
                self._wait_for_the_first()
            elif time.monotonic() - since > PATIENCE:
                raise self._lost(f"no worker has been there for {PATIENCE:.0f} s")

    def _outcome(self, future: Future, job: Job) -> Done | None:
        """What a job came to, or its failure as one sentence; None: it is to be done again.

        A result that its worker had no time to hand over is lost with it.
        """
        try:
            done: Done = future.result(timeout=ANSWER)
        except KilledWorker as error:
            raise ClusterError(
                f"{job.name}: the workers that took it died one after another (memory?); {KEPT}"
            ) from error
        except TimeoutError:
            return None
        except (*CANCELLED, OSError) as error:
            raise self._lost("the scheduler is gone") from error
        if done.refused:
            where: Any = self.client.who_has([future])
            for address in where.get(future.key, ()):
                self._refuse(address, f"{done.refused} (on {done.host})")
        return done

    def _lost(self, what: str) -> ClusterError:
        return ClusterError(f"scheduler: {what}; {KEPT}")


def _told(expected: Software) -> str:
    return ", ".join(f"{name} {number}" for name, number in expected.versions)
