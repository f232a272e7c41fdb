"""The entry point."""

import io
import sys

from jaxsusp.cli.interrupts import heard


def main() -> None:
    """Run a command of the command line."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a sign that it cannot write ends no command
            stream.reconfigure(errors="replace")
    with heard():
        from jaxsusp.cli.run import run  # loading them can be interrupted too

        run()
