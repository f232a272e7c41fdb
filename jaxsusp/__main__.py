"""`python -m jaxsusp` is the command line."""

from jaxsusp.cli.main import main

main()
