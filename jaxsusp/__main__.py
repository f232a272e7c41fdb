"""`python -m jaxsusp` is the command line."""

from jaxsusp.cli import main

main()
