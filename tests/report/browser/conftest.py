"""A real browser for pages, and pages of one plan that goes well and one that does not."""

import os
import shutil

import pytest
from plans import LOW
from playwright.sync_api import Browser, sync_playwright

import jaxsusp as js

REQUIRED = "JAXSUSP_REQUIRE_BROWSER"
"""Environment variable under which a missing browser is a failure."""


@pytest.fixture(scope="module")  # its event loop is not left running beside other tests
def browser():
    """Chromium without a screen; tests that need it are skipped where there is none."""
    names = ("chromium", "chromium-browser", "google-chrome")
    found = next(filter(None, map(shutil.which, names)), None)
    if found is None:
        told = "no Chromium here, so no page was opened: apt-get install chromium"
        pytest.fail(told) if os.environ.get(REQUIRED) else pytest.skip(told)
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield opened
        opened.close()


class Visit:
    """A page in the browser with all that it asked for and complained about."""

    def __init__(self, browser: Browser, file, **look):
        self.context = browser.new_context(**{"viewport": {"width": 1280, "height": 800}, **look})
        self.context.set_offline(True)
        self.page = self.context.new_page()
        self.requests, self.complaints = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.complaints.append(error.message))
        self.page.on("console", self._said)
        self.page.goto(file.as_uri())

    def _said(self, message):
        if message.type == "error":
            self.complaints.append(message.text)

    @property
    def state(self) -> dict:
        """What the page says of itself."""
        return self.page.evaluate("window.jaxsusp.state")

    def seek(self, time: float) -> None:
        """Put the slider at a time (s), as a hand does."""
        script = "(rail, time) => {rail.value = time; rail.dispatchEvent(new Event('input'))}"
        self.page.locator("#time").evaluate(script, time)


@pytest.fixture
def visit(browser):
    """Open a page; it is closed in the end, and has made no request but for itself."""
    opened = []

    def visit(file, **look) -> Visit:
        opened.append(Visit(browser, file, **look))
        return opened[-1]

    yield visit
    for each in opened:
        each.context.close()
        assert each.complaints == []
        assert len(each.requests) == 1


@pytest.fixture(scope="session")
def plan() -> js.Plan:
    return js.plan_through("scenario-1", LOW)


@pytest.fixture(scope="session")
def refused() -> js.Plan:
    """Too low: it hits walls."""
    return js.plan_through("scenario-1", LOW - [0.0, 0.0, 0.9])


@pytest.fixture(scope="session")
def file(plan, refused, tmp_path_factory):
    """A page with both plans."""
    path = tmp_path_factory.mktemp("page") / "two.html"
    js.show(plan, refused, path=path)
    return path
