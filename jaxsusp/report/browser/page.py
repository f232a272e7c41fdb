"""One HTML file with the data, the code and nothing to fetch; `jaxsusp show` and notebooks."""

import base64
import hashlib
import html
import os
from collections.abc import Callable
from pathlib import Path
from string import Template
from typing import Any

from jaxsusp._files import write_text
from jaxsusp.errors import require
from jaxsusp.report.browser.gather import Shown, gathered
from jaxsusp.report.browser.packing import as_json
from jaxsusp.report.browser.threejs import three

SCRIPTS = ("data", "camera", "solids", "system", "scene", "curves", "panel", "page")
"""The page's own code, in the order in which its parts use each other."""

LARGEST = 6.0
"""MB of a page that browsers open without delay, and that can be sent."""

HEIGHT = 720
"""Pixels of a page in a notebook."""


class Page:
    """A page in one file; in a notebook it shows itself."""

    def __init__(self, text: str):
        self.text = text

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e6:.1f} MB>"

    def _repr_html_(self) -> str:
        frame = f'width="100%" height="{HEIGHT}" style="border: 0" title="jaxsusp"'
        return f'<iframe srcdoc="{html.escape(self.text)}" {frame}></iframe>'

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page, atomically."""
        write_text(path, self.text)


def show(
    *what: Shown,
    path: str | os.PathLike[str] | None = None,
    regions: bool = False,
    progress: Callable[[str], None] = lambda _: None,
) -> Page:
    """Scenes and plans in motion, in a browser: one page that makes no request.

    Args:
        what: scenarios, plans, comparisons and free spaces, or their names and files. Plans of one
            scenario stand beside each other; a free space belongs to the scenario named before it.
        path: of an HTML file that is written, if any.
        regions: whether free spaces that nobody has computed yet are computed, which takes seconds
            or minutes. Those that are known already are shown in any case.
        progress: called with a sentence while something takes long.

    Returns:
        The page. In a notebook it shows itself where a cell ends with it.

    Raises:
        InputError: something is not there, damaged, nothing that can be shown, or too much at once.
    """
    page = Page(_assembled(gathered(what, regions, progress)))
    size = len(page.text) / 1e6
    require(size <= LARGEST, f"the page would have {size:.1f} MB, more than {LARGEST}; show less")
    if path is not None:
        page.save(path)
    return page


def _assembled(content: dict[str, Any]) -> str:
    """Template, style, three.js, data and code as one text."""
    names = dict.fromkeys(scene["name"] for scene in content["scenes"])
    style, library = _own("style.css"), three()
    code = "\n".join(_own(f"{name}.js") for name in SCRIPTS)
    return Template(_own("template.html")).substitute(
        title=html.escape(", ".join(names)),
        policy=_policy(style, library, code),
        style=style,
        three=library,
        data=as_json(content),
        code=code,
    )


def _policy(style: str, *scripts: str) -> str:
    """A Content-Security-Policy that lets nothing run but these texts, and nothing be fetched."""
    allowed = " ".join(map(_hash, scripts))
    return f"default-src 'none'; script-src {allowed}; style-src {_hash(style)}; img-src data:"


def _hash(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _own(name: str) -> str:
    """A file beside this one."""
    return (Path(__file__).parent / name).read_text(encoding="utf-8")
