"""Things that show themselves in a notebook and do not know how: drawing is for a later room.

`jaxsusp/__init__.py`, which knows all rooms, says who draws.
"""

from collections.abc import Callable
from typing import Any


def _plainly(thing: Any) -> str | None:
    """Nothing: a notebook then shows the text of `repr`."""
    return None


drawn: Callable[[Any], str | None] = _plainly
"""HTML of a thing, a small table and a picture."""


def draw_with(draw: Callable[[Any], str | None]) -> None:
    """Say who draws from now on."""
    global drawn
    drawn = draw


class Shown:
    """Base of what a notebook shows as a small table and a picture."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        return drawn(self)
