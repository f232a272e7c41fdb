"""Every number that the pages of results print is recomputed from the data that is kept."""

import pytest

from experiments import contents, pages
from experiments.artefacts import Artefacts

pytestmark = pytest.mark.pages


@pytest.mark.parametrize("name", contents.NAMES)
def test_a_page_says_what_its_data_say(name):
    """`make figures` writes it anew."""
    found = contents.module(name)
    page = found.draw(Artefacts())
    kept = (pages.SITE / f"{pages.stem(name)}.md").read_text(encoding="utf-8")
    assert pages.text_of(name, found, page) == kept
    assert all(pages.said(figure) for figure in page.figures.values())
    for each in page.figures:
        assert (pages.SITE / "images" / f"{each}.png").exists()


def test_the_index_lists_every_page(tmp_path):
    assert pages.write_index(tmp_path).read_text(encoding="utf-8") == (
        pages.SITE / "index.md"
    ).read_text(encoding="utf-8")


def test_names_are_modules_that_say_what_they_are():
    for name in contents.NAMES:
        found = contents.module(name)
        assert found.TITLE
        assert found.DIFFERS
        assert found.__doc__
        assert bool(found.MINUTES) == hasattr(found, "make") == bool(found.MADE)


def test_what_is_read_is_made_before():
    made: set[str] = set()
    for name in contents.NAMES:
        found = contents.module(name)
        made |= {*found.MADE}
        assert {*found.READ} <= made, name
