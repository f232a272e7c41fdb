"""Photographs `jaxsusp show` for the README; needs a Chromium that is installed."""

import shutil
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

import jaxsusp as js
from jaxsusp.optim.devices import configure

PICTURE = Path(__file__).parent / "images" / "show.png"
SCENARIO, ALGORITHMS = "scenario-5", ("routed", "taut")


def main() -> None:
    """Plan, show both plans beside each other, and photograph the page."""
    configure()
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    if browser is None:
        sys.exit("no Chromium here: apt-get install chromium")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        files = [Path(folder) / f"{name}.plan.json" for name in ALGORITHMS]
        for file, name in zip(files, ALGORITHMS, strict=True):
            js.plan(SCENARIO, name).save(file)
        js.show(*files, path=Path(folder) / "page.html", regions=True)
        opened = playwright.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        page = opened.new_page(viewport={"width": 1280, "height": 800})
        page.goto((Path(folder) / "page.html").as_uri())
        page.get_by_label("Show taut beside the chosen one").check()
        page.locator("#tightest").click()
        page.evaluate("document.activeElement.blur()")
        page.wait_for_timeout(500)
        page.screenshot(path=PICTURE)
        opened.close()


if __name__ == "__main__":
    main()
