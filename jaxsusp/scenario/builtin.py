"""Scenarios that come with the package, and files by name: found and read, not yet understood.

Light to import: a name that does not exist is told before anything heavy is loaded.
"""

import difflib
import os
from pathlib import Path

from jaxsusp.errors import ScenarioError

_DATA = Path(__file__).parent / "data"

FEWEST, MOST = 3, 12
"""Robots on the ring of a new scenario."""


def scenarios() -> tuple[str, ...]:
    """Names of the built-in benchmark scenarios."""
    return tuple(_built_in("scenarios"))


def examples() -> tuple[str, ...]:
    """Names of the other built-in scenarios: more robots, other drive modes and attachments."""
    return tuple(_built_in("examples"))


def find(name_or_path: str | os.PathLike[str]) -> Path:
    """The file of a built-in scenario or example by its name, or the path of any other."""
    given = os.fspath(name_or_path)
    built_in = {**_built_in("scenarios"), **_built_in("examples")}
    return built_in.get(given, Path(given))


def _built_in(folder: str) -> dict[str, Path]:
    """Built-in files by name, in order."""
    return {path.stem: path for path in sorted((_DATA / folder).glob("*.toml"))}


def read(path: Path) -> str:
    """The text of a scenario file.

    Raises:
        ScenarioError: there is no such file, or it is no text.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise ScenarioError(_not_found(path)) from None
    except IsADirectoryError:
        raise ScenarioError(f"{path}: is a folder; give a TOML file in it") from None
    except (OSError, ValueError) as error:  # ValueError: a name no file system takes
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"{path}: cannot be read ({reason}); give a TOML file") from error
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ScenarioError(f"{path}: line {line} is not UTF-8; save the file as UTF-8") from None


def _not_found(path: Path) -> str:
    near = difflib.get_close_matches(path.name, (*scenarios(), *examples()), n=1)
    hint = f'did you mean "{near[0]}"? ' if near else ""
    return (
        f"{path}: is neither a file nor a built-in scenario; {hint}"
        "`jaxsusp scenarios` lists those, or give the path of a TOML file"
    )
