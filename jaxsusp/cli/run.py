"""All commands, and how they fail."""

import warnings

from jaxsusp.cli.application import app, fail, note
from jaxsusp.cli.commands import (  # noqa: F401  commands
    cache,
    check,
    compare,
    freespace,
    listing,
    new,
    plan,
    show,
    verify,
    workspace,
)  # fmt: skip
from jaxsusp.errors import InputError


def run() -> None:
    """Run a command: bad input becomes one message and status 2, never a traceback."""
    warnings.showwarning = lambda message, *where: note(str(message))
    try:
        app()
    except InputError as error:
        fail(str(error))
    except OSError as error:
        if error.errno is None:  # no answer of the system but a fault of ours
            raise
        place = error.filename or "a file"
        fail(f"{place}: {error.strerror}; give a place that can be read and written")
