"""Loaded by workers of this machine: Ctrl-C in their terminal is for who employs them alone."""

import signal
import threading


def dask_setup(worker) -> None:
    """Called by Dask when a worker starts."""
    del worker
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
