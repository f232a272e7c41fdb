"""The command line: parse, call the library, write. Results on stdout, progress on stderr.

One file per command or pair of commands. Exit status: 0 when it completed, 1 where the answer is
"infeasible", 2 for bad input, 130 when interrupted.
"""

from jaxsusp.cli import compare as compare
from jaxsusp.cli import freespace as freespace
from jaxsusp.cli import listing as listing
from jaxsusp.cli import plan as plan
from jaxsusp.cli import verify as verify
from jaxsusp.cli import workspace as workspace
from jaxsusp.cli.application import app, fail
from jaxsusp.errors import InputError


def main() -> None:
    """Entry point: bad input becomes one message and status 2, never a traceback."""
    try:
        app()
    except InputError as error:
        fail(str(error))
    except OSError as error:
        if error.errno is None:  # no answer of the system but a fault of ours
            raise
        place = error.filename or "a file"
        fail(f"{place}: {error.strerror}; give a place that can be read and written")
