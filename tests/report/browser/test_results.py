"""The page of a comparison in a real browser, without a network."""

import json

import pytest

from jaxsusp.report.browser.results import results_page

pytestmark = pytest.mark.pages

HOSTILE = "<img src=x onerror=window.hacked=1>"


@pytest.fixture
def page(comparison, scenarios, tmp_path):
    """Of a comparison whose second scenario has a name that is none, and is not in the file."""
    names = {"scenario": ["scenario-1", HOSTILE]}
    texts = {"scenario-1": scenarios[0].to_toml()}
    origin = {"settings": {"budget": "iterations", "iterations": 5}, "versions": {"jax": HOSTILE}}
    attributes = {name: json.dumps(each) for name, each in origin.items()}
    ds = comparison.assign_coords(names)
    ds = ds.assign_attrs(scenario_files=json.dumps(texts), **attributes)
    path = tmp_path / "report.html"
    path.write_text(results_page(ds))
    return path


def test_tables_sort_pictures_show_and_names_are_only_names(visit, page):
    shown = visit(page, viewport={"width": 390, "height": 844}).page
    assert shown.locator("nav a").all_inner_texts() == [
        "Results", "Statistics", "Figures", "Scenes", "Origin",
    ]  # fmt: skip
    assert shown.evaluate("document.documentElement.scrollWidth") <= 390
    sizes = "[...document.images].map((image) => image.naturalWidth)"
    assert len(shown.evaluate(sizes)) == 4  # convergence, fitness, mean ranks, a scene
    assert min(shown.evaluate(sizes)) > 300
    table = shown.locator("table").first
    numbers = table.locator("tbody td:nth-child(4)")
    before = numbers.all_inner_texts()
    heading = table.get_by_role("button", name="min")
    heading.press("Enter")
    assert table.locator("th").nth(3).get_attribute("aria-sort") == "ascending"
    found = [float(text) for text in numbers.all_inner_texts()]
    assert found == sorted(found) == [100, 200, 200, 300, 400, 400, 600, 800]
    heading.click()
    assert [float(text) for text in numbers.all_inner_texts()] == found[::-1]
    heading.click()
    assert numbers.all_inner_texts() == before
    assert shown.evaluate("window.hacked") is None
    assert HOSTILE in shown.locator("#origin dd").all_inner_texts()
    told = f"no picture of {HOSTILE}: the dataset does not hold this scenario."
    assert told in shown.locator("#scenes p").all_inner_texts()
