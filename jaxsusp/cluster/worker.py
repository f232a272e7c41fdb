"""What runs in the process of a worker; it decides itself whether it may do the work."""

import functools
import pickle
import socket
import threading
from contextlib import suppress
from importlib.metadata import version
from typing import Any, NamedTuple

from jaxsusp._cache import code_digest

DECISIVE = ("jaxsusp", "jax", "jaxlib")
"""Packages whose version decides what is computed."""


class Software(NamedTuple):
    """What has to be equal everywhere, so that it does not matter who does a piece of work."""

    versions: tuple[tuple[str, str], ...]
    code: str  # of this package: a checkout changes under one version

    def difference(self, other: "Software") -> str:
        """The first thing in which another process differs, in words; "" if it does not."""
        for (name, mine), (_, theirs) in zip(self.versions, other.versions, strict=True):
            if mine != theirs:
                return f"{name} {theirs} instead of {mine}"
        if self.code != other.code:
            return f"other code under the same version of jaxsusp, {dict(self.versions)['jaxsusp']}"
        return ""


class Done(NamedTuple):
    """What a job returned, or why it was not done."""

    result: Any
    host: str
    refused: str = ""  # what is wrong with this worker


@functools.cache
def software() -> Software:
    """That of this process, as it was when it was asked first: whoever began a study may end it."""
    return Software(tuple((name, version(name)) for name in DECISIVE), code_digest("."))


def held(shared: bytes) -> bytes:
    """A task of its own, so that what is lost with a worker is sent to another one again."""
    return shared


def carry_out(expected: Software, shared: bytes, job: bytes) -> Done:
    """Do a job, one at a time in a process: it uses all devices that there are.

    Args:
        expected: the software of whoever asks.
        shared: pickled: another version could not even read it.
        job: pickled, the function and its other arguments.
    """
    host = socket.gethostname()
    if wrong := expected.difference(software()):
        return Done(None, host, wrong)
    with _ALONE:
        from jaxsusp.optim import devices

        with suppress(RuntimeError):  # a process that has computed before keeps its devices
            devices.configure()
        try:
            (work, arguments), common = pickle.loads(job), pickle.loads(shared)
        except Exception as error:  # most often a module of the person's own
            return Done(None, host, f"what it is to do cannot be loaded there: {error}")
        return Done(work(common, *arguments), host)


_ALONE = threading.Lock()
