"""Numbers and lists in sentences."""

from collections.abc import Sequence

from jaxsusp.report.render import significant

ROUNDING = 1e-7
"""Magnitude below which a number that is told with its sign is none."""


def listed(parts: Sequence[str], nothing: str = "none") -> str:
    """One, two and three: "a, b and c"."""
    if not parts:
        return nothing
    *front, last = parts
    return f"{', '.join(front)} and {last}" if front else last


def signed(number: float, digits: int = 2) -> str:
    """A number with its sign, a true minus; what is rounding alone is 0."""
    if abs(number) < ROUNDING:
        return "0"
    sign = "−" if number < 0 else "+"
    return sign + significant(abs(number), digits)


def between(low: float, high: float, digits: int = 2) -> str:
    """An interval in a sentence."""
    return f"{signed(low, digits)} to {signed(high, digits)}"


def counted(number: int, what: str) -> str:
    """So many of something: "1 pair", "no pairs", "3 pairs"."""
    return f"{number or 'no'} {what}{'s' * (number != 1)}"


def winners(names: Sequence[str], what: str, order: Sequence[str]) -> str:
    """Who has something how often, most often first: "PSO has the least in 4, GA in 1".

    Args:
        names: the winner of each case.
        what: they win.
        order: of all names, which settles ties.
    """
    first, *others = sorted(set(names), key=lambda name: (-names.count(name), order.index(name)))
    told = [f"{first.upper()} has {what} in {names.count(first)}"]
    return ", ".join([*told, *(f"{name.upper()} in {names.count(name)}" for name in others)])


def bulleted(answer: str, *parts: str) -> str:
    """A sentence that answers, and a Markdown list of what it rests on."""
    return "\n".join([answer, "", *(f"- {part}" for part in parts if part)])
