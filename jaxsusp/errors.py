"""What the library raises when it is asked for something it cannot do."""

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Bad input: one clear message with the field, the value and the remedy.

    The command line prints the message alone and exits with status 2.
    """


class ScenarioError(InputError):
    """A scenario that cannot be used, with one line per problem in `problems`."""

    def __init__(self, *problems: str):
        super().__init__(*problems)
        self.problems = problems

    def __str__(self) -> str:
        return "\n".join(self.problems)


def require(condition: bool, message: str) -> None:
    """Raise an `InputError` unless the condition holds."""
    if not condition:
        raise InputError(message)


def require_count(name: str, value: int, least: int = 1, most: int | None = None) -> None:
    """Refuse a count that is no whole number, too small or too large."""
    whole = isinstance(value, int) and not isinstance(value, bool)
    allowed = f"of at least {least}" if most is None else f"from {least} to {most}"
    fits = whole and least <= value and (most is None or value <= most)
    require(fits, f"{name} = {value!r}: give a whole number {allowed}")


def require_counts(**counts: int) -> None:
    """Refuse counts, given by their names, that are no whole numbers of at least 1."""
    for name, value in counts.items():
        require_count(name, value)


def require_seed(seed: int) -> None:
    """Refuse a seed that JAX would cut to 32 bits, so that two seeds would be the same one."""
    require_count("seed", seed, least=0, most=2**32 - 1)


def require_known(name: str, value: str, known: Iterable[str]) -> None:
    """Refuse a name that is not among the known ones, suggesting the nearest."""
    known = sorted(known)
    if value in known:
        return
    spelt = {each.lower(): each for each in known}
    near = difflib.get_close_matches(str(value).lower(), spelt, n=1)
    hint = f'did you mean "{spelt[near[0]]}"? ' if near else ""
    raise InputError(f"{name} = {value!r} is not known; {hint}choose from {', '.join(known)}")


def require_label(name: str, value: str) -> None:
    """Refuse a name that cannot label results: empty, or with control characters."""
    require(
        value.isprintable() and value.strip() != "",
        f"{name} = {value!r}: give a name of printable characters, on one line",
    )
