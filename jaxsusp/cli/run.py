"""All commands in the order of `jaxsusp --help`, and how they fail."""

from jaxsusp.cli.application import app, fail
from jaxsusp.cli.commands import compare, freespace, listing, plan, show, verify, workspace  # noqa: F401  commands
from jaxsusp.errors import InputError


def run() -> None:
    """Run a command: bad input becomes one message and status 2, never a traceback."""
    try:
        app()
    except InputError as error:
        fail(str(error))
    except OSError as error:
        if error.errno is None:  # no answer of the system but a fault of ours
            raise
        place = error.filename or "a file"
        fail(f"{place}: {error.strerror}; give a place that can be read and written")
