"""One HTML file with the data, the code and nothing to fetch; `jaxsusp show` and notebooks."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from jaxsusp._files import write_text
from jaxsusp.errors import require
from jaxsusp.report.browser.document import document, framed
from jaxsusp.report.browser.gather import Shown, gathered
from jaxsusp.report.browser.packing import as_json
from jaxsusp.report.browser.threejs import three

SCRIPTS = (
    "data.js", "camera.js", "solids.js", "system.js", "scene.js", "curves.js", "panel.js",
    "page.js",
)  # fmt: skip
"""The page's own code, in the order in which its parts use each other."""

LARGEST = 6.0
"""MB of a page that browsers open without delay, and that can be sent."""


class Page:
    """A page in one file; in a notebook it shows itself."""

    def __init__(self, text: str):
        self.text = text

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e6:.1f} MB>"

    def _repr_html_(self) -> str:
        return framed(self.text)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page, atomically; its folder is created where it is missing."""
        Path(path).parent.mkdir(parents=True, exist_ok=True)
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
    content = gathered(what, regions, progress)
    page = Page(_assembled(content))
    if (size := len(page.text) / 1e6) > LARGEST:
        for scene in content["scenes"]:
            scene["bodies"] = {}
        content["notes"].append(f"No shadows of cables: the page would have {size:.0f} MB.")
        page = Page(_assembled(content))
    size = len(page.text) / 1e6
    require(size <= LARGEST, f"the page would have {size:.1f} MB, more than {LARGEST}; show less")
    if path is not None:
        page.save(path)
    return page


def _assembled(content: dict[str, Any]) -> str:
    """The page with data, three.js and the code that draws with it."""
    names = dict.fromkeys(scene["name"] for scene in content["scenes"])
    styles = "theme.css", "show.css"
    data = as_json(content)
    return document("show.html", ", ".join(names), styles, SCRIPTS, three(), data=data)
