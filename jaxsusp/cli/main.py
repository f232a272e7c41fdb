"""The entry point."""

from jaxsusp.cli.interrupts import heard


def main() -> None:
    """Run a command of the command line."""
    with heard():
        from jaxsusp.cli.run import run  # loading them can be interrupted too

        run()
