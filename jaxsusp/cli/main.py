"""The entry point."""

import io
import os
import sys
import threading

from jaxsusp.cli.interrupts import heard
from jaxsusp.planning.choices import AHEAD


def main() -> None:
    """Run a command of the command line."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a sign that it cannot write ends no command
            stream.reconfigure(errors="replace")
    with heard():
        from jaxsusp.cli.run import run  # loading them can be interrupted too

        try:
            run()
        except SystemExit as end:
            _leave(end)
            raise


def _leave(end: SystemExit) -> None:
    """Wait for no program that is being compiled ahead: nobody needs it any more."""
    if any(thread.name == AHEAD for thread in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(end.code if isinstance(end.code, int) else end.code is not None)
