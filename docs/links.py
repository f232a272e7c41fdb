"""Check a built site: every link leads somewhere, and nothing is asked of another host.

    python docs/links.py site

Links into the site must meet a file and, behind `#`, an anchor in it. What a page loads (scripts,
styles, fonts, pictures) must be a file of the site, so that it can be read without a network;
links for a person to follow may lead anywhere.
"""

import re
import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {
    "script": "src", "img": "src", "iframe": "src", "source": "src", "video": "src",
    "embed": "src", "object": "data", "link": "href", "image": "href", "use": "href",
}  # fmt: skip
"""Elements that make a browser load something, and the attribute that says what."""

FAR = re.compile(
    r"""(?:url\(\s*['"]?|@import\s+['"]?|fetch\(\s*['"]|import\(\s*['"])(?:https?:)?//"""
)
"""What makes a style or a script ask another host."""


class Page(HTMLParser):
    """Anchors, links and loaded files of a page."""

    def __init__(self, path: Path):
        super().__init__()
        self.anchors: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what an element names, links to or loads."""
        given = dict(attrs)
        self.anchors.update(filter(None, (given.get("id"), given.get("name"))))
        if tag == "a" and (target := given.get("href")):
            self.links.append(target)
        if (attribute := LOADS.get(tag)) and (target := given.get(attribute)):
            self.loads.append(target)


page = cache(Page)


def wrong(site: Path) -> list[str]:
    """Everything that is wrong with a site, a sentence each."""
    found = []
    for path in sorted(site.rglob("*.html")):
        here = path.relative_to(site)
        for target in page(path).loads:
            if urlsplit(target).scheme not in ("", "data") or target.startswith("//"):
                found.append(f"{here} loads {target} from another host")
            elif reason := _missing(path, target):
                found.append(f"{here} loads {target}: {reason}")
        for target in page(path).links:
            if not urlsplit(target).scheme and (reason := _missing(path, target)):
                found.append(f"{here} links to {target}: {reason}")
    for path in [*site.rglob("*.css"), *site.rglob("*.js")]:
        if FAR.search(path.read_text(encoding="utf-8")):
            found.append(f"{path.relative_to(site)} asks another host")
    return found


def _missing(path: Path, target: str) -> str:
    if target.startswith("data:"):
        return ""
    parts = urlsplit(target)
    file = path.parent / unquote(parts.path) if parts.path else path
    file = file / "index.html" if file.is_dir() else file
    if not file.exists():
        return "there is no such file"
    if parts.fragment and file.suffix == ".html":
        anchors = page(file.resolve() if file == path else file).anchors
        if unquote(parts.fragment) not in anchors:
            return "there is no such anchor"
    return ""


def main() -> None:
    """Say what is wrong; status 1 if anything is."""
    site = Path(sys.argv[1])
    if not (site / "index.html").exists():
        sys.exit(f"{site} holds no site")
    if found := wrong(site):
        sys.exit("\n".join(found))
    print(f"{len(list(site.rglob('*.html')))} pages, all links lead somewhere, nothing is loaded "
          "from another host")  # fmt: skip


if __name__ == "__main__":
    main()
