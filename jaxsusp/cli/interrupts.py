"""Ctrl-C at any moment: one line and status 130, with nothing that finished lost.

Two moments are bad ones for the `KeyboardInterrupt` of Python. JAX runs a callback in every garbage
collection, where exceptions are printed and forgotten; and modules that are interrupted while they
are loaded are left in halves, which other code then stumbles over. An interrupt that comes there
waits for a better moment; while nothing but loading has been done, the process ends at once.
"""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

RETRY = 0.05
"""s until an interrupt that came at a bad moment is tried again."""

_working = False


def working() -> None:
    """From now on there is something to lose: the process is not ended without being asked."""
    global _working
    _working = True


@contextmanager
def heard() -> Iterator[None]:
    """Let no Ctrl-C get lost."""
    global _working
    before = signal.getsignal(signal.SIGINT)
    if before is not signal.SIG_IGN:  # as for a job in the background of a script
        signal.signal(signal.SIGINT, _handle)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        _working = False


def _handle(_, frame: FrameType | None) -> None:
    loading = _is_loading(frame)
    if loading and not _working:
        os.write(sys.stderr.fileno(), b"Interrupted.\n")
        os._exit(130)
    if loading or (frame is not None and frame.f_code.co_name == "_xla_gc_callback"):
        # To the main thread, so that it also wakes from a sleep.
        arguments = [threading.main_thread().ident, signal.SIGINT]
        again = threading.Timer(RETRY, signal.pthread_kill, arguments)
        again.daemon = True
        again.start()
        return
    raise KeyboardInterrupt


def _is_loading(frame: FrameType | None) -> bool:
    """Whether a module is being imported somewhere up the stack."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False
