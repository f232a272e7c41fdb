"""What is kept for the next time: where, by what it is known, and how much of it.

Free spaces and compiled programs take seconds to make and milliseconds to read. Several processes
may read, write and remove at once: what is gone or damaged is made anew.
"""

import functools
import hashlib
import math
import os
import re
import secrets
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from platformdirs import user_cache_path

from jaxsusp.errors import InputError

CACHE, NO_CACHE = "JAXSUSP_CACHE", "JAXSUSP_NO_CACHE"
"""Environment variables: another folder than the user's (empty: nothing is kept), and, set to
anything but 0, that nothing is kept."""

KINDS = {
    "free-space": "free spaces",
    "compiled": "compiled programs",
    "pieces": "convex pieces of meshes",
}
"""Folders, and what is in them."""

_OURS = re.compile(r"[0-9a-f]{32}\.(nc|npz|program)|jit_.*-(cache|atime)")
"""Names of files that are kept; nothing else is ever removed."""

LIMIT = 2**30
"""Bytes that are kept of each kind; what was used longest ago makes way."""


_PACKAGE = Path(__file__).parent
_LOADED = time.time()  # s since 1970
_ALONE = secrets.token_hex(8)  # of this process
_TOLD: list[Path] = []  # where nothing can be kept


class Kept(NamedTuple):
    """One kind of what is kept."""

    kind: str
    files: int
    size: int  # bytes


def cache_folder(kind: str) -> Path | None:
    """Where a kind of `KINDS` is kept; None where nothing is to be kept."""
    given = os.environ.get(CACHE)
    if given == "" or os.environ.get(NO_CACHE, "0") not in ("", "0"):
        return None
    return (Path(given) if given else user_cache_path("jaxsusp")) / kind


@contextmanager
def keeping(file: Path) -> Iterator[None]:
    """Keep a file for the next time; what cannot be kept costs time then.

    The first time that it cannot, a process warns.
    """
    try:
        yield
        drop_oldest(file.parent)
    except (OSError, InputError) as error:
        if not _TOLD:
            _TOLD.append(file)
            warnings.warn(
                f"{file.parent}: nothing can be kept there ({_reason_of(error)}), so the same will "
                f"take as long next time; make room, name another folder in {CACHE}, or set "
                f"{NO_CACHE}=1",
                stacklevel=3,
            )


def _reason_of(error: Exception) -> str:
    """What the system says of a file."""
    cause = error.__cause__ if isinstance(error, InputError) else error
    return getattr(cause, "strerror", None) or str(error)


def drop_oldest(folder: Path, limit: int = LIMIT) -> None:
    """Remove what was used longest ago until no more than so many bytes are left."""
    found = sorted(_files(folder))
    left = sum(size for _, size, _ in found)
    for _, size, file in found:
        if left <= limit:
            return
        file.unlink(missing_ok=True)
        left -= size


def used(file: Path) -> None:
    """Note that a file was of use, so that it stays."""
    with suppress(OSError):
        os.utime(file)


def contents() -> list[Kept]:
    """What there is of every kind."""
    found = []
    for kind in KINDS:
        folder = cache_folder(kind)
        sizes = [size for _, size, _ in _files(folder)] if folder else []
        found.append(Kept(kind, len(sizes), sum(sizes)))
    return found


def clear() -> None:
    """Remove all of it.

    Raises:
        OSError: a file cannot be removed.
    """
    for kind in KINDS:
        if folder := cache_folder(kind):
            for _, _, file in _files(folder):
                file.unlink(missing_ok=True)


def code_digest(*rooms: str) -> str:
    """What the code of some rooms of the package is: another one would compute something else.

    Of code that was changed after it was loaded nobody can tell any more what runs here: what this
    process makes then is of use to no other one, and nothing of others to it.
    """
    alone = _ALONE if _last_change() > _LOADED else ""
    return _digest_of(*rooms) + alone


@functools.cache
def _digest_of(*rooms: str) -> str:
    digest = hashlib.sha256()
    for room in rooms:
        for file in sorted((_PACKAGE / room).rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _last_change() -> float:
    """When a file of the package was last changed (s since 1970): asked before every search."""
    try:
        return max(os.stat(file).st_mtime for file in _sources(_PACKAGE))
    except FileNotFoundError:
        return math.inf


@functools.cache
def _sources(package: Path) -> list[str]:
    return [os.fspath(file) for file in package.rglob("*.py")]


def _files(folder: Path) -> Iterator[tuple[float, int, Path]]:
    """Every file with the time of its last use (s) and its size (bytes)."""
    for file in folder.rglob("*"):
        with suppress(FileNotFoundError):  # another process removed it
            stat = file.stat()
            if _OURS.fullmatch(file.name) and file.is_file():
                yield stat.st_mtime, stat.st_size, file
