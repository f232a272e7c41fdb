"""Commands that run while the site is built: what a page shows is what they print.

    ```{run}
    :status: 1
    jaxsusp freespace walled.toml --output space
    ```

shows the command and its output; several lines are several commands. `{run} python` runs a
program. A run finds what the runs before it on the page wrote. Options:

    :anew:       begin in an empty folder
    :status: 1   the exit status to be expected, 0 if it is left out
    :stderr:     show also what is written to stderr
    :lines: 12   show at most so many lines of output, with 0 none

`{picture} FILE` shows a picture that a run before it wrote; its content is the caption. A command
with another status is a warning, which ends a strict build.

What a sequence of runs left is kept in `build/docs/runs/` under a key of the sequence and the
package: pages that begin alike share it, and nothing runs twice until something has changed.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "docs"
RUNS = BUILD / "runs"
WIDTH = 88
_logger = logging.getLogger(__name__)


@cache
def digest() -> str:
    """Of the whole package: when it changes, every output may."""
    found = hashlib.sha256()
    for path in sorted((ROOT / "jaxsusp").rglob("*")):
        if path.is_file() and path.suffix != ".pyc":
            found.update(path.read_bytes())
    return found.hexdigest()


def environment() -> dict[str, str]:
    """The commands of this environment first, plain text of a fixed width, and caches of ours."""
    own = {
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "COLUMNS": str(WIDTH),
        "NO_COLOR": "1",
        "TERM": "dumb",
        "JAXSUSP_CACHE": str(BUILD / "cache"),
        "JAX_COMPILATION_CACHE_DIR": str(BUILD / "cache" / "compiled"),
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0.3",
        "TF_CPP_MIN_LOG_LEVEL": "3",  # XLA's word on tuning hints is none about the output
    }
    return os.environ | own


class State(NamedTuple):
    """What a sequence of runs left."""

    key: str
    status: int = 0
    stdout: str = ""
    stderr: str = ""

    @property
    def folder(self) -> Path:
        """The files that the runs wrote."""
        return RUNS / self.key


EMPTY = State("")


def execute(command: list[str], before: State = EMPTY, status: int = 0) -> State:
    """Run a command where a sequence of runs left off, unless it has been done already.

    What ended with another status than expected is not kept.
    """
    key = hashlib.sha256("\n".join([before.key, digest(), *command]).encode()).hexdigest()[:16]
    kept = RUNS / f"{key}.json"
    if kept.exists():
        return State(**json.loads(kept.read_text(encoding="utf-8")))
    folder = RUNS / key
    shutil.rmtree(folder, ignore_errors=True)
    if before.key:
        shutil.copytree(before.folder, folder)
    folder.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(
        command, cwd=folder, env=environment(), text=True, capture_output=True, check=False
    )
    state = State(key, done.returncode, done.stdout, done.stderr)
    if state.status == status:
        kept.write_text(json.dumps(state._asdict()), encoding="utf-8")
    return state


def tidy(text: str) -> str:
    """Without blanks at the ends of lines, blank lines at the ends, and this machine's folders."""
    text = text.replace(f"{ROOT}{os.sep}", "").replace("python -m jaxsusp", "jaxsusp")
    lines = [line.rstrip() for line in text.splitlines()]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines).strip("\n"))


class Run(SphinxDirective):
    """`{run}`, see the top of this file."""

    has_content = True
    optional_arguments = 1
    option_spec = {  # noqa: RUF012  read by docutils
        "anew": directives.flag,
        "status": int,
        "stderr": directives.flag,
        "lines": directives.nonnegative_int,
    }

    def run(self) -> list[nodes.Node]:
        """What was typed, what came of it, and its pictures."""
        text = "\n".join(self.content)
        program = bool(self.arguments)
        command = [sys.executable, "-c", text] if program else ["bash", "-ec", text]
        before = EMPTY if "anew" in self.options else last(self)
        expected = self.options.get("status", 0)
        state = self.env.temp_data["last run"] = execute(command, before, expected)
        if state.status != expected:
            _logger.warning(
                "status %s of: %s\n%s", state.status, text, state.stderr,
                location=self.get_location(),
            )  # fmt: skip
        shown = (state.stderr if "stderr" in self.options else "") + state.stdout
        shown = tidy(shown.replace(f"{state.folder}{os.sep}", ""))
        most, lines = self.options.get("lines"), shown.splitlines()
        if most is not None and len(lines) > most:
            shown = "\n".join([*lines[:most], "…"]) if most else ""
        typed = text if program else "\n".join(f"$ {line}" for line in text.splitlines())
        found: list[nodes.Node] = [_literal(typed, "python" if program else "console", "typed")]
        if shown:
            found.append(_literal(shown, "text", "output"))
        return [nodes.container("", *found, classes=["run"])]


class Picture(SphinxDirective):
    """`{picture}`, see the top of this file."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """The picture, and what it shows."""
        path = last(self).folder / self.arguments[0]
        if not path.exists():
            _logger.warning("no picture %s", path, location=self.get_location())
            return []
        here = Path(self.env.doc2path(self.env.docname)).parent
        says = " ".join(self.content)
        image = nodes.image(uri=Path(os.path.relpath(path, here)).as_posix(), alt=says)
        caption = nodes.caption("", "", nodes.Text(f"{says}. "), nodes.literal("", path.name))
        return [nodes.figure("", image, caption)]


def last(directive: SphinxDirective) -> State:
    """What the runs before a directive on its page left."""
    return directive.env.temp_data.get("last run", EMPTY)


def _literal(text: str, language: str, kind: str) -> nodes.literal_block:
    return nodes.literal_block(text, text, language=language, classes=[kind])


def setup(app: Sphinx) -> dict[str, bool]:
    """Add `{run}` and `{picture}`."""
    app.add_directive("run", Run)
    app.add_directive("picture", Picture)
    app.add_config_value("package_digest", "", "env", frozenset({str}))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
