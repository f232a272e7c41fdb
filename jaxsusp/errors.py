"""What the library raises when it is asked for something it cannot do."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Bad input: one clear message with the field, the value and the remedy.

    The command line prints the message alone and exits with status 2.
    """


def require(condition: bool, message: str) -> None:
    """Raise an `InputError` unless the condition holds."""
    if not condition:
        raise InputError(message)


def require_count(name: str, value: int, least: int = 1) -> None:
    """Refuse a count that is no whole number or too small."""
    whole = isinstance(value, int) and not isinstance(value, bool)
    require(whole and value >= least, f"{name} = {value!r}: give a whole number of at least {least}")


def require_known(name: str, value: str, known: Iterable[str]) -> None:
    """Refuse a name that is not among the known ones, suggesting the nearest."""
    known = sorted(known)
    if value in known:
        return
    near = difflib.get_close_matches(str(value), known, n=1)
    hint = f'did you mean "{near[0]}"? ' if near else ""
    raise InputError(f"{name} = {value!r} is not known; {hint}choose from {', '.join(known)}")
